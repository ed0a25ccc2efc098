"""What the commands of `simcore learn` share: films of a folder, weights that may be tested, how far they are."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sim_core.learn.data import Film, Recipe, Take
    from sim_core.learn.inference import RivalTrained, Trained

__all__ = ["Takes", "films_of", "in_wind", "never_seen", "progress", "takes_of", "usual", "weights_of"]


BLOWN = 900  # seed of gusts that no data have


def films_of(args: argparse.Namespace) -> dict[str, tuple[Recipe, Film]]:
    """The sequences of --data. Raises SimCoreError for a folder of another scene, and one that is not whole."""
    from sim_core.errors import SimCoreError
    from sim_core.learn.data import read_films

    every = read_films(args.data)
    if (found := next(iter(every.values()))[0].scene) != args.scene:
        raise SimCoreError(f"{args.data}: holds {found} – give the folder of {args.scene}")
    return every


class Takes:
    """Sequences that are learned from, whole, and those that are held back, of no more than so many frames each. What
    is learned from is only made ready where someone asks for it."""

    def __init__(self, films: Mapping[str, tuple[Recipe, Film]], frames: int | None = None) -> None:
        from sim_core.learn.data import Take, split

        self._films, self._parts = films, split([recipe for recipe, _ in films.values()])
        self.test = [Take.of(*films[recipe.name]).first(frames) for recipe in self._parts.test]

    @cached_property
    def train(self) -> list[Take]:
        from sim_core.learn.data import Take

        return [Take.of(*self._films[recipe.name]) for recipe in self._parts.train]


def takes_of(args: argparse.Namespace, *, frames: int | None = None) -> Takes:
    """The sequences of --data. Raises what `films_of` does."""
    return Takes(films_of(args), frames)


def in_wind(takes: Takes, wind: tuple[float, float, float], frames: int) -> None:
    """Has takes tested on a flag in another wind [m/s], simulated here and now, so many frames of it.

    Raises SimCoreError where no wind blows.
    """
    from sim_core.learn.data import Take, film, recipes

    scene = takes.test[0].recipe.scene
    (recipe,) = recipes(scene, sequences=1, frames=frames, seed=BLOWN)
    recipe, told = replace(recipe, wind=wind), progress()
    takes.test = [Take.of(recipe, film(recipe, lambda share: told(share, recipe.name)))]
    told(1.0, "")


def weights_of(path: Path, scene: str | None = None, share: float | None = None) -> Trained | RivalTrained:
    """Weights that make fine cloth of a scene's coarse one (None: any), or of a share of its own vertices.

    Raises SimCoreError for others.
    """
    from sim_core.errors import SimCoreError
    from sim_core.learn.inference import read_weights

    trained = read_weights(path)
    if scene is not None and (own := trained.told.get("scene")) != scene:
        raise SimCoreError(f"{path}: has learned {own} – give weights of {scene}")
    if (own := trained.told.get("share")) != share:
        words = f"trained with --share {own:g}" if own else "trained without --share"
        raise SimCoreError(f"{path}: {words} – give weights that were trained {_with(share)}")
    return trained


def _with(share: float | None) -> str:
    return f"with --share {share:g}" if share else "without it"


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
