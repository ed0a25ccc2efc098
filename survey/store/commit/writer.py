"""Group commit: one thread writes everything that waits in one transaction, with one sync to the disk."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Future

from survey.errors import AnswerError, StoreError
from survey.store.commit.batch import Entry, Receipt

__all__ = ["BATCH_SIZE", "Writer"]

BATCH_SIZE = 200  # entries of one transaction: bounds how long the first of them waits

Commit = Callable[[Sequence[Entry]], list[Receipt | AnswerError]]


class Writer:
    """Takes entries from any thread; `commit` writes a batch and returns once it is on the disk.

    The thread starts with the first entry and ends with close(). A batch that fails as a whole is tried once
    more entry by entry, unless the database itself refuses (StoreError): then every waiting one hears so.
    """

    def __init__(self, commit: Commit) -> None:
        self._commit = commit
        self._waiting: queue.SimpleQueue[tuple[Entry, Future[Receipt]] | None] = queue.SimpleQueue()
        self._thread: threading.Thread | None = None
        self._starting = threading.Lock()

    def put(self, entry: Entry) -> Future[Receipt]:
        """A future of the receipt; it fails with AnswerError or StoreError."""
        future: Future[Receipt] = Future()
        with self._starting:
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="survey-writer", daemon=True)
                self._thread.start()
            self._waiting.put((entry, future))
        return future

    def close(self) -> None:
        """Write what waits, then end the thread. A later put() starts it again."""
        with self._starting:
            thread, self._thread = self._thread, None
            if thread is not None:
                self._waiting.put(None)
                thread.join()

    def _run(self) -> None:
        while True:
            batch, ended = self._next()
            # A visitor who hung up before the write began is not written; afterwards the write stands.
            batch = [(entry, future) for entry, future in batch if future.set_running_or_notify_cancel()]
            if batch:
                self._write(batch)
            if ended:
                return

    def _next(self) -> tuple[list[tuple[Entry, Future[Receipt]]], bool]:
        """What waits now, at least one and at most BATCH_SIZE; and whether the end was asked for."""
        batch: list[tuple[Entry, Future[Receipt]]] = []
        try:
            found = self._waiting.get()
            while found is not None:
                batch.append(found)
                if len(batch) == BATCH_SIZE:
                    return batch, False
                found = self._waiting.get_nowait()
        except queue.Empty:
            return batch, False
        return batch, True

    def _write(self, batch: Sequence[tuple[Entry, Future[Receipt]]]) -> None:
        try:
            outcomes = self._commit([entry for entry, _ in batch])
        except StoreError as error:
            for _, future in batch:
                future.set_exception(StoreError(error.problem, error.place))
            return
        except Exception as error:  # nothing may end this thread: everybody after would wait for ever
            if len(batch) == 1:
                batch[0][1].set_exception(error)
                return
            for single in batch:
                self._write([single])
            return
        for (_, future), outcome in zip(batch, outcomes, strict=True):
            if isinstance(outcome, Receipt):
                future.set_result(outcome)
            else:
                future.set_exception(outcome)
