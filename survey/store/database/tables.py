"""The tables, and how the database is opened."""

from __future__ import annotations

import sqlite3
from pathlib import Path

from sqlalchemy import (
    JSON,
    Column,
    Connection,
    Date,
    DateTime,
    Engine,
    ForeignKey,
    Index,
    Integer,
    MetaData,
    String,
    Table,
    Text,
    create_engine,
    event,
)
from sqlalchemy.engine import URL, make_url
from sqlalchemy.exc import ArgumentError, NoSuchModuleError

from survey.errors import StoreError
from survey.store.database import permissions

__all__ = [
    "SQLITE_FILE",
    "answer",
    "audit",
    "begin_writing",
    "figure",
    "metadata",
    "open_engine",
    "publication",
    "sqlite_file",
    "submission",
    "suggestion",
    "token",
    "trace",
    "version",
]

SQLITE_FILE = "survey.sqlite"
BUSY_SECONDS = 15.0

metadata = MetaData()

# A version is frozen with its first answer: what was asked can always be read beside what was answered.
version = Table(
    "version",
    metadata,
    Column("questionnaire", String(64), primary_key=True),
    Column("version", Integer, primary_key=True),
    Column("digest", String(64), nullable=False),
    Column("document", JSON, nullable=False),
)

# No address, no browser: the row knows only what the visitor chose to send. A withdrawn one stays as a
# tombstone without answers, so that a late replay cannot bring it back.
submission = Table(
    "submission",
    metadata,
    Column("id", String(36), primary_key=True),
    Column("questionnaire", String(64), nullable=False),
    Column("version", Integer, nullable=False),
    Column("language", String(2), nullable=False),
    Column("exhibit", String(64)),
    Column("digest", String(64), nullable=False),
    Column("received", DateTime(timezone=True), nullable=False),
    Column("withdrawn", DateTime(timezone=True)),
    Column("frozen", DateTime(timezone=True)),  # fixed for evaluation: cannot be withdrawn any more
    Column("counted", Integer),  # the step of the public figures that counted it first; null: none yet
)
Index("submission_by_questionnaire", submission.c.questionnaire, submission.c.version, submission.c.counted)

answer = Table(
    "answer",
    metadata,
    Column("submission", ForeignKey("submission.id"), primary_key=True),
    Column("item", String(64), primary_key=True),
    Column("score", Integer),  # null: not seen
)

suggestion = Table(
    "suggestion",
    metadata,
    Column("submission", ForeignKey("submission.id"), primary_key=True),
    Column("module", String(64), primary_key=True),
    Column("text", Text, nullable=False),
)

# The last step of a version's public figures: how many answers it counted.
publication = Table(
    "publication",
    metadata,
    Column("questionnaire", String(64), primary_key=True),
    Column("version", Integer, primary_key=True),
    Column("step", Integer, nullable=False),
    Column("n", Integer, nullable=False),
)

# The last figure of each item, rounded as everybody saw it: an exact sum beside the answers that stand would keep
# what was withdrawn. n = 0: there was none yet. judged: the step that last looked whether there could be another.
# withheld: why it is not shown now.
figure = Table(
    "figure",
    metadata,
    Column("questionnaire", String(64), primary_key=True),
    Column("version", Integer, primary_key=True),
    Column("item", String(64), primary_key=True),
    Column("step", Integer, nullable=False),
    Column("judged", Integer, nullable=False),
    Column("n", Integer, nullable=False),
    Column("units", Integer, nullable=False),
    Column("decimals", Integer, nullable=False),
    Column("withheld", String(8)),
)

token = Table(
    "token",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("label", String(200), nullable=False),
    Column("digest", String(64), nullable=False, unique=True),
    Column("made", DateTime(timezone=True), nullable=False),
    Column("questionnaire", String(64)),  # the only one it opens; null: all
    Column("expires", Date),  # the last day (UTC) on which it is good; null: it has none
    Column("used", Date),  # the day (UTC) of its last use
)

# What was done to the store, by which no visitor can be known: survey/store/audit.py.
audit = Table(
    "audit",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("at", DateTime(timezone=True), nullable=False),
    Column("action", String(32), nullable=False),
    Column("subject", String(200), nullable=False),
    Column("number", Integer),  # of answers concerned
)

