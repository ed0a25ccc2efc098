"""Withdrawal codes of answers, of who asked that the account keep them."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    op.create_table(
        "answer_code",
        sa.Column("user", sa.String(16), sa.ForeignKey("user.id"), primary_key=True),
        sa.Column("code", sa.String(36), primary_key=True),
        sa.Column("made", sa.DateTime(timezone=True), nullable=False),
    )


def downgrade() -> None:
    op.drop_table("answer_code")
