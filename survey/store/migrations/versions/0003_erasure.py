"""Erasures whose last bytes are still in the files; tokens that end; the number of answers in the journal."""

import uuid
from datetime import UTC, datetime

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    op.add_column("token", sa.Column("questionnaire", sa.String(64)))
    op.add_column("token", sa.Column("expires", sa.Date))
    op.add_column("token", sa.Column("used", sa.Date))
    op.add_column("audit", sa.Column("number", sa.Integer))
    trace = op.create_table(
        "trace",
        sa.Column("key", sa.String(32), primary_key=True),
        sa.Column("since", sa.DateTime(timezone=True), nullable=False),
    )
    # What earlier releases erased may still be read in free pages, so the file is rewritten once.
    op.bulk_insert(trace, [{"key": uuid.uuid4().hex, "since": datetime.now(UTC).replace(microsecond=0)}])


def downgrade() -> None:
    op.drop_table("trace")
    op.drop_column("audit", "number")
    for name in ("used", "expires", "questionnaire"):
        op.drop_column("token", name)
