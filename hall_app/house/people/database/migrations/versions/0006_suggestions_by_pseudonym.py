"""Suggestions that were followed up were named by their answer's withdrawal code, and so was what the journal says of
them: whoever read it could have withdrawn the answer. They are named by its pseudonym, as in every export."""

import re
from hashlib import sha256

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"

_CODE = re.compile(r"^([0-9a-f]{8}(?:-[0-9a-f]{4}){3}-[0-9a-f]{12})(?=\.)")


def upgrade() -> None:
    connection = op.get_bind()
    followup = sa.table("followup", sa.column("id", sa.String))
    for (key,) in connection.execute(sa.select(followup.c.id)).all():
        connection.execute(sa.update(followup).where(followup.c.id == key).values(id=_without_code(key)))
    audit = sa.table(
        "audit", sa.column("id", sa.Integer), sa.column("act", sa.String), sa.column("subject", sa.String)
    )
    told = sa.select(audit.c.id, audit.c.subject).where(audit.c.act == "answers")
    for number, subject in connection.execute(told).all():
        connection.execute(
            sa.update(audit).where(audit.c.id == number).values(subject=_without_code(subject))
        )


def downgrade() -> None:
    """Codes cannot be had back, which is the point."""


def _without_code(text: str) -> str:
    """As survey.export's `pseudonym`, whose formula a database that was written by it must not follow."""
    return _CODE.sub(
        lambda found: "a" + sha256(f"survey answer {found[1]}".encode()).hexdigest()[:31], text, count=1
    )
