"""What the commands of `simcore learn` share: the films of a folder, and how far they are."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim_core.learn.data import Film, Recipe

__all__ = ["films_of", "progress"]


def films_of(args: argparse.Namespace) -> dict[str, tuple[Recipe, Film]]:
    """The sequences of --data. Raises SimCoreError for a folder of another scene, and one that is not whole."""
    from sim_core.errors import SimCoreError
    from sim_core.learn.data import read_films

    every = read_films(args.data)
    if (found := next(iter(every.values()))[0].scene) != args.scene:
        raise SimCoreError(f"{args.data}: holds {found} – give the folder of {args.scene}")
    return every


def progress() -> Callable[[float, str], None]:
    """Tells the share and the time left on stderr, where someone looks."""
    began, first = time.monotonic(), None

    def told(share: float, words: str) -> None:
        nonlocal first
        if first is None:
            first = share
        gone = time.monotonic() - began
        left = gone * (1.0 - share) / (share - first) if share > first else 0.0
        if sys.stderr.isatty():
            sys.stderr.write(f"\r{100 * share:5.1f} %  {words:<12} {left / 60:5.1f} min left ")
            sys.stderr.write("\n" if share >= 1.0 else "")
            sys.stderr.flush()

    return told