# One row for each erasure whose last bytes may still be in the database's files: survey/store/erasure/eraser.py.
trace = Table(
    "trace",
    metadata,
    Column("key", String(32), primary_key=True),
    Column("since", DateTime(timezone=True), nullable=False),
)


def begin_writing(connection: Connection) -> None:
    """Open the transaction as a writing one.

    SQLite: a transaction that reads first and writes then is refused at once when another wrote between,
    instead of waiting for its turn; sqlite3 itself opens none before the first change.
    """
    if connection.dialect.name == "sqlite":
        connection.exec_driver_sql("BEGIN IMMEDIATE")


def sqlite_file(where: Path | str) -> Path | None:
    """The file of an SQLite store in a data folder or of its URL; None for other databases and for one in memory."""
    if isinstance(where, Path):
        return where / SQLITE_FILE
    url = _url(where)
    return Path(url.database) if url.get_backend_name() == "sqlite" and url.database else None


def _url(where: str) -> URL:
    """Raises StoreError where the text is no URL of a database."""
    try:
        url = make_url(where)
    except (ArgumentError, ValueError):
        raise StoreError(
            "the database URL is none – write sqlite:///FILE or postgresql+psycopg://…"
        ) from None
    if url.get_backend_name() == "sqlite" and (
        url.query or url.drivername not in ("sqlite", "sqlite+pysqlite")
    ):
        raise StoreError(f"{url.drivername}: no such way to a file – write sqlite:///FILE without more")
    return url


def open_engine(where: Path | str) -> Engine:
    """Open the database: a data folder (SQLite file inside it, made when absent) or a database URL.

    Raises StoreError when the folder cannot be made or the URL is none.
    """
    if isinstance(where, Path):
        try:
            permissions.make_folder(where, SQLITE_FILE)
        except OSError as error:
            raise StoreError(f"{where}: no data folder ({error.strerror}) – give a writable one") from None
        url = make_url("sqlite://").set(database=str(where / SQLITE_FILE))
    else:
        url = _url(where)
    if url.get_backend_name() != "sqlite":
        try:
            return create_engine(url, pool_size=8, max_overflow=40, pool_pre_ping=True)
        except (NoSuchModuleError, ModuleNotFoundError) as error:
            raise StoreError(f"{url.get_backend_name()}: no driver ({error}) – pip install it") from None
    if not url.database or url.database == ":memory:":
        raise StoreError("a database in memory keeps nothing – write sqlite:///FILE")
    engine = _open_file(url, Path(url.database).absolute())
    event.listen(engine, "connect", _prepare_sqlite)
    return engine


def _open_file(url: URL, file: Path) -> Engine:
    try:
        if not file.exists():
            permissions.make_file(file)
    except OSError as error:
        raise StoreError(f"no database file ({error.strerror}) – give a writable place", str(file)) from None

    def connect() -> sqlite3.Connection:
        # mode=rw: a file that went away must be missed, not made anew and empty.
        # Threads of the web server share the pool, so a connection may move from one to another.
        return sqlite3.connect(
            f"{file.as_uri()}?mode=rw", uri=True, timeout=BUSY_SECONDS, check_same_thread=False
        )

    return create_engine(url, creator=connect, pool_size=8, max_overflow=40)


def _prepare_sqlite(connection, _record) -> None:
    cursor = connection.cursor()
    cursor.execute(f"PRAGMA busy_timeout={int(BUSY_SECONDS * 1000)}")
    cursor.execute("PRAGMA journal_mode=WAL")
    # NORMAL may lose the last commits when the power fails; an acknowledged answer must not be lost.
    cursor.execute("PRAGMA synchronous=FULL")
    cursor.execute("PRAGMA foreign_keys=ON")
    # What is sorted or rewritten stays in memory: a temporary file would lie outside of the data folder.
    cursor.execute("PRAGMA temp_store=MEMORY")
    # Builds differ in what they do unasked, and one may be without it.
    if cursor.execute("PRAGMA secure_delete=ON").fetchone() != (1,):
        raise StoreError(
            "this SQLite does not overwrite what is deleted – use Python with another build of it"
        )
    cursor.close()
