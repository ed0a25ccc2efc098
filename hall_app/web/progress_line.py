"""Progress in words: one line that is written over on a terminal, a new line now and then anywhere else."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TextIO

__all__ = ["ProgressLine"]

EVERY = 5.0  # [s] between two lines of progress in a log
WIDTH = 78  # [characters] of a terminal's line


class ProgressLine:
    """What is under way, told to `stream` (default: standard output as it is at the time)."""

    def __init__(self, stream: TextIO | None = None, *, clock: Callable[[], float] = time.monotonic) -> None:
        self._stream, self._clock = stream, clock
        self._told, self._last = float("-inf"), ""
        self._open = False

    def tell(self, text: str, *, done: bool = False) -> None:
        """Say where it is; `done` ends the line, and is always said."""
        stream = self._stream or sys.stdout
        text = text.strip()
        if stream.isatty():
            shown = text if done else text[:WIDTH]
            stream.write(f"\r{shown:<{WIDTH}}" + ("\n" if done else ""))
            self._open = not done
        elif done or (text != self._last and self._clock() - self._told >= EVERY):
            stream.write(f"{text}\n")
            self._last = text
            self._told = float("-inf") if done else self._clock()
        stream.flush()

    def end(self) -> None:
        """Leave a line that was not finished, so that what follows stands on its own."""
        if self._open:
            stream = self._stream or sys.stdout
            stream.write("\n")
            stream.flush()
            self._open = False
