"""Erased is erased: after a deletion nothing of it stays in an SQLite file or its WAL, or it is told that it does.

SQLite overwrites what it deletes (secure_delete), but the pages as they were stay in the WAL until a checkpoint has
emptied it. And where SQLite moves rows between pages, copies of them stay in the unused part of a page, out of reach
of a later deletion: so the file is searched for what was deleted, and rewritten (VACUUM) where that is found.

PostgreSQL keeps deleted rows until its VACUUM; `rewrite_tables` asks for it.
"""

from __future__ import annotations

import logging
import threading
import time
import uuid
from collections.abc import Sequence
from concurrent.futures import Future
from pathlib import Path

from sqlalchemy import Connection, delete, select

from survey.store.database import Session, now, tables
from survey.store.erasure.leftovers import Erased, everything, left_over

__all__ = ["Eraser", "add_trace", "clear_traces", "rewrite_tables", "traces"]

MOST = 20  # erasures looked for at once; of more the file is rewritten without a look
BUSY_MS = 50  # a checkpoint that waits for a reader keeps writers waiting
FIRST_PAUSE, LONGEST_PAUSE = 0.05, 5.0  # seconds between two tries
REST = 20.0  # after a rewriting, during which nothing is written, none for so many times as long
LINGERING = 60.0  # seconds after which what another process left is taken up

_LOG = logging.getLogger(__name__)


def add_trace(connection: Connection) -> str:
    """Remember in the erasing transaction that the last bytes are still to go; the key of the row."""
    key = uuid.uuid4().hex
    connection.execute(tables.trace.insert().values(key=key, since=now()))
    return key


def traces(connection: Connection) -> tuple[str, ...]:
    """The keys of the erasures whose last bytes may still be there."""
    return tuple(connection.execute(select(tables.trace.c.key)).scalars())


def clear_traces(connection: Connection, keys: Sequence[str]) -> None:
    """Forget them: nothing is left of these."""
    for start in range(0, len(keys), 500):
        connection.execute(delete(tables.trace).where(tables.trace.c.key.in_(keys[start : start + 500])))


def rewrite_tables(connection: Connection) -> None:
    """Have PostgreSQL write its tables anew, without the rows that were deleted. The connection is in AUTOCOMMIT."""
    connection.exec_driver_sql("SET lock_timeout = '15s'")
    try:
        for table in (tables.answer, tables.suggestion, tables.submission):
            connection.exec_driver_sql(f"VACUUM (FULL) {table.name}")
    finally:
        connection.exec_driver_sql("RESET lock_timeout")


