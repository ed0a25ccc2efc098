"""The store: answers go in once and whole, and come out for counting and for export."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from sqlalchemy import Connection, Engine, Table, delete, func, select, update
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.exc import DBAPIError, SQLAlchemyError

from survey.answer import Answer
from survey.errors import AnswerError, StoreError
from survey.questionnaire import Language, Questionnaire
from survey.store import tables
from survey.store.tokens import Tokens

__all__ = ["Receipt", "Store", "Stored"]


@dataclass(frozen=True)
class Receipt:
    """A committed submission. `replayed`: the same body had been committed before."""

    id: str
    replayed: bool


@dataclass(frozen=True)
class Stored:
    """One row for the researcher: the answer and when it was received (UTC)."""

    answer: Answer
    received: datetime


class Store:
    """Answers in a database. One writer at a time in this process; what returns is committed.

    where: the data folder (Path) or a database URL. Raises StoreError when it cannot be opened.
    """

    def __init__(self, where: Path | str) -> None:
        self._engine: Engine = tables.open_engine(where)
        self._writing = threading.Lock()
        with explained():
            tables.metadata.create_all(self._engine)
        self.tokens = Tokens(self._write, self._read)

    def close(self) -> None:
        """Give the connections back."""
        self._engine.dispose()

    def alive(self) -> None:
        """Ask the database for anything. Raises StoreError."""
        with self._read() as connection:
            connection.execute(select(1))

    def changed(self, questionnaire: Questionnaire) -> bool:
        """True when this version reads differently from what its first answer froze."""
        with self._read() as connection:
            return _frozen_digest(connection, questionnaire) not in (None, questionnaire.digest)

    def submit(self, questionnaire: Questionnaire, answer: Answer) -> Receipt:
        """Commit an answer. The same again is a replay of the first.

        Raises AnswerError: 409 the id was used for another answer, or the version was changed after its
        first answer; 410 the answer was withdrawn. Raises StoreError when nothing can be committed now.
        """
        with self._write() as connection:
            new_row = _insert_new(connection, tables.submission).values(
                id=answer.id,
                questionnaire=answer.questionnaire,
                version=answer.version,
                language=answer.language,
                exhibit=answer.exhibit,
                digest=answer.digest,
                received=datetime.now(UTC).replace(microsecond=0),
            )
            # RETURNING, because psycopg's count of rows does not tell an insert from a conflict.
            if connection.execute(new_row.returning(tables.submission.c.id)).first() is None:
                _check_replay(connection, answer)
                return Receipt(answer.id, replayed=True)
            _freeze(connection, questionnaire)
            rows = [{"submission": answer.id, "item": item, "score": score} for item, score in answer.scores]
            connection.execute(tables.answer.insert(), rows)
            if answer.suggestions:
                texts = [
                    {"submission": answer.id, "module": key, "text": text} for key, text in answer.suggestions
                ]
                connection.execute(tables.suggestion.insert(), texts)
        return Receipt(answer.id, replayed=False)

    def withdraw(self, questionnaire: str, submission: str) -> bool:
        """Take an answer back: its scores and suggestions are deleted. False when there is no such answer."""
        table = tables.submission
        with self._write() as connection:
            mine = (table.c.id == submission, table.c.questionnaire == questionnaire)
            empty = {"withdrawn": datetime.now(UTC).replace(microsecond=0), "digest": "", "exhibit": None}
            done = connection.execute(update(table).where(*mine, table.c.withdrawn.is_(None)).values(**empty))
            if done.rowcount == 0:
                return connection.execute(select(table.c.id).where(*mine)).first() is not None
            for part in (tables.answer, tables.suggestion):
                connection.execute(delete(part).where(part.c.submission == submission))
        return True

    def count(self, questionnaire: str, version: int) -> int:
        """How many answers stand."""
        table = tables.submission
        query = select(func.count()).select_from(table).where(*_standing(questionnaire, version))
        with self._read() as connection:
            return connection.execute(query).scalar_one()

    def versions(self, questionnaire: str) -> tuple[int, ...]:
        """The versions that were answered, the earliest first."""
        table = tables.version
        query = (
            select(table.c.version).where(table.c.questionnaire == questionnaire).order_by(table.c.version)
        )
        with self._read() as connection:
            return tuple(connection.execute(query).scalars())

    def rows(self, questionnaire: Questionnaire) -> tuple[Stored, ...]:
        """All answers to this version that stand, in the order in which they were received."""
        table = tables.submission
        of_submission = _standing(questionnaire.id, questionnaire.version)
        with self._snapshot() as connection:
            heads = connection.execute(
                select(table).where(*of_submission).order_by(table.c.received, table.c.id)
            ).all()
            scores = _grouped(connection, tables.answer, "item", "score", of_submission)
            texts = _grouped(connection, tables.suggestion, "module", "text", of_submission)
        return tuple(_stored(questionnaire, head, scores[head.id], texts.get(head.id, {})) for head in heads)

    def frozen(self, questionnaire: str, version: int) -> Questionnaire | None:
        """The version as it was asked, or None before its first answer."""
        table = tables.version
        query = select(table.c.document).where(
            table.c.questionnaire == questionnaire, table.c.version == version
        )
        with self._read() as connection:
            document = connection.execute(query).scalar_one_or_none()
        return None if document is None else Questionnaire.model_validate(document)

    @contextmanager
    def _read(self) -> Iterator[Connection]:
        with explained(), self._engine.connect() as connection:
            yield connection

    @contextmanager
    def _snapshot(self) -> Iterator[Connection]:
        """Several queries that see the same moment, whatever is withdrawn meanwhile."""
        with self._read() as connection:
            if connection.dialect.name == "sqlite":
                connection.exec_driver_sql("BEGIN")  # sqlite3 opens a transaction for writing only
            else:
                connection.execution_options(isolation_level="REPEATABLE READ")
            yield connection

    @contextmanager
    def _write(self) -> Iterator[Connection]:
        # Waiting here is fair and cheap; waiting for SQLite's own lock is a busy loop.
        with self._writing, explained(), self._engine.begin() as connection:
            yield connection


@contextmanager
def explained() -> Iterator[None]:
    """Turn the database's errors into a StoreError of one line."""
    try:
        yield
    except SQLAlchemyError as error:
        cause = error.orig if isinstance(error, DBAPIError) else error
        first = str(cause).strip().splitlines()[0] if str(cause).strip() else type(error).__name__
        raise StoreError(f"the database refuses: {first} – see that it is there, free and not full") from None


