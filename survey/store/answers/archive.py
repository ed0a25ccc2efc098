"""The store as a reader opens it: nothing is written, nothing is brought up to date, no writer waits."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import Connection, Engine, create_engine
from sqlalchemy.pool import NullPool

from survey.errors import StoreError
from survey.store.database import explained, tables

__all__ = ["Archive"]


class Archive:
    """Reads what a Store keeps, also from another process while answers come in.

    where: the data folder (Path) or a database URL, of a store that a Store has opened before.
    """

    def __init__(self, where: Path | str) -> None:
        self._file = tables.sqlite_file(where)
        self._engine = _engine(where, self._file)
        self._name = str(self._file or self._engine.url.render_as_string(hide_password=True))

    @contextmanager
    def snapshot(self) -> Iterator[Connection]:
        """Several queries that see the same moment. Raises StoreError where the database does not answer.

        Make it short: as long as it lasts, SQLite cannot shorten its log, nor an erasure reach the file.
        """
        with explained(self._name):
            if self._file is not None and not self._file.is_file():
                raise StoreError("no such store – give the one that was served", self._name)
            with self._engine.connect() as connection:
                if self._file is not None:
                    connection.exec_driver_sql("BEGIN")
                else:
                    connection.execution_options(isolation_level="REPEATABLE READ", postgresql_readonly=True)
                yield connection


def _engine(where: Path | str, file: Path | None) -> Engine:
    if file is None:
        engine = tables.open_engine(where)  # knows which drivers there are
        return create_engine(engine.url, poolclass=NullPool)

    def connect() -> sqlite3.Connection:
        uri = f"{file.absolute().as_uri()}?mode=ro"
        connection = sqlite3.connect(uri, uri=True, timeout=tables.BUSY_SECONDS)
        connection.execute("PRAGMA temp_store=MEMORY")  # what is sorted is not left in a file
        return connection

    return create_engine("sqlite://", creator=connect, poolclass=NullPool)
