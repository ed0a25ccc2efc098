"""The schema of the answers, and the database that was never made."""

from __future__ import annotations

from pathlib import Path

from sqlalchemy import Engine

from survey.store.database import tables
from survey.store.database.lineage import Lineage

__all__ = ["HEAD", "bring_up_to_date", "has_tables"]

HEAD = "0004"  # the newest file in migrations/versions; a test holds it
_LINEAGE = Lineage(
    tables.metadata,
    HEAD,
    Path(__file__).parents[1] / "migrations",
    lock=0x5375_7276,
    name="the database",
    unnamed=tables.submission.name,  # version 0.1.0 noted no revision
)
bring_up_to_date = _LINEAGE.bring_up_to_date


def has_tables(engine: Engine) -> bool:
    """Whether a store was ever made in this database."""
    with engine.connect() as connection:
        return _LINEAGE.revision(connection) != ""
