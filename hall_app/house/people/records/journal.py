"""The journal read: who did what, and who tried what he may not. It is written by the ledger alone."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import func, select

from hall_app.house.people.database import Ledger, tables
from hall_app.house.people.records.bookings import Booking
from survey.store.database import in_utc

__all__ = ["Entry", "Journal"]


@dataclass(frozen=True)
class Entry:
    """at: UTC; who: the id of a person, "console", or "" for a stranger; subject: what or whom, by id."""

    id: int
    at: datetime
    who: str
    act: str
    subject: str
    refused: bool


class Journal:
    """What was done."""

    def __init__(self, ledger: Ledger) -> None:
        self._ledger = ledger

    def entries(self, *, before: int | None = None, most: int = 100) -> tuple[Entry, ...]:
        """The newest first; before: an entry's number, for the page that follows."""
        table = tables.audit
        query = select(table).order_by(table.c.id.desc()).limit(most)
        if before is not None:
            query = query.where(table.c.id < before)
        with self._ledger.read() as connection:
            rows = connection.execute(query).all()
        return tuple(_entry(row) for row in rows)

    def about(self, person: str, bookings: Iterable[Booking] = ()) -> tuple[Entry, ...]:
        """All that one person did or that was done to him and to these bookings of his, the earliest first."""
        table = tables.audit
        mine = (table.c.who == person) | table.c.subject.startswith(person, autoescape=True)
        for one in bookings:
            named = (table.c.subject == f"booking {one.id}") | table.c.subject.startswith(
                f"booking {one.id} "
            )
            # SQLite gives the number of a cancelled booking again: what was before he booked is another's.
            made = (table.c.who == person, table.c.act == "book", table.c.subject == one.occasion)
            mine |= named & (table.c.id > select(func.max(table.c.id)).where(*made).scalar_subquery())
        with self._ledger.read() as connection:
            rows = connection.execute(select(table).where(mine).order_by(table.c.id)).all()
        return tuple(_entry(row) for row in rows)


def _entry(row) -> Entry:
    return Entry(row.id, in_utc(row.at), row.who, row.act, row.subject, bool(row.refused))
