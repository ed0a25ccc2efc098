"""The schema of the people's tables."""

from __future__ import annotations

from pathlib import Path

from hall_app.house.people.database import tables
from survey.store.database import Lineage

__all__ = ["HEAD", "NAMESPACE", "bring_up_to_date"]

HEAD = "0010"  # the newest file in migrations/versions; a test holds it
NAMESPACE = "people"  # of PostgreSQL: answers may lie in the same database, and have an `audit` of their own
bring_up_to_date = Lineage(
    tables.metadata,
    HEAD,
    Path(__file__).parent / "migrations",
    lock=0x5065_6F70,
    name="the people's database",
    namespace=NAMESPACE,
).bring_up_to_date
