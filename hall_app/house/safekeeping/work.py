"""Which folders and files somebody is at work on, in this process or another: told by a lock that ends with it."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows: what is left there stays
    fcntl = None

__all__ = ["at_work", "is_left_over", "lock"]

_JUST_BEGUN = 60  # [s] for which what is empty may be about to be locked


@contextmanager
def at_work(folder: Path) -> Iterator[None]:
    """While it lasts the folder is no leaving."""
    if fcntl is None:
        yield
        return
    number = os.open(folder, os.O_RDONLY)
    try:
        lock(number)
        yield
    finally:
        os.close(number)


def is_left_over(path: Path) -> bool:
    """Whether nobody is at work on that folder or file any more."""
    try:
        number = os.open(path, os.O_RDONLY)
    except OSError:
        return False  # it is gone, or not ours
    try:
        empty = not any(path.iterdir()) if path.is_dir() else os.fstat(number).st_size == 0
        young = time.time() - os.fstat(number).st_mtime < _JUST_BEGUN
        return not (empty and young) and lock(number)
    except OSError:
        return False
    finally:
        os.close(number)


def lock(number: int) -> bool:
    """Lock an open file or folder until it is closed; whether it was free. Nothing is, where nothing can be locked."""
    if fcntl is None:
        return False
    try:
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
