"""What was published of the collection, and undone. A house made under the name 0003 may have the table already."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"


def upgrade() -> None:
    op.create_table(
        "revision",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("exhibit", sa.String(64), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("who", sa.String(16), nullable=False),
        sa.Column("act", sa.String(8), nullable=False),
        sa.Column("files", sa.Text, nullable=False),
        if_not_exists=True,
    )
    op.create_index("revision_by_exhibit", "revision", ["exhibit"], if_not_exists=True)


def downgrade() -> None:
    op.drop_table("revision")