def _insert_new(connection: Connection, table: Table):
    """INSERT that leaves an existing key as it is."""
    insert = postgresql.insert if connection.dialect.name == "postgresql" else sqlite.insert
    return insert(table).on_conflict_do_nothing()


def _check_replay(connection: Connection, answer: Answer) -> None:
    table = tables.submission
    query = select(table.c.digest, table.c.withdrawn).where(table.c.id == answer.id)
    known = connection.execute(query).one()
    if known.withdrawn is not None:
        raise AnswerError("id", "this answer was withdrawn", "make a fresh id to answer anew", status=410)
    if known.digest != answer.digest:
        problem = "this id stands for another answer already"
        raise AnswerError("id", problem, "send the same body again, or make a fresh id", status=409)


def _frozen_digest(connection: Connection, questionnaire: Questionnaire) -> str | None:
    table = tables.version
    return connection.execute(
        select(table.c.digest).where(
            table.c.questionnaire == questionnaire.id, table.c.version == questionnaire.version
        )
    ).scalar_one_or_none()


def _freeze(connection: Connection, questionnaire: Questionnaire) -> None:
    """Keep the version as it is asked now; refuse when it was asked differently before."""
    connection.execute(
        _insert_new(connection, tables.version).values(
            questionnaire=questionnaire.id,
            version=questionnaire.version,
            digest=questionnaire.digest,
            document=questionnaire.document(),
        )
    )
    if _frozen_digest(connection, questionnaire) != questionnaire.digest:
        problem = f"version {questionnaire.version} was changed after its first answer"
        raise AnswerError("version", problem, "the curator raises `version` in the file", status=409)


def _standing(questionnaire: str, version: int):
    table = tables.submission
    return (table.c.questionnaire == questionnaire, table.c.version == version, table.c.withdrawn.is_(None))


def _grouped(connection: Connection, table: Table, key: str, value: str, of_submission) -> dict[str, dict]:
    """submission → {key: value} in one query."""
    query = (
        select(table.c.submission, table.c[key], table.c[value]).join(tables.submission).where(*of_submission)
    )
    groups: dict[str, dict] = {}
    for submission, name, content in connection.execute(query):
        groups.setdefault(submission, {})[name] = content
    return groups


def _stored(questionnaire: Questionnaire, head, scores: dict, texts: dict) -> Stored:
    language: Language = "zh" if head.language == "zh" else "en"
    answer = Answer(
        id=head.id,
        questionnaire=head.questionnaire,
        version=head.version,
        language=language,
        scores=tuple((item, scores[item]) for item in questionnaire.item_ids),
        suggestions=tuple((m.id, texts[m.id]) for m in questionnaire.modules if m.id in texts),
        exhibit=head.exhibit,
    )
    # SQLite gives the time back without its zone; it was written in UTC.
    received = head.received if head.received.tzinfo else head.received.replace(tzinfo=UTC)
    return Stored(answer, received.astimezone(UTC))
