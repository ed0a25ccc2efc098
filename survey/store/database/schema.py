"""Bringing a database to the schema of this version: an empty one at once, an older one step by step."""

from __future__ import annotations

from pathlib import Path

from sqlalchemy import Connection, Engine, inspect, text

from survey.errors import StoreError
from survey.store.database import tables

__all__ = ["HEAD", "bring_up_to_date", "has_tables"]

HEAD = "0004"  # the newest file in migrations/versions; a test holds it
_LOCK = 0x5375_7276  # PostgreSQL's advisory lock: two services that start at once upgrade one after the other


def bring_up_to_date(engine: Engine) -> None:
    """Make or upgrade the tables, in one transaction. Raises StoreError for a newer schema than ours."""
    with engine.connect() as connection:
        if _revision(connection) == HEAD:
            return
        # Reading began a transaction; the writing one starts afresh and sees what another process did.
        connection.rollback()
        tables.begin_writing(connection)
        if connection.dialect.name == "postgresql":
            connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": _LOCK})
        found = _revision(connection)
        if found == "":
            tables.metadata.create_all(connection)
            connection.execute(
                text("CREATE TABLE alembic_version (version_num VARCHAR(32) NOT NULL PRIMARY KEY)")
            )
            connection.execute(text("INSERT INTO alembic_version VALUES (:head)"), {"head": HEAD})
        elif found != HEAD:
            _upgrade(connection, found)
        connection.commit()


def has_tables(engine: Engine) -> bool:
    """Whether a store was ever made in this database."""
    with engine.connect() as connection:
        return _revision(connection) != ""


def _revision(connection: Connection) -> str:
    """The schema's revision; "" for an empty database, 0001 for one that version 0.1.0 made."""
    names = set(inspect(connection).get_table_names())
    if "alembic_version" in names:
        found = connection.execute(text("SELECT version_num FROM alembic_version")).scalar_one_or_none()
        return str(found or "")
    return "0001" if tables.submission.name in names else ""


def _upgrade(connection: Connection, found: str) -> None:
    from alembic import command
    from alembic.config import Config
    from alembic.util import CommandError

    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parents[1] / "migrations"))
    config.attributes["connection"] = connection
    try:
        if "alembic_version" not in inspect(connection).get_table_names():
            command.stamp(config, found)
        command.upgrade(config, HEAD)
    except CommandError:
        problem = f"the database has schema {found}, this version knows up to {HEAD}"
        raise StoreError(f"{problem} – install the newer version that wrote it") from None
