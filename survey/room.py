"""A temporary folder that is full, told in one line that names it, whoever noticed."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from survey.errors import StoreError

__all__ = ["is_full", "room_in"]

_FULL = {errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC)}  # the disk, or its user's share of it


def is_full(error: OSError) -> bool:
    """Whether it says that there is no room."""
    return error.errno in _FULL


@contextmanager
def room_in(folder: Path | str) -> Iterator[None]:
    """Raises StoreError where what is written into a temporary folder finds no room there."""
    try:
        yield
    except OSError as error:
        if not is_full(error):
            raise
        # The folder is named to whoever asks as well: he has a token, and passes it on to whoever can free some.
        problem = f"no room in the temporary folder {folder} – free some, or set TMPDIR"
        raise StoreError(problem) from None
