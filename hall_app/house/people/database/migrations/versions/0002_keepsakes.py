"""Favourites, and visits of who asked that they be kept."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    op.add_column("user", sa.Column("keeps_looks", sa.Integer, nullable=False, server_default="0"))
    op.create_table(
        "favourite",
        sa.Column("user", sa.String(16), sa.ForeignKey("user.id"), primary_key=True),
        sa.Column("exhibit", sa.String(64), primary_key=True),
        sa.Column("made", sa.DateTime(timezone=True), nullable=False),
    )
    op.create_table(
        "look",
        sa.Column("user", sa.String(16), sa.ForeignKey("user.id"), primary_key=True),
        sa.Column("exhibit", sa.String(64), primary_key=True),
        sa.Column("day", sa.Date, primary_key=True),
    )


def downgrade() -> None:
    op.drop_table("look")
    op.drop_table("favourite")
    op.drop_column("user", "keeps_looks")
