"""Names as people are searched, folded by Python: databases fold what their build or locale knows, and no two alike."""

import unicodedata

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"


def upgrade() -> None:
    op.add_column("user", sa.Column("name_folded", sa.Text, nullable=False, server_default=""))
    connection = op.get_bind()
    user = sa.table(
        "user", sa.column("id", sa.String), sa.column("name", sa.String), sa.column("name_folded", sa.Text)
    )
    for key, name in connection.execute(sa.select(user.c.id, user.c.name).where(user.c.name != "")).all():
        # As records.person's `folded`, whose formula a database that was written by it must not follow.
        told = unicodedata.normalize("NFKC", name).casefold()
        connection.execute(sa.update(user).where(user.c.id == key).values(name_folded=told))


def downgrade() -> None:
    op.drop_column("user", "name_folded")
