"""A consistent copy of a database as one SQLite file, made while the service runs, and such a copy taken in again."""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from sqlalchemy import Connection, Engine, Integer, MetaData, Table, create_engine, func, select, text

from survey.errors import StoreError
from survey.store.database import tables
from survey.store.database.permissions import make_file
from survey.store.database.schema import bring_up_to_date
from survey.store.database.sessions import in_utc

__all__ = ["ANSWERS", "Schema", "see_that_it_takes", "take_copy", "write_copy"]


@dataclass(frozen=True)
class Schema:
    """metadata: all tables; upgrade: makes them, or brings older ones to this version; counted: the one whose rows are
    told of."""

    metadata: MetaData
    upgrade: Callable[[Engine], None]
    counted: Table


ANSWERS = Schema(tables.metadata, bring_up_to_date, tables.submission)


def write_copy(engine: Engine, path: Path, schema: Schema = ANSWERS) -> int:
    """Copy to `path`, which must not exist; it appears there only when whole, checked and on the disk.

    It is readable by its owner alone, and holds nothing of what was erased before.

    Returns the number of rows of the counted table. Raises StoreError.
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
            _copy_tables(engine, part, schema)
        count = _check(part, schema)
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


def see_that_it_takes(connection: Connection, path: Path, schema: Schema) -> None:
    """Upgrade the copy at `path`, and see that there is room for it: that no table has a row.

    Raises StoreError, also for a copy of a newer schema than ours.
    """
    for table in schema.metadata.sorted_tables:
        if connection.execute(select(func.count()).select_from(table)).scalar_one():
            remedy = "restore into an empty one: another data folder, another database"
            raise StoreError(f"the database is not empty (table {table.name}) – {remedy}")
    copy = create_engine(f"sqlite:///{path}")
    try:
        schema.upgrade(copy)
    finally:
        copy.dispose()


def take_copy(connection: Connection, path: Path, schema: Schema) -> int:
    """Take in all that an upgraded copy holds; the caller commits. Returns the number of rows of the counted table."""
    copy = create_engine(f"sqlite:///{path}")
    try:
        with copy.connect() as source:
            for table in schema.metadata.sorted_tables:
                _copy_table(source, connection, table)
    finally:
        copy.dispose()
    if connection.dialect.name == "postgresql":
        for table in schema.metadata.sorted_tables:
            _count_on(connection, table)
    return connection.execute(select(func.count()).select_from(schema.counted)).scalar_one()


def _copy_tables(engine: Engine, part: Path, schema: Schema) -> None:
    copy = create_engine(f"sqlite:///{part}")
    try:
        schema.upgrade(copy)
        snapshot = engine.connect().execution_options(isolation_level="REPEATABLE READ")
        with snapshot as source, copy.begin() as target:
            for table in schema.metadata.sorted_tables:
                _copy_table(source, target, table)
    finally:
        copy.dispose()


def _copy_table(source: Connection, target: Connection, table: Table) -> None:
    found = source.execution_options(yield_per=5000).execute(select(table))
    for rows in found.mappings().partitions():
        target.execute(table.insert(), [{name: _timed(value) for name, value in row.items()} for row in rows])


def _timed(value: object) -> object:
    """A time in UTC, which SQLite keeps without saying so, wherever the server thinks it stands."""
    return in_utc(value) if isinstance(value, datetime) else value


def _count_on(connection: Connection, table: Table) -> None:
    """PostgreSQL counts on after rows that came with their numbers."""
    keys = [column for column in table.primary_key if isinstance(column.type, Integer)]
    if len(table.primary_key) != 1 or not keys:
        return
    name = connection.dialect.identifier_preparer.format_table(table)
    last = connection.execute(select(func.max(keys[0]))).scalar_one()
    if last is not None:
        told = text("SELECT setval(pg_get_serial_sequence(:name, :key), :last)")
        connection.execute(told, {"name": name, "key": keys[0].name, "last": last})


def _check(part: Path, schema: Schema) -> int:
    with closing(sqlite3.connect(part)) as copy:
        if copy.execute("PRAGMA integrity_check").fetchone() != ("ok",):
            raise sqlite3.DatabaseError("the copy is not sound")
        return copy.execute(f'SELECT count(*) FROM "{schema.counted.name}"').fetchone()[0]


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
