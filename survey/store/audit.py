"""The journal of what was done to the store, and by which token; no visitor is known by it."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import Connection, select, update

from survey.store.database import Session, in_utc, now, tables

__all__ = ["Audit", "Entry", "note", "note_withdrawal"]


@dataclass(frozen=True)
class Entry:
    """at: UTC. number: of answers concerned, where there is one to tell."""

    at: datetime
    action: str
    subject: str
    number: int | None


def note(connection: Connection, action: str, subject: str, number: int | None = None) -> None:
    """Write an entry; the caller commits."""
    row = {"at": now(), "action": action, "subject": subject[:200], "number": number}
    connection.execute(tables.audit.insert().values(**row))


def note_withdrawal(connection: Connection, questionnaire: str) -> None:
    """Count a withdrawal; the caller commits.

    One entry for a questionnaire and a day: a code or the hour would tell whoever saw a visitor at the screen which
    answer was his.
    """
    table = tables.audit
    day = now().replace(hour=0, minute=0, second=0)
    mine = (table.c.action == "withdraw", table.c.subject == questionnaire, table.c.at == day)
    counted = connection.execute(update(table).where(*mine).values(number=table.c.number + 1))
    if not counted.rowcount:
        row = {"at": day, "action": "withdraw", "subject": questionnaire, "number": 1}
        connection.execute(table.insert().values(**row))


class Audit:
    """The journal of one store."""

    def __init__(self, write: Session, read: Session) -> None:
        self._write, self._read = write, read

    def note(self, action: str, subject: str, number: int | None = None) -> None:
        """Write an entry and commit it."""
        with self._write() as connection:
            note(connection, action, subject, number)

    def entries(self) -> tuple[Entry, ...]:
        """Every entry, the earliest first."""
        table = tables.audit
        query = select(table.c.at, table.c.action, table.c.subject, table.c.number)
        with self._read() as connection:
            found = connection.execute(query.order_by(table.c.at, table.c.id)).all()
        return tuple(Entry(in_utc(row.at), row.action, row.subject, row.number) for row in found)

    def last(self, action: str) -> datetime | None:
        """When it was done last (UTC), also by a clock that was wrong; None: never."""
        table = tables.audit
        query = select(table.c.at).where(table.c.action == action).order_by(table.c.id.desc()).limit(1)
        with self._read() as connection:
            found = connection.execute(query).scalar()
        return None if found is None else in_utc(found)
