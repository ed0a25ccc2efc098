"""Answers fixed for evaluation, and a journal of what was done to the store."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    op.add_column("submission", sa.Column("frozen", sa.DateTime(timezone=True)))
    op.create_table(
        "audit",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("action", sa.String(32), nullable=False),
        sa.Column("subject", sa.String(200), nullable=False),
    )


def downgrade() -> None:
    op.drop_table("audit")
    op.drop_column("submission", "frozen")
