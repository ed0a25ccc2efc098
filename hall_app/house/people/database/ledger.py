"""The one way to change anything about people: what is done is written down in the same transaction, or not done.

A connection that reads refuses to write, and the one that writes is lent by `change`, which adds the journal's row and
commits both. What a visitor looked at, and when an answer was withdrawn, no journal may tell: `keep` writes that alone.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from sqlalchemy import Connection, Engine, delete, event
from sqlalchemy.exc import SQLAlchemyError

from hall_app.house.people.acts import ACTS, OWN_ACTS
from hall_app.house.people.database import tables
from hall_app.house.people.database.schema import NAMESPACE, bring_up_to_date
from survey.store.database import (
    Schema,
    explained,
    make_private,
    now,
    open_engine,
    see_that_it_takes,
    take_copy,
    write_copy,
)
from survey.store.database import tables as survey_tables

__all__ = ["CONSOLE", "NOBODY", "PEOPLE_FILE", "Ledger"]

PEOPLE_FILE = "people.sqlite"  # in the data folder
CONSOLE = "console"  # `who` of what is done by `hall admin`: by whoever may read the data folder
NOBODY = ""  # `who` of what a stranger tries
_PEOPLE = Schema(tables.metadata, bring_up_to_date, tables.user)


class Ledger:
    """The database of people. where: the data folder (Path) or a database URL. Raises StoreError."""

    def __init__(self, where: Path | str) -> None:
        self._engine, self._name = _opened(where)
        self._writing = threading.Lock()
        with explained(self._name):
            bring_up_to_date(self._engine)

    def close(self) -> None:
        self._engine.dispose()

    @contextmanager
    def read(self) -> Iterator[Connection]:
        """A connection that refuses every change. Raises StoreError."""
        with explained(self._name), self._engine.connect() as connection:
            if connection.dialect.name == "sqlite":
                connection.exec_driver_sql("PRAGMA query_only=ON")
                try:
                    yield connection
                finally:
                    connection.exec_driver_sql("PRAGMA query_only=OFF")
            else:
                yield connection.execution_options(postgresql_readonly=True)

    @contextmanager
    def change(self, who: str, act: str, subject: str, *, refused: bool = False) -> Iterator[Connection]:
        """A connection for one change: committed with its row in the journal when the block ends, else undone.

        who: the id of a person, CONSOLE or NOBODY; act: of ACTS or OWN_ACTS; subject: what or whom, by id.
        Raises StoreError, and ValueError for an act that nobody has declared.
        """
        if act not in ACTS and act not in OWN_ACTS:
            raise ValueError(f"{act!r}: no such act – declare it in hall_app/house/people/acts.py")
        row = {"who": who, "act": act, "subject": subject[:200], "refused": int(refused)}
        with self._written() as connection:
            yield connection
            connection.execute(tables.audit.insert().values(at=now(), **row))

    @contextmanager
    def keep(self) -> Iterator[Connection]:
        """A connection for visits of who asked that they be kept, and for what goes with a withdrawn answer: committed
        when the block ends, and in no journal.

        A row there has its time to the second and stays: it would tell when somebody looked at what, also once he has
        turned his visits off, and whoever saw a visitor at the screen which answer was his. Raises StoreError.
        """
        with self._written() as connection:
            yield connection

    @contextmanager
    def _written(self) -> Iterator[Connection]:
        # Waiting here is fair and cheap; waiting for SQLite's own lock is a busy loop.
        with self._writing, explained(self._name), self._engine.connect() as connection:
            survey_tables.begin_writing(connection)
            yield connection
            connection.commit()

    def refuse(self, who: str, act: str, subject: str) -> None:
        """Write down that somebody tried what he may not."""
        with self.change(who, act, subject, refused=True):
            pass

    def copy_to(self, path: Path) -> int:
        """Write a consistent copy of everything into a new SQLite file, while people come and go. Accounts in it."""
        with self.change(CONSOLE, "backup", path.name):
            pass
        return write_copy(self._engine, path, _PEOPLE)

    def see_that_it_takes(self, path: Path) -> None:
        """Upgrade a copy that copy_to wrote, where it lies, and see that nobody is here yet. Raises StoreError."""
        with self.read() as connection:
            see_that_it_takes(connection, path, _PEOPLE)

    def take_copy(self, path: Path) -> int:
        """Take in such a copy, whole or not at all. Accounts in it. Raises StoreError.

        Sessions and codes end: what was revoked after the copy was made must not be good again.
        """
        with self.change(CONSOLE, "backup", f"{path.name} restored") as connection:
            count = take_copy(connection, path, _PEOPLE)
            connection.execute(delete(tables.session))
            connection.execute(delete(tables.code).where(tables.code.c.purpose == "open"))
        return count

    def scrub(self) -> None:
        """Take what was deleted out of SQLite's log as well; where somebody reads just now, its next turn does it."""
        if self._engine.dialect.name != "sqlite":
            return  # PostgreSQL's VACUUM, which it runs by itself
        with suppress(SQLAlchemyError), self._writing, self._engine.connect() as connection:
            connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")


def _opened(where: Path | str) -> tuple[Engine, str]:
    """The engine, and the name by which errors call the place: no password in it."""
    if isinstance(where, Path):
        make_private(where)
        file = (where / PEOPLE_FILE).absolute()
        return open_engine(f"sqlite:///{file}"), str(file)
    engine = open_engine(where)
    if engine.dialect.name == "postgresql":
        event.listen(engine, "connect", _enter_namespace)
    return engine, engine.url.render_as_string(hide_password=True)


def _enter_namespace(connection, _record) -> None:
    with connection.cursor() as cursor:
        cursor.execute(f"SET search_path TO {NAMESPACE}")
    connection.commit()  # a setting of a transaction that is rolled back is taken back with it
