"""Work that would hold the server up, in a process of its own that ends with it."""

from __future__ import annotations

from collections.abc import Callable
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import TypeVar

__all__ = ["beside", "end_all"]

T = TypeVar("T")
_AT_WORK: set[BaseProcess] = set()


def beside(act: Callable[..., T], *given: object, within: float | None = None) -> T | None:
    """What `act(*given)` gives; None where the process ended without. For a thread that may wait.

    act: at the top of a module, as everything is that goes to another process; within: [s] after which it is ended.
    """
    context = get_context("spawn")
    here, there = context.Pipe(duplex=False)
    with here:
        process = context.Process(target=_run, args=(there, act, given), daemon=True)
        process.start()
        _AT_WORK.add(process)
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
            _AT_WORK.discard(process)


def end_all() -> None:
    """End what is under way, for a server that ends: it would wait for the threads that wait for this."""
    for process in tuple(_AT_WORK):
        process.kill()


def _run(answer: Connection, act: Callable[..., object], given: tuple[object, ...]) -> None:
    answer.send(act(*given))
