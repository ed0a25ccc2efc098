"""The journal had a row, with its time to the second, for each exhibit that somebody looked at who had asked that his
visits be kept by the day. They go, and with them the rows of turning that on and off, which looked the same; what is
kept of visits is written anew, in an order that tells nothing.
"""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"


def upgrade() -> None:
    connection = op.get_bind()
    audit = sa.table("audit", sa.column("act", sa.String))
    connection.execute(sa.delete(audit).where(audit.c.act == "visits"))
    look = sa.table(
        "look", sa.column("user", sa.String), sa.column("exhibit", sa.String), sa.column("day", sa.Date)
    )
    rows = connection.execute(sa.select(look).order_by(look.c.user, look.c.day, look.c.exhibit)).all()
    connection.execute(sa.delete(look))
    if rows:
        connection.execute(sa.insert(look), [row._asdict() for row in rows])


def downgrade() -> None:
    """What the journal told cannot be had back, which is the point."""
