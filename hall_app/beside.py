"""Work beside the event loop that never keeps the program from ending."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from typing import TypeVar

__all__ = ["beside"]

T = TypeVar("T")


async def beside(act: Callable[..., T], *given: object) -> T:
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