class Eraser:
    """Takes the last bytes of what was erased out of an SQLite file, in a thread of its own.

    alone: a connection outside of any transaction, while this process writes nothing else; write: a writing
    transaction. What cannot be done now, since somebody reads or the disk is full, is tried again until it is done.
    """

    def __init__(self, file: Path, alone: Session, write: Session) -> None:
        self._file, self._alone, self._write = file, alone, write
        self._starting, self._changed = threading.Lock(), threading.Condition()
        self._waiting: list[tuple[Erased, Future[bool]]] = []
        self._thread: threading.Thread | None = None
        self._closing = False
        self._rewritten: set[str] = set()  # keys of which the WAL alone may still hold something
        self._rested = 0.0
        self._lingering: tuple[tuple[str, ...], float] = ((), 0.0)

    def ask(self, erased: Erased) -> Future[bool]:
        """A future of True once nothing is left of it, or of False where the store is closed before."""
        future: Future[bool] = Future()
        future.set_running_or_notify_cancel()  # whoever hangs up takes nothing back: it is deleted already
        with self._starting, self._changed:
            self._waiting.append((erased, future))
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="survey-eraser", daemon=True)
                self._thread.start()
            self._changed.notify()
        return future

    def busy(self) -> Future[bool] | None:
        """A future of all that waits now; None where nothing does."""
        with self._changed:
            return self._waiting[-1][1] if self._waiting else None

    def watch(self, left: tuple[str, ...]) -> None:
        """Take up what has been left over for a minute: another process erased it and is gone, or waits for us."""
        before, since = self._lingering
        if not left or left != before:
            self._lingering = (left, time.monotonic())
        elif time.monotonic() - since > LINGERING and self.busy() is None:
            self._lingering = (left, time.monotonic())
            self.ask(everything())

    def close(self) -> None:
        """Try once more what waits, then end the thread. A later ask() starts it again."""
        with self._starting:
            with self._changed:
                thread, self._thread, self._closing = self._thread, None, True
                self._changed.notify()
            if thread is not None:
                thread.join()
            self._closing = False

    def _run(self) -> None:
        pause, told = FIRST_PAUSE, False
        while batch := self._next():
            trouble = self._trouble([erased for erased, _ in batch])
            if trouble and not told and pause > 1.0:
                told = True
                _LOG.warning(
                    "%s: what was erased can still be read in it (%s) – tried again", self._file, trouble
                )
            with self._changed:
                if not trouble or self._closing:
                    self._waiting = self._waiting[len(batch) :]
                    for _, future in batch:
                        future.set_result(not trouble)
                elif len(self._waiting) == len(batch):
                    self._changed.wait(pause)
            pause = min(2 * pause, LONGEST_PAUSE) if trouble else FIRST_PAUSE
            if told and not trouble:
                told = False
                _LOG.warning("%s: what was erased is gone from it now", self._file)

    def _next(self) -> list[tuple[Erased, Future[bool]]]:
        """All that waits, at least one; nothing at the end."""
        with self._changed:
            while not self._waiting and not self._closing:
                self._changed.wait()
            return list(self._waiting)

    def _trouble(self, batch: Sequence[Erased]) -> str:
        """Why it could not be done now; empty once it is done."""
        try:
            trouble = self._tried(batch)
            if not trouble:
                with self._write() as connection:
                    clear_traces(connection, tuple(self._rewritten | {erased.key for erased in batch}))
                self._rewritten.clear()
        except Exception as error:  # nothing may end this thread: what is owed would be owed for ever
            return str(error)
        return trouble

    def _tried(self, batch: Sequence[Erased]) -> str:
        if not self._emptied():
            return _READER
        wanted = [erased for erased in batch if erased.key not in self._rewritten]
        unknown = len(wanted) > MOST or any(erased.unknown for erased in wanted)
        # While it is looked for others may write: what lies in an unused part of a page moves no more.
        if not wanted or not (unknown or left_over(self._file, wanted)):
            return ""
        if time.monotonic() < self._rested:
            return "it was rewritten a moment ago, and is to be once more"
        return "" if self._emptied(rewritten=wanted) else _READER

    def _emptied(self, rewritten: Sequence[Erased] = ()) -> bool:
        """Write the WAL into the file and cut it to nothing. False where a reader still needs it.

        rewritten: for whose sake all that stands is written anew before.
        """
        with self._alone() as connection:
            # Waiting for a reader holds up whoever wants to write, so it is short and often.
            connection.exec_driver_sql(f"PRAGMA busy_timeout={BUSY_MS}")
            try:
                if rewritten:
                    self._rewrite(connection, rewritten)
                busy, _, _ = connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)").one()
            finally:
                connection.exec_driver_sql(f"PRAGMA busy_timeout={int(tables.BUSY_SECONDS * 1000)}")
        return not busy

    def _rewrite(self, connection: Connection, wanted: Sequence[Erased]) -> None:
        begun, left = time.monotonic(), traces(connection)
        connection.rollback()  # the look began a transaction
        connection.exec_driver_sql("VACUUM")
        self._rewritten |= {*left, *(erased.key for erased in wanted)}
        self._rested = time.monotonic() + REST * (time.monotonic() - begun)


_READER = "somebody reads it"
