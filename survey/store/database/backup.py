"""A consistent copy of the store as one SQLite file, made while the service runs."""

from __future__ import annotations

import os
import sqlite3
from contextlib import closing
from pathlib import Path

from sqlalchemy import Connection, Engine, create_engine, select

from survey.errors import StoreError
from survey.store.database import tables
from survey.store.database.permissions import make_file
from survey.store.database.schema import bring_up_to_date

__all__ = ["write_copy"]


def write_copy(engine: Engine, path: Path) -> int:
    """Copy to `path`, which must not exist; it appears there only when whole, checked and on the disk.

    It is readable by its owner alone, and holds nothing of what was erased before.

    Returns the number of submissions in it. Raises StoreError.
    """
    if path.exists():
        raise StoreError(f"{path}: exists already – give another name, a backup never overwrites one")
    part = path.with_name(path.name + ".part")
    try:
        part.unlink(missing_ok=True)
        make_file(part)
        if engine.dialect.name == "sqlite":
            _copy_file(engine, part)
        else:
            _copy_tables(engine, part)
        count = _check(part)
        _sync(part)
        os.replace(part, path)
        _sync(path.parent)
    except (OSError, sqlite3.Error) as error:
        part.unlink(missing_ok=True)
        raise StoreError(
            f"{path}: the backup failed ({error}) – see that the place is there and free"
        ) from None
    return count


def _copy_file(engine: Engine, part: Path) -> None:
    with engine.connect() as connection:
        source = connection.connection.driver_connection
        assert isinstance(source, sqlite3.Connection)
        # Row by row, not page by page: unused parts of pages may still hold what was moved out of them. It is one
        # snapshot; writers go on, because WAL lets them.
        source.execute("VACUUM INTO ?", (str(part.absolute()),))
    with closing(sqlite3.connect(part)) as copy:
        copy.execute("PRAGMA journal_mode=DELETE")  # one file, nothing beside it


def _copy_tables(engine: Engine, part: Path) -> None:
    copy = create_engine(f"sqlite:///{part}")
    try:
        bring_up_to_date(copy)
        snapshot = engine.connect().execution_options(isolation_level="REPEATABLE READ")
        with snapshot as source, copy.begin() as target:
            for table in tables.metadata.sorted_tables:
                _copy_table(source, target, table)
    finally:
        copy.dispose()


def _copy_table(source: Connection, target: Connection, table) -> None:
    found = source.execution_options(yield_per=5000).execute(select(table))
    for rows in found.mappings().partitions():
        target.execute(table.insert(), [dict(row) for row in rows])


def _check(part: Path) -> int:
    with closing(sqlite3.connect(part)) as copy:
        if copy.execute("PRAGMA integrity_check").fetchone() != ("ok",):
            raise sqlite3.DatabaseError("the copy is not sound")
        return copy.execute("SELECT count(*) FROM submission").fetchone()[0]


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
