"""The store: answers go in once and whole, and come out for counting and for export."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, wait
from contextlib import contextmanager
from datetime import date, datetime
from pathlib import Path

from sqlalchemy import Connection, Engine, delete, func, select, update

from survey.errors import AnswerError, SurveyError
from survey.questionnaire import Answer, Questionnaire
from survey.store.answers import Given, Stored, given_answer, given_of, standing, stored_rows
from survey.store.audit import Audit, note
from survey.store.commit import Entry, Receipt, Writer, commit_batch, freeze_version
from survey.store.database import (
    ANSWERS,
    Place,
    explained,
    in_utc,
    now,
    see_that_it_takes,
    tables,
    take_copy,
    write_copy,
)
from survey.store.erasure import (
    Erased,
    Eraser,
    Overdue,
    add_trace,
    clear_traces,
    erase,
    everything,
    overdue,
    rewrite_tables,
    traces,
    withdraw,
)
from survey.store.publication import Public, Publishing, forget
from survey.store.tokens import Tokens

__all__ = ["PATIENCE", "Store", "existing_store"]

PATIENCE = 5.0  # seconds that are waited for the last bytes of something erased to be gone from the files
OPENING = 2.0  # the same when a store is opened: a command need not wait for whoever reads


class Store:
    """Answers in a database. One writer in this process, with group commit; what returns is on the disk.

    where: the data folder (Path) or a database URL. Raises StoreError when it cannot be opened. file: of SQLite.
    """

    def __init__(self, where: Path | str) -> None:
        self.where = where  # a URL may hold a password: never shown
        self._engine: Engine = tables.open_engine(where)
        self._writing = threading.Lock()
        self._place = Place(self._engine)
        with explained(self._place.name):
            self._place.open()
        self._writer = Writer(self._commit)
        self._publishing = Publishing(self._snapshot, self._write)
        self.tokens = Tokens(self._write, self._read)
        self.audit = Audit(self._write, self._read)
        self.file = self._place.file
        self.withdrawn: Callable[[str], None] = _nobody_asks  # is told the id of what was taken back
        self._eraser = None if self.file is None else Eraser(self.file, self._alone, self._write)
        if self._eraser is not None and self._left():
            self.settle(OPENING)

    def close(self) -> None:
        """Write what waits and give the connections back."""
        self._writer.close()
        self._publishing.close()
        if self._eraser is not None:
            self._eraser.close()
        self._engine.dispose()
        self._place.close()

    def alive(self) -> None:
        """Ask the database for anything. Raises StoreError."""
        with self._read() as connection:
            connection.execute(select(1))

    def erasure_owed(self) -> bool:
        """Whether the last bytes of something erased may still be in the database's files. Raises StoreError."""
        left = self._left()
        if self._eraser is not None:
            self._eraser.watch(left)
        return bool(left)

    def _left(self) -> tuple[str, ...]:
        with self._read() as connection:
            return traces(connection)

    def settle(self, patience: float = 2 * PATIENCE) -> bool:
        """Take what was erased out of the database's files; False where that is not done within seconds.

        SQLite: then it is tried again and again, also after the next start. PostgreSQL: raises StoreError.
        """
        if self._eraser is not None:
            done = self._eraser.ask(everything())
            wait([done], patience)
            return done.done() and done.result()
        left = self._left()
        with explained(self._place.name), self._engine.connect() as connection:
            rewrite_tables(connection.execution_options(isolation_level="AUTOCOMMIT"))
        with self._write() as connection:
            clear_traces(connection, left)
        return True

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

    def tombstones(self) -> tuple[str, ...]:
        """The ids of all answers that were withdrawn or purged."""
        table = tables.submission
        with self._read() as connection:
            query = select(table.c.id).where(table.c.withdrawn.is_not(None))
            return tuple(connection.execute(query).scalars())

    def asked_of(self, questionnaire: str, submission: str) -> Questionnaire | None:
        """What was asked when the answer with this id was given; None: no such answer.

        Raises AnswerError 410 when it was withdrawn.
        """
        with self._snapshot() as connection:
            found = given_answer(connection, questionnaire, submission)
        if found is None:
            return None
        version, items = found
        asked = self.frozen(questionnaire, version)
        return None if asked is None else asked.asked(items)

    def of_codes(self, codes: Sequence[str]) -> dict[str, Given]:
        """What was answered under each of these ids; what is no answer's is left out."""
        with self._read() as connection:
            return given_of(connection, codes)

    def withdraw(self, questionnaire: str, submission: str) -> bool:
        """As take_back(), waiting PATIENCE for its last bytes to be gone. False when there is no such answer."""
        gone = self.take_back(questionnaire, submission)
        if gone is not None:
            wait([gone], PATIENCE)
        return gone is not None

    def take_back(self, questionnaire: str, submission: str) -> Future[bool] | None:
        """Delete scores and suggestions of an answer and commit that; None when there is no such answer.

        The future is of whether nothing of it can be read in the files any more; on PostgreSQL, which keeps deleted
        rows until its VACUUM, it is done at once. Raises AnswerError 409 once the answer was frozen for evaluation.
        """
        with self._write() as connection:
            erased = withdraw(connection, questionnaire, submission)
        if erased is False:
            return None
        self.withdrawn(submission)
        if self._eraser is not None and isinstance(erased, Erased):
            return self._eraser.ask(erased)
        done: Future[bool] = Future()
        done.set_result(True)
        return (self._eraser and self._eraser.busy()) or done

    def freeze(self, questionnaire: str) -> int:
        """Fix all standing answers for evaluation: they cannot be withdrawn any more. How many were fixed now."""
        table = tables.submission
        open_ones = (table.c.questionnaire == questionnaire, *_OPEN)
        with self._write() as connection:
            done = connection.execute(update(table).where(*open_ones).values(frozen=now()))
            note(connection, "freeze", questionnaire, done.rowcount)
            return done.rowcount

    def purge(self, questionnaire: str, version: int) -> int:
        """Erase all answers to a version whose retention has ended, and its public figures; tombstones stay.

        settle() takes them out of the files then.
        """
        with self._write() as connection:
            done = erase(connection, standing(questionnaire, version))
            forget(connection, questionnaire, version)
            note(connection, "purge", f"{questionnaire} version {version}", done)
            add_trace(connection)
            return done

    def overdue(self, today: date) -> tuple[Overdue, ...]:
        """What a purge on that day (UTC) would erase, by questionnaire and version."""
        asked = self.all_frozen()
        with self._snapshot() as connection:
            found = [overdue(connection, one, today) for one in asked]
        return tuple(one for one in found if one is not None)

    def newest(self) -> datetime | None:
        """When the last answer was received (UTC), None: there is none."""
        with self._read() as connection:
            found = connection.execute(select(func.max(tables.submission.c.received))).scalar()
        return None if found is None else in_utc(found)

    def all_frozen(self) -> tuple[Questionnaire, ...]:
        """Every frozen version, by questionnaire and version."""
        table = tables.version
        query = select(table.c.document).order_by(table.c.questionnaire, table.c.version)
        with self._read() as connection:
            documents = connection.execute(query).scalars().all()
        return tuple(Questionnaire.model_validate(document) for document in documents)

    def copy_to(self, path: Path) -> int:
        """Write a consistent copy of everything into a new SQLite file, while answers come in. Answers in it."""
        count = write_copy(self._engine, path)
        self.audit.note("backup", path.name, count)
        return count

    def see_that_it_takes(self, path: Path) -> None:
        """Upgrade a copy that copy_to wrote, where it lies, and see that this store is empty. Raises StoreError."""
        with self._read() as connection:
            see_that_it_takes(connection, path, ANSWERS)

    def take_copy(self, path: Path) -> int:
        """Take in such a copy, whole or not at all. Answers in it. Raises StoreError.

        Tokens end: one that was revoked after the copy was made must not be good again.
        """
        with self._write() as connection:
            count = take_copy(connection, path, ANSWERS)
            connection.execute(delete(tables.token))
            note(connection, "restore", path.name, count)
        return count

    def count(self, questionnaire: str, version: int) -> int:
        """How many answers stand."""
        table = tables.submission
        query = select(func.count()).select_from(table).where(*standing(questionnaire, version))
        with self._read() as connection:
            return connection.execute(query).scalar_one()

    def public(self, questionnaire: Questionnaire) -> Public:
        """The figures that everybody may see; a step further where enough answers came for one."""
        return self._publishing.of(questionnaire)

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
        with self._snapshot() as connection:
            return stored_rows(connection, questionnaire)

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
    def _alone(self) -> Iterator[Connection]:
        """A connection outside of any transaction, while nothing else is written here."""
        with self._writing, explained(self._place.name):
            self._place.check()
            with self._engine.connect() as connection:
                yield connection


def existing_store(where: Path | str) -> Store:
    """The store in a data folder or a database. Raises SurveyError where none was made yet.

    Reading must not make an empty one: a mistyped folder would look like a survey without answers.
    """
    file = tables.sqlite_file(where)
    if file is not None and not file.is_file():
        raise SurveyError(f"{file}: no such store – give --data (or --db) the one that was served")
    return Store(where)


def _nobody_asks(submission: str) -> None:
    """Of an answer that was taken back."""


_OPEN = (tables.submission.c.withdrawn.is_(None), tables.submission.c.frozen.is_(None))


def _frozen_digest(connection: Connection, questionnaire: Questionnaire) -> str | None:
    table = tables.version
    return connection.execute(
        select(table.c.digest).where(
            table.c.questionnaire == questionnaire.id, table.c.version == questionnaire.version
        )
    ).scalar_one_or_none()
