"""The journal told to the second when an answer was withdrawn whose suggestion had been followed up, and which, by its
pseudonym: whoever saw a visitor at the screen could tell his answer in a file that was exported before. The rows go.
"""

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"


def upgrade() -> None:
    audit = sa.table("audit", sa.column("act", sa.String), sa.column("subject", sa.String))
    told = (audit.c.act == "answers", audit.c.subject.endswith(" withdrawn"))
    op.get_bind().execute(sa.delete(audit).where(*told))


def downgrade() -> None:
    """What the journal told cannot be had back, which is the point."""
