"""Slow work beside the event loop of which only the newest counts."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any, Generic, TypeVar

__all__ = ["Latest"]

T = TypeVar("T")


class Latest(Generic[T]):
    """One piece of work at a time; beginning another gives the former up. Not thread-safe.

    failure: why the work was given up, None while it is under way, done, or none was begun.
    """

    def __init__(self) -> None:
        self._task: asyncio.Task[T] | None = None
        self._again: Callable[[], Coroutine[Any, Any, T]] | None = None
        self.failure: BaseException | None = None

    def begin(self, work: Callable[[], Coroutine[Any, Any, T]]) -> None:
        """Do this, and forget what was begun before. What fails is begun again, once."""
        self.drop()
        self._task, self._again = asyncio.ensure_future(work()), work

    def take(self) -> T | None:
        """What the work gave, once, when it is done; else None. Raises what it raised."""
        if self._task is None or not self._task.done():
            return None
        task, self._task = self._task, None
        error, again, self._again = task.exception(), self._again, None
        if error is not None and again is not None:
            self._task = asyncio.ensure_future(again())
        else:
            self.failure = error
        return task.result()

    def drop(self) -> None:
        """Give up what is under way."""
        if self._task is not None:
            self._task.cancel()
        self._task = self._again = self.failure = None
