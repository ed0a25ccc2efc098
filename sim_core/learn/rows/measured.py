"""Rows measured: their errors on sequences that nobody has learned from, and what a frame costs."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.learn.data import Film, Pair, Recipe, floor
from sim_core.learn.evaluation import ErrorSummary, FrameErrors, frame_errors, summary
from sim_core.learn.rows.row import Row

__all__ = ["EVERY", "Measured", "Told", "followed", "measured", "reference"]

EVERY = 5  # frames from one that is measured to the next
Told = Callable[[float, str], None]


@dataclass(frozen=True)
class Measured:
    """A row: its errors over all measured frames of all sequences, by sequence, and ms of processor time a frame."""

    errors: ErrorSummary
    by_sequence: Mapping[str, ErrorSummary]
    milliseconds: float

    def told(self) -> dict[str, Any]:
        """In millimetres and degrees, as `--json` has it."""
        mean, p95 = self.errors.mean, self.errors.p95
        return {
            "mean_mm": _mm(mean.vertex),
            "hausdorff_mm": _mm(mean.hausdorff),
            "p95_mm": _mm(p95.hausdorff),
            "surface_mm": _mm(mean.surface),
            "normal_deg": round(mean.normal, 3),
            "strain": round(mean.strain, 5),
            "intersections": round(mean.intersections, 1),
            "reference_intersections": round(mean.reference_intersections, 1),
            "net_ms": round(self.milliseconds, 3),
            "frames": self.errors.frames,
        }


def _mm(length: float) -> float:
    return round(1000.0 * length, 4)


def measured(
    row: Row, films: Sequence[tuple[Recipe, Film]], *, every: int = EVERY, told: Told | None = None
) -> Measured:
    """A row over sequences: all frames are followed, every so manyth is measured.

    told(share, words): hears how far it is. Raises SimCoreError where there is no frame.
    """
    found: dict[str, list[FrameErrors]] = {}
    spent: list[float] = []
    for number, (recipe, film) in enumerate(films):
        pair, errors = Pair.of(recipe), found.setdefault(recipe.name, [])
        for k, (fine, seconds) in enumerate(followed(row, recipe, film.coarse)):
            spent.append(seconds)
            if k % every == every - 1 or len(film.fine) < every:
                errors.append(
                    frame_errors(fine, np.asarray(film.fine[k], float), pair.fine.faces, pair.fine.rest)
                )
            if told is not None and k % 50 == 0:
                told((number + k / len(film.fine)) / len(films), f"{row.name} {recipe.name}")
    whole = [error for errors in found.values() for error in errors]
    return Measured(
        summary(whole),
        {name: summary(errors) for name, errors in found.items()},
        1000.0 * float(np.median(spent)),
    )


def followed(row: Row, recipe: Recipe, coarse: np.ndarray) -> Iterator[tuple[np.ndarray, float]]:
    """Each frame of coarse (T, C, 3) [m] as the row has it, (V, 3), and the seconds of processor time it took.

    Raises SimCoreError naming the frame that cannot be followed.
    """
    follow = row.follow(recipe)
    for number, frame in enumerate(coarse, 1):
        place = np.asarray(frame, float)
        begun = time.process_time()
        try:
            fine = follow(place)
        except SimCoreError as error:
            raise SimCoreError(f"frame {number}: {error}") from None
        yield fine, time.process_time() - begun


def reference(recipes: Sequence[Recipe], frames: int, told: Told | None = None) -> Measured:
    """The first row: how far fine films are from themselves with half the step, over the first so many frames of each,
    and what the fine film costs. An error that another row claims has to be three times that."""
    found, spent = {}, []
    for number, recipe in enumerate(recipes):
        if told is not None:
            told(number / len(recipes), f"reference {recipe.name}")
        worth = floor(recipe, frames)
        found[recipe.name] = worth.halved
        spent.append(worth.fine_ms)
    mean, p95 = (_over([getattr(one, part) for one in found.values()]) for part in ("mean", "p95"))
    whole = ErrorSummary(mean, p95, sum(one.frames for one in found.values()))
    return Measured(whole, found, float(np.median(spent)))


def _over(errors: Sequence[FrameErrors]) -> FrameErrors:
    return FrameErrors(
        *(float(np.mean([getattr(one, f.name) for one in errors])) for f in fields(FrameErrors))
    )
