"""The store: answers go in once and whole, and come out for counting and for export."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from sqlalchemy import ColumnElement, Connection, Engine, Table, delete, func, select, update
from sqlalchemy.exc import DataError, DBAPIError, IntegrityError, SQLAlchemyError

from survey.answer import Answer
from survey.errors import AnswerError, StoreError
from survey.questionnaire import Language, Questionnaire
from survey.store import tables
from survey.store.backup import write_copy
from survey.store.committing import Entry, Receipt, commit_batch, freeze_version, now
from survey.store.place import Place
from survey.store.tally import Tallies, Tally
from survey.store.tokens import Tokens
from survey.store.writer import Writer

__all__ = ["Receipt", "Store", "Stored"]


@dataclass(frozen=True)
class Stored:
    """One row for the researcher: the answer and when it was received (UTC)."""

    answer: Answer
    received: datetime


class Store:
    """Answers in a database. One writer in this process, with group commit; what returns is on the disk.

    where: the data folder (Path) or a database URL. Raises StoreError when it cannot be opened.
    """

    def __init__(self, where: Path | str) -> None:
        self._engine: Engine = tables.open_engine(where)
        self._writing = threading.Lock()
        self._place = Place(self._engine)
        with explained(self._place.name):
            self._place.open()
        self._writer = Writer(self._commit)
        self._tallies = Tallies(self._snapshot)
        self.tokens = Tokens(self._write, self._read)

    def close(self) -> None:
        """Write what waits and give the connections back."""
        self._writer.close()
        self._engine.dispose()
        self._place.close()

    def alive(self) -> None:
        """Ask the database for anything. Raises StoreError."""
        with self._read() as connection:
            connection.execute(select(1))

    def changed(self, questionnaire: Questionnaire) -> bool:
        """True when this version reads differently from what its publication froze."""
        with self._read() as connection:
            return _frozen_digest(connection, questionnaire) not in (None, questionnaire.digest)

    def publish(self, questionnaire: Questionnaire) -> bool:
        """Freeze a version as it reads now. False when it was frozen with another content."""
        with self._write() as connection:
            return freeze_version(connection, questionnaire)

    def submit(self, questionnaire: Questionnaire, answer: Answer) -> Receipt:
        """Commit an answer. The same again is a replay of the first.

        Raises AnswerError: 409 the id was used for another answer, or the version was changed after its
        first answer; 410 the answer was withdrawn. Raises StoreError when nothing can be committed now.
        """
        return self.enqueue(questionnaire, answer).result()

    def enqueue(self, questionnaire: Questionnaire, answer: Answer) -> Future[Receipt]:
        """As submit(), without waiting: all that wait are committed together."""
        return self._writer.put((questionnaire, answer))

    def _commit(self, entries: Sequence[Entry]) -> list[Receipt | AnswerError]:
        with self._write() as connection:
            return commit_batch(connection, entries)

    def known(self, submission: str) -> bool:
        """True when an answer with this id is stored, also as a tombstone."""
        table = tables.submission
        with self._read() as connection:
            return connection.execute(select(table.c.id).where(table.c.id == submission)).first() is not None

    def version_of(self, questionnaire: str, submission: str) -> Questionnaire | None:
        """The version to which the answer with this id was given, also of a tombstone; None: no such answer."""
        table = tables.submission
        mine = (table.c.id == submission, table.c.questionnaire == questionnaire)
        with self._read() as connection:
            found = connection.execute(select(table.c.version).where(*mine)).scalar_one_or_none()
        return None if found is None else self.frozen(questionnaire, found)

    def withdraw(self, questionnaire: str, submission: str) -> bool:
        """Take an answer back: its scores and suggestions are deleted. False when there is no such answer.

        Raises AnswerError 409 once the answers were frozen for evaluation.
        """
        table = tables.submission
        with self._write() as connection:
            mine = (table.c.id == submission, table.c.questionnaire == questionnaire)
            # Held until the commit: another process must not freeze between this look and the erasure. SQLite's
            # writing transaction holds everything already.
            asked = select(table.c.withdrawn, table.c.frozen).where(*mine).with_for_update()
            found = connection.execute(asked).first()
            if found is None:
                return False
            if found.withdrawn is None:
                if found.frozen is not None:
                    raise AnswerError("id", *_TOO_LATE, status=409)
                _erase(connection, (table.c.id == submission,))
        return True

    def freeze(self, questionnaire: str) -> int:
        """Fix all standing answers for evaluation: they cannot be withdrawn any more. How many were fixed now."""
        table = tables.submission
        open_ones = (table.c.questionnaire == questionnaire, *_OPEN)
        with self._write() as connection:
            done = connection.execute(update(table).where(*open_ones).values(frozen=now()))
            connection.execute(tables.audit.insert().values(at=now(), action="freeze", subject=questionnaire))
            return done.rowcount

    def purge(self, questionnaire: str, version: int) -> int:
        """Erase all answers to a version whose retention has ended, frozen or not; tombstones stay."""
        with self._write() as connection:
            done = _erase(connection, _standing(questionnaire, version))
            subject = f"{questionnaire} {version}"
            connection.execute(tables.audit.insert().values(at=now(), action="purge", subject=subject))
            return done

    def all_frozen(self) -> tuple[Questionnaire, ...]:
        """Every frozen version, by questionnaire and version."""
        table = tables.version
        query = select(table.c.document).order_by(table.c.questionnaire, table.c.version)
        with self._read() as connection:
            documents = connection.execute(query).scalars().all()
        return tuple(Questionnaire.model_validate(document) for document in documents)

    def copy_to(self, path: Path) -> int:
        """Write a consistent copy of everything into a new SQLite file, while answers come in. Answers in it."""
        return write_copy(self._engine, path)

    def count(self, questionnaire: str, version: int) -> int:
        """How many answers stand."""
        table = tables.submission
        query = select(func.count()).select_from(table).where(*_standing(questionnaire, version))
        with self._read() as connection:
            return connection.execute(query).scalar_one()

    def tally(self, questionnaire: Questionnaire) -> Tally:
        """Counts and sums over the answers that stand; counted anew only after a change."""
        return self._tallies.of(questionnaire)

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
        with explained(self._place.name):
            self._place.check()
            with self._engine.connect() as connection:
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
        with self._writing, explained(self._place.name):
            self._place.check()
            with self._engine.connect() as connection:
                tables.begin_writing(connection)
                yield connection
                connection.commit()
            # What was written into a file that went away meanwhile must not be acknowledged.
            self._place.check()


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


_OPEN = (tables.submission.c.withdrawn.is_(None), tables.submission.c.frozen.is_(None))
_TOO_LATE = (
    "the answers were frozen for evaluation, so this one cannot be withdrawn any more",
    "ask the curator; no name was stored with it",
)


def _erase(connection: Connection, which: tuple[ColumnElement[bool], ...]) -> int:
    """Delete scores and texts of the submissions; the rows stay as tombstones."""
    table = tables.submission
    ids = select(table.c.id).where(*which)
    for part in (tables.answer, tables.suggestion):
        connection.execute(delete(part).where(part.c.submission.in_(ids)))
    empty = {"withdrawn": now(), "digest": "", "exhibit": None}
    return connection.execute(update(table).where(*which).values(**empty)).rowcount


def _frozen_digest(connection: Connection, questionnaire: Questionnaire) -> str | None:
    table = tables.version
    return connection.execute(
        select(table.c.digest).where(
            table.c.questionnaire == questionnaire.id, table.c.version == questionnaire.version
        )
    ).scalar_one_or_none()


def _standing(questionnaire: str, version: int) -> tuple[ColumnElement[bool], ...]:
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
