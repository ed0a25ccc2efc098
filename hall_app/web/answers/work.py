"""Slow work for visitors: done once for all who wait for it, little of it at once, its answers kept while they hold."""

from __future__ import annotations

import asyncio
import threading
from collections import deque
from collections.abc import Callable, Hashable
from concurrent.futures import Future
from typing import Any, TypeVar

__all__ = ["SLOW", "Answers", "Work"]

T = TypeVar("T")

AT_ONCE = (
    3  # however many ask: what is rendered holds Python's lock, and the walkers need it sixty times a second
)


class Work:
    """Work in at most `at_once` threads, which end when there is none and never keep the program from ending."""

    def __init__(self, at_once: int = AT_ONCE) -> None:
        self._at_once, self._threads = at_once, 0
        self._changing = threading.Lock()
        self._asked: deque[tuple[Hashable, Callable[[], Any], Future[Any]]] = deque()
        self._begun: dict[Hashable, Future[Any]] = {}

    def begin(self, key: Hashable, make: Callable[[], T]) -> Future[T]:
        """What `make()` will give; who asks for `key` while it is under way gets the same. From any thread.

        `make` must not wait for other work: there may be no thread left for that.
        """
        with self._changing:
            if key in self._begun:
                return self._begun[key]
            future: Future[T] = Future()
            future.set_running_or_notify_cancel()  # one of several who wait cannot cancel it
            self._begun[key] = future
            self._asked.append((key, make, future))
            if self._threads < self._at_once:
                self._threads += 1
                threading.Thread(target=self._run, daemon=True).start()
            return future

    async def of(self, key: Hashable, make: Callable[[], T]) -> T:
        """Await it; raises what `make` raises."""
        return await asyncio.shield(asyncio.wrap_future(self.begin(key, make)))

    def _run(self) -> None:
        while True:
            with self._changing:
                if not self._asked:
                    self._threads -= 1
                    return
                key, make, future = self._asked.popleft()
            result, fault = None, None
            try:
                result = make()
            except BaseException as error:  # whatever it is, it belongs to who waits
                fault = error
            with self._changing:
                del self._begun[key]
            if fault is not None:
                future.set_exception(fault)
            else:
                future.set_result(result)
            del make, future, result, fault  # megabytes, until there is work again


SLOW = Work()  # the process's: what bounds it is the machine


class Answers:
    """Answers about something that changes seldom: each is made once per state, those of former states forgotten.

    For the event loop. `keys` of one state must be bounded by what there is, not by what is asked for.
    """

    def __init__(self, work: Work = SLOW) -> None:
        self._work = work
        self._state: object = None
        self._kept: dict[Hashable, Any] = {}

    async def of(self, state: Hashable, key: Hashable, make: Callable[[], T]) -> T:
        """The answer to `key` in `state`, by `make()` in a thread the first time; raises what that raises."""
        if state != self._state:
            self._state, self._kept = state, {}
        kept = self._kept  # of this state, also when there is another by the time it is made
        if key not in kept:
            kept[key] = await self._work.of((id(self), state, key), make)
        return kept[key]
