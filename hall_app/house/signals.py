"""Ctrl-C and its kin at the right moment: where an exception out of nowhere would do harm, it does not come."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
from collections.abc import Iterator

__all__ = ["at_once", "undisturbed"]

_ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()  # the others get no signals


@contextlib.contextmanager
def undisturbed() -> Iterator[None]:
    """Put the signals off until the block is left, while something is begun that has to be ended again."""
    if not _in_main_thread():
        yield
        return
    came: list[int] = []
    before = {sign: signal.signal(sign, lambda number, frame: came.append(number)) for sign in _ENDING}
    try:
        yield
    finally:
        for sign, act in before.items():
            signal.signal(sign, act)
        for number in came:
            signal.raise_signal(number)


@contextlib.contextmanager
def at_once() -> Iterator[None]:
    """In the block the signals end the program on the spot, status 0: nothing in it has to be undone.

    A KeyboardInterrupt would not do. FCL's and other compiled modules' calls back into Python print and forget it, and
    the hall would open as if nobody had pressed Ctrl-C; some turn it into an error of their own; and one that passes
    through an import leaves a mark by which Python kills itself at the end.
    """
    if not _in_main_thread():
        yield
        return
    before = {sign: signal.signal(sign, _leave) for sign in _ENDING}
    try:
        yield
    finally:
        for sign, act in before.items():
            signal.signal(sign, act)


def _leave(number: int, frame: object) -> None:
    if os.isatty(1):
        os.write(1, b"\n")  # not print: it may be what was interrupted
    os._exit(0)
