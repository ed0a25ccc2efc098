"""Where the database is, and that it still is there: an SQLite file can be moved, deleted or put back."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import Engine
from sqlalchemy.exc import DataError, DBAPIError, IntegrityError, SQLAlchemyError

from survey.errors import StoreError
from survey.store.database.permissions import tighten
from survey.store.database.schema import bring_up_to_date, has_tables

__all__ = ["Place", "explained"]


class Place:
    """The database of an engine. `file` is that of an SQLite one, `name` the same or the URL without the password."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        database = engine.url.database
        self.file = (
            Path(database).absolute() if engine.dialect.name == "sqlite" and database is not None else None
        )
        self.name = str(self.file) if self.file else engine.url.render_as_string(hide_password=True)
        self._identity: tuple[int, int] | None = None
        self._held: int | None = None
        self._missed = False
        self._reopening = threading.Lock()

    def open(self) -> None:
        """Bring the schema up to date. Raises StoreError, and what the database raises."""
        if self.file is not None:
            tighten(self.file)
        bring_up_to_date(self._engine)
        self._hold()

    def close(self) -> None:
        """Let go of the file; open() or check() takes hold of it again."""
        if self._held is not None:
            os.close(self._held)
            self._held = None

    def check(self) -> None:
        """See that the file is the one that was opened; take up another that was put in its place.

        An open connection would go on writing into a file that nobody finds any more, so all are given up.
        Raises StoreError where there is no file, one without a store in it, or one beside a foreign WAL.
        """
        if self.file is None or self._unmoved():
            return
        with self._reopening:
            if self._unmoved():
                return
            self._missed = True
            self._engine.dispose()
            found = self._look()
            if found is None:
                remedy = "put it back (or a backup in its place, without -wal and -shm)"
                raise StoreError(f"the database file is gone – {remedy}", self.name)
            if found != self._identity:
                self._see_that_it_is_whole(self.file)
                tighten(self.file)
                bring_up_to_date(self._engine)
                self._hold()
            self._missed = False

    def _see_that_it_is_whole(self, file: Path) -> None:
        # SQLite leaves the WAL of a file that was moved where it is, with the last answers in it, and would read
        # it into whatever stands there next: right for a copy of the same moment, ruin for an earlier one.
        wal = file.with_name(file.name + "-wal")
        if wal.exists() and wal.stat().st_size:
            what = f"another file was put in its place, but {wal.name} is still that of the earlier one"
            remedy = (
                f"put the earlier one back, or move {wal.name} and -shm away, which hold its last answers"
            )
            raise StoreError(f"{what} – {remedy}", self.name)
        # An empty file would look like a survey without answers.
        if not has_tables(self._engine):
            self._engine.dispose()
            raise StoreError("the file is no store of answers – put the right one back", self.name)

    def _unmoved(self) -> bool:
        return not self._missed and self._look() == self._identity

    def _hold(self) -> None:
        """Remember the file. Held open, its number cannot go to another; O_PATH leaves SQLite's locks alone."""
        self.close()
        if self.file is not None and hasattr(os, "O_PATH"):
            self._held = os.open(self.file, os.O_PATH | os.O_CLOEXEC)
        self._identity = self._look()

    def _look(self) -> tuple[int, int] | None:
        if self.file is None:
            return None
        try:
            found = os.stat(self.file)
        except OSError:
            return None
        return found.st_dev, found.st_ino


@contextmanager
def explained(place: str) -> Iterator[None]:
    """Turn the database's errors into a StoreError of one line that names the place."""
    try:
        yield
    except StoreError as error:
        raise StoreError(error.problem, error.place or place) from None
    except (DataError, IntegrityError):
        raise  # a row that cannot be, not a database that does not answer
    except SQLAlchemyError as error:
        cause = error.orig if isinstance(error, DBAPIError) else error
        first = str(cause).strip().splitlines()[0] if str(cause).strip() else type(error).__name__
        problem = f"the database refuses: {first} – see that it is there, free and not full"
        raise StoreError(problem, place) from None
