"""Bringing the people's tables to the schema of this version: an empty database at once, an older one step by step."""

from __future__ import annotations

from pathlib import Path

from sqlalchemy import Connection, Engine, inspect, text

from hall_app.house.people.database import tables
from survey.errors import StoreError
from survey.store.database import tables as survey_tables

__all__ = ["HEAD", "NAMESPACE", "bring_up_to_date"]

HEAD = "0003"  # the newest file in migrations/versions; a test holds it
NAMESPACE = "people"  # of PostgreSQL: answers may lie in the same database, and have an `audit` of their own
_LOCK = 0x5065_6F70  # PostgreSQL's advisory lock: two services that start at once upgrade one after the other


def bring_up_to_date(engine: Engine) -> None:
    """Make or upgrade the tables, in one transaction. Raises StoreError for a newer schema than ours."""
    with engine.connect() as connection:
        survey_tables.begin_writing(connection)
        if connection.dialect.name == "postgresql":
            connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": _LOCK})
            connection.execute(text(f"CREATE SCHEMA IF NOT EXISTS {NAMESPACE}"))
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


def _revision(connection: Connection) -> str:
    """The schema's revision; "" for an empty database."""
    space = NAMESPACE if connection.dialect.name == "postgresql" else None
    if "alembic_version" not in inspect(connection).get_table_names(schema=space):
        return ""
    return str(connection.execute(text("SELECT version_num FROM alembic_version")).scalar_one_or_none() or "")


def _upgrade(connection: Connection, found: str) -> None:
    from alembic import command
    from alembic.config import Config
    from alembic.util import CommandError

    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    config.attributes["connection"] = connection
    try:
        command.upgrade(config, HEAD)
    except CommandError:
        problem = f"the people's database has schema {found}, this version knows up to {HEAD}"
        raise StoreError(f"{problem} – install the newer version that wrote it") from None
