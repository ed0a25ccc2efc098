"""Slow work beside the event loop: it never keeps the program from ending, and of some only the newest counts."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Coroutine
from typing import Any, Generic, TypeVar

__all__ = ["Latest", "in_thread"]

T = TypeVar("T")


async def in_thread(act: Callable[..., T], *given: object) -> T:
    """Await `act(*given)` in a thread of its own; raises what it raises.

    asyncio.to_thread would keep the loop from closing until the work is done; this thread is left to itself.
    """
    loop = asyncio.get_running_loop()
    future: asyncio.Future[T] = loop.create_future()

    def tell(result: T | None, error: BaseException | None) -> None:
        if future.done():
            return  # nobody waits any more
        if error is not None:
            future.set_exception(error)
        else:
            future.set_result(result)  # type: ignore[arg-type]

    def work() -> None:
        result, fault = None, None
        try:
            result = act(*given)
        except BaseException as error:  # whatever it is, it belongs to who waits
            fault = error
        if not loop.is_closed():
            try:
                loop.call_soon_threadsafe(tell, result, fault)
            except RuntimeError:  # closed just now
                return

    threading.Thread(target=work, daemon=True).start()
    return await future


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
