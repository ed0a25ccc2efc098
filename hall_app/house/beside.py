"""Work that would hold the server up, in a process of its own that ends with it."""

from __future__ import annotations

from collections.abc import Callable
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import TypeVar

__all__ = ["beside"]

T = TypeVar("T")


def beside(act: Callable[..., T], *given: object, within: float | None = None) -> T | None:
    """What `act(*given)` gives; None where the process ended without. For a thread that may wait.

    act: at the top of a module, as everything is that goes to another process; within: [s] after which it is ended.
    """
    context = get_context("spawn")
    here, there = context.Pipe(duplex=False)
    with here:
        process = context.Process(target=_run, args=(there, act, given), daemon=True)
        process.start()
        there.close()
        try:
            if here.poll(within):
                return here.recv()
            process.kill()
            return None
        except EOFError:
            return None
        finally:
            process.join()


def _run(answer: Connection, act: Callable[..., object], given: tuple[object, ...]) -> None:
    answer.send(act(*given))
