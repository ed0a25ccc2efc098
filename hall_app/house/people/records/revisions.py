"""What was published of the collection, and undone: which files of which exhibit, from what to what, by whom."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import select

from hall_app.house.people.database import Ledger, tables
from hall_app.house.people.errors import PeopleError
from survey.store.database import in_utc, now

__all__ = ["Revision", "Revisions"]


@dataclass(frozen=True)
class Revision:
    """act: "publish" or "undo"; files: name -> digests before and after, "" where there is no such file; at: UTC."""

    id: int
    exhibit: str
    at: datetime
    who: str
    act: str
    files: Mapping[str, tuple[str, str]]


class Revisions:
    """The history of the exhibits. The files themselves lie in the data folder, named by their digests."""

    def __init__(self, ledger: Ledger) -> None:
        self._ledger = ledger

    @contextmanager
    def adding(
        self, who: str, act: str, exhibit: str, files: Mapping[str, tuple[str, str]]
    ) -> Iterator[None]:
        """Written down when the block has put the files in place, and not if it raises."""
        table = tables.revision
        row = {"exhibit": exhibit, "who": who, "act": act, "files": json.dumps(files)}
        with self._ledger.change(who, act, exhibit) as connection:
            connection.execute(table.insert().values(at=now(), **row))
            yield

    def of(self, exhibit: str, *, most: int = 100, start: int = 0) -> tuple[Revision, ...]:
        """The newest first, from that one on (from 0)."""
        table = tables.revision
        query = select(table).where(table.c.exhibit == exhibit).order_by(table.c.id.desc())
        query = query.offset(start).limit(most)
        with self._ledger.read() as connection:
            return tuple(_revision(row) for row in connection.execute(query).all())

    def by(self, person: str) -> tuple[Revision, ...]:
        """All that one person published or took back, the earliest first."""
        table = tables.revision
        with self._ledger.read() as connection:
            rows = connection.execute(select(table).where(table.c.who == person).order_by(table.c.id)).all()
        return tuple(_revision(row) for row in rows)

    def one(self, number: int) -> Revision:
        """Raises PeopleError."""
        with self._ledger.read() as connection:
            row = connection.execute(select(tables.revision).where(tables.revision.c.id == number)).first()
        if row is None:
            raise PeopleError("no-revision")
        return _revision(row)

    def digests(self) -> frozenset[str]:
        """Of all files that the history needs."""
        with self._ledger.read() as connection:
            rows = connection.execute(select(tables.revision.c.files)).all()
        return frozenset(digest for row in rows for pair in json.loads(row.files).values() for digest in pair)


def _revision(row) -> Revision:
    files = {name: (before, after) for name, (before, after) in json.loads(row.files).items()}
    at = in_utc(row.at)
    assert at is not None
    return Revision(row.id, row.exhibit, at, row.who, row.act, files)
