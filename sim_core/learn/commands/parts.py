"""What the commands of `simcore learn` share: films of a folder, weights that may be tested, how far they are."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sim_core.learn.data import Film, Recipe
    from sim_core.learn.inference import RivalTrained, Trained

__all__ = ["films_of", "never_seen", "progress", "usual"]


def films_of(args: argparse.Namespace) -> dict[str, tuple[Recipe, Film]]:
    """The sequences of --data. Raises SimCoreError for a folder of another scene, and one that is not whole."""
    from sim_core.errors import SimCoreError
    from sim_core.learn.data import read_films

    every = read_films(args.data)
    if (found := next(iter(every.values()))[0].scene) != args.scene:
        raise SimCoreError(f"{args.data}: holds {found} – give the folder of {args.scene}")
    return every


def never_seen(path: Path, trained: Trained | RivalTrained, tested: Iterable[Recipe]) -> None:
    """Raises SimCoreError for weights of a file that have learned from what they would be tested on."""
    from sim_core.errors import SimCoreError

    if seen := {one.name for one in tested} & set(trained.told.get("learned_from", ())):
        raise SimCoreError(f"{path}: learned from {', '.join(sorted(seen))}, which would be tested on")


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


def usual(made: np.ndarray, fine: np.ndarray) -> int:
    """The frame whose mean error is in the middle of all of them: neither the best nor the worst."""
    errors = [
        float(np.linalg.norm(one - other, axis=1).mean()) for one, other in zip(made, fine, strict=True)
    ]
    return int(np.argsort(errors)[len(errors) // 2])
