"""Memory of visitors who have left, given back.

Every view's connection leaves cycles behind that hold the scene's bytes (viser's suspended producers and their
exceptions), some megabytes a visitor. Python's collector looks at such old objects only when the whole heap has grown
by a quarter, and glibc keeps what is freed between blocks in use. Without this the hall grows by every visit.
"""

from __future__ import annotations

import asyncio
import contextlib
import ctypes
import gc

from hall_app.house.background import in_thread

__all__ = ["Tidying", "settle"]

_AFTER = 3.0  # [s] of those who leave together, once


def settle() -> None:
    """What stands now stands until the end: the collector need not walk through it again."""
    gc.collect()
    gc.freeze()


class Tidying:
    """Gives memory back a moment after somebody has left; however many leave in that moment, once."""

    def __init__(self) -> None:
        self._timer: asyncio.TimerHandle | None = None
        self._trimming: asyncio.Task[None] | None = None

    def soon(self) -> None:
        """Somebody has left."""
        if self._timer is None:
            self._timer = asyncio.get_running_loop().call_later(_AFTER, self._begin)

    def _begin(self) -> None:
        self._timer = None
        gc.collect()
        self._trimming = asyncio.ensure_future(in_thread(_trim))


def _trim() -> None:
    """Hand free blocks back to the system; only glibc keeps them."""
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)
