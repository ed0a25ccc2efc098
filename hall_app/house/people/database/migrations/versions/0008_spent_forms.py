"""Keys of forms whose booking was cancelled."""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"


def upgrade() -> None:
    op.create_table(
        "spent_form",
        sa.Column("user", sa.String(16), sa.ForeignKey("user.id"), primary_key=True),
        sa.Column("occasion", sa.String(16), sa.ForeignKey("occasion.id"), primary_key=True),
        sa.Column("key", sa.String(64), primary_key=True),
        if_not_exists=True,
    )


def downgrade() -> None:
    op.drop_table("spent_form")
