"""What the commands of `simcore learn` share: films of a folder, weights that may be tested, how far they are."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sim_core.learn.data import Film, Recipe, Take
    from sim_core.learn.inference import RivalTrained, Trained
    from sim_core.learn.pooling import Pooled

__all__ = ["Takes", "films_of", "never_seen", "progress", "reconstructed", "takes_of", "usual", "weights_of"]


def films_of(args: argparse.Namespace) -> dict[str, tuple[Recipe, Film]]:
    """The sequences of --data. Raises SimCoreError for a folder of another scene, and one that is not whole."""
    from sim_core.errors import SimCoreError
    from sim_core.learn.data import read_films

    every = read_films(args.data)
    if (found := next(iter(every.values()))[0].scene) != args.scene:
        raise SimCoreError(f"{args.data}: holds {found} – give the folder of {args.scene}")
    return every


@dataclass(frozen=True)
class Takes:
    """Sequences that are learned from, and those that are held back."""

    train: list[Take]
    test: list[Take]


def takes_of(args: argparse.Namespace, *, frames: int | None = None) -> Takes:
    """The sequences of --data, of no more than so many frames each. Raises what `films_of` does."""
    from sim_core.learn.data import Take, split

    films = films_of(args)
    parts = split([recipe for recipe, _ in films.values()])
    train, test = (
        [Take.of(*films[recipe.name]).first(frames) for recipe in part] for part in (parts.train, parts.test)
    )
    return Takes(train, test)


def reconstructed(takes: Takes, share: float, pooling: str) -> tuple[Takes, dict[str, Pooled]]:
    """The same from less than a share of their fine vertices, and which stay; decided by those learned from."""
    from sim_core.learn.data import pooled_by_kind, pooled_takes

    pooled = pooled_by_kind(takes.train, pooling, share)
    return Takes(pooled_takes(takes.train, pooled), pooled_takes(takes.test, pooled)), pooled


def weights_of(path: Path, scene: str) -> Trained | RivalTrained:
    """Weights that make fine cloth of a scene's coarse one. Raises SimCoreError for others."""
    from sim_core.errors import SimCoreError
    from sim_core.learn.inference import read_weights

    trained = read_weights(path)
    if (own := trained.told.get("scene")) != scene:
        raise SimCoreError(f"{path}: has learned {own} – give weights of {scene}, or infer {own}")
    if share := trained.told.get("share"):
        raise SimCoreError(
            f"{path}: trained with --share {share:g} – give weights that were trained without it"
        )
    return trained


def never_seen(path: Path, trained: Trained | RivalTrained, tested: Iterable[Recipe | Take]) -> None:
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
