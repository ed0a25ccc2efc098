"""A database brought to the schema of this version: an empty one at once, an older one step by step."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from sqlalchemy import Connection, Engine, MetaData, inspect, text

from survey.errors import StoreError
from survey.store.database import tables

__all__ = ["Lineage"]


@dataclass(frozen=True)
class Lineage:
    """Schemas of a database from its first to this version's.

    metadata: this version's tables; head: its revision; steps: Alembic's folder that leads to it; lock: PostgreSQL's
    advisory lock, so that of two services that start at once one upgrades after the other; name: of the database in
    what is told; namespace: PostgreSQL's, for what shares a database with others; unnamed: a table whose presence alone
    means revision 0001.
    """

    metadata: MetaData
    head: str
    steps: Path
    lock: int
    name: str
    namespace: str | None = None
    unnamed: str | None = None

    def bring_up_to_date(self, engine: Engine) -> None:
        """Make or upgrade the tables, in one transaction. Raises StoreError for a newer schema than ours."""
        with engine.connect() as connection:
            if self.revision(connection) == self.head:
                return
            # Reading began a transaction; the writing one starts afresh and sees what another process did.
            connection.rollback()
            tables.begin_writing(connection)
            if connection.dialect.name == "postgresql":
                connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": self.lock})
                if self.namespace:
                    connection.execute(text(f"CREATE SCHEMA IF NOT EXISTS {self.namespace}"))
            found = self.revision(connection)
            if found == "":
                self.metadata.create_all(connection)
                connection.execute(
                    text("CREATE TABLE alembic_version (version_num VARCHAR(32) NOT NULL PRIMARY KEY)")
                )
                connection.execute(text("INSERT INTO alembic_version VALUES (:head)"), {"head": self.head})
            elif found != self.head:
                self._upgrade(connection, found)
            connection.commit()

    def revision(self, connection: Connection) -> str:
        """The schema's revision; "" for an empty database."""
        names = self._names(connection)
        if "alembic_version" in names:
            found = connection.execute(text("SELECT version_num FROM alembic_version")).scalar_one_or_none()
            return str(found or "")
        return "0001" if self.unnamed in names else ""

    def _names(self, connection: Connection) -> set[str]:
        space = self.namespace if connection.dialect.name == "postgresql" else None
        return set(inspect(connection).get_table_names(schema=space))

    def _upgrade(self, connection: Connection, found: str) -> None:
        from alembic import command
        from alembic.config import Config
        from alembic.util import CommandError

        config = Config()
        config.set_main_option("script_location", str(self.steps))
        config.attributes["connection"] = connection
        try:
            if "alembic_version" not in self._names(connection):
                command.stamp(config, found)
            command.upgrade(config, self.head)
        except CommandError:
            problem = f"{self.name} has schema {found}, this version knows up to {self.head}"
            raise StoreError(f"{problem} – install the newer version that wrote it") from None
