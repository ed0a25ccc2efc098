"""Searching a database file, byte by byte, for what was erased from it."""

from __future__ import annotations

import os
import uuid
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

__all__ = ["BLOCK", "Erased", "erased_answer", "everything", "left_over"]

BLOCK = 1 << 20  # bytes read at a time …
OVERLAP = 512  # … and how many of them again with the next, more than anything that is looked for
PIECE, PIECES = 32, 8  # bytes of a text that are looked for, and at how many places of it beside its end
FEWEST = 12  # bytes: a shorter text is also somebody else's, and is found beside its id


@dataclass(frozen=True)
class Erased:
    """What was erased, and how it is known again.

    key: its row in the table of traces. A row of it is `head` followed by one of `tails`; `pieces` stand for
    themselves. Without a head it is not known what to look for.
    """

    key: str
    head: bytes = b""
    tails: tuple[bytes, ...] = ()
    pieces: tuple[bytes, ...] = ()

    @property
    def unknown(self) -> bool:
        return not self.head


def erased_answer(
    key: str, submission: str, digest: str, items: Sequence[str], texts: Mapping[str, str]
) -> Erased:
    """items: keys of its scores; texts: by module. Of the tombstone that stays none of it is found."""
    tails = tuple(name.encode() for name in (*items, *texts))
    # From the digest the scores could be guessed: they are few enough to try them all.
    pieces = (digest.encode(), *(piece for text in texts.values() for piece in _pieces(text.encode())))
    return Erased(key, submission.encode(), tails, tuple(filter(None, pieces)))


def everything() -> Erased:
    """Whatever was erased until now."""
    return Erased(uuid.uuid4().hex)


def _pieces(text: bytes) -> Iterator[bytes]:
    """Parts of a text, since other rows may have been written over others of it."""
    if FEWEST <= len(text) <= PIECE:
        yield text
    elif len(text) > PIECE:
        last = len(text) - PIECE
        yield from (text[at : at + PIECE] for at in {last * step // PIECES for step in range(PIECES + 1)})


def left_over(file: Path, erased: Sequence[Erased]) -> bool:
    """Whether the file still holds something of it. Raises OSError."""
    if not hasattr(os, "pread"):
        return True  # no way to look beside SQLite here: what may be there is taken to be there
    handle, at = _opened(file), 0
    while block := os.pread(handle, BLOCK + OVERLAP, at):
        if any(_holds(block, one) for one in erased):
            return True
        at += BLOCK
    return False


def _holds(block: bytes, erased: Erased) -> bool:
    if any(piece in block for piece in erased.pieces):
        return True
    at = block.find(erased.head)
    while at >= 0:
        if block.startswith(erased.tails, at + len(erased.head)):
            return True
        at = block.find(erased.head, at + 1)
    return False


_HANDLES: dict[tuple[int, int], int] = {}


def _opened(file: Path) -> int:
    """A handle for reading that is never closed.

    POSIX gives up all locks that a process has on a file when it closes any handle on it, SQLite's as well.
    """
    found = os.stat(file)
    name = (found.st_dev, found.st_ino)
    if name not in _HANDLES:
        handle = os.open(file, os.O_RDONLY | os.O_CLOEXEC)
        found = os.fstat(handle)
        name = (found.st_dev, found.st_ino)
        _HANDLES.setdefault(name, handle)
    return _HANDLES[name]
