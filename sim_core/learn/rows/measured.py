"""Rows measured: their errors on sequences that nobody has learned from, and what a frame costs."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.learn.data import GATE, Pair, Take, halved
from sim_core.learn.evaluation import ErrorSummary, FrameErrors, frame_errors, summary
from sim_core.learn.rows.row import Row

__all__ = ["EVERY", "Measured", "Told", "counting", "followed", "measured", "reference"]

EVERY = 5  # frames from one that is measured to the next
Told = Callable[[float, str], None]


@dataclass(frozen=True)
class Measured:
    """A row: its errors over all measured frames of all sequences, those of each sequence frame by frame, and ms of
    processor time a frame."""

    errors: ErrorSummary
    frames: Mapping[str, tuple[FrameErrors, ...]]
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


def measured(row: Row, takes: Sequence[Take], *, every: int = EVERY, told: Told | None = None) -> Measured:
    """A row over sequences: all frames are followed, every so manyth is measured; of pooled sheets a vertex's own
    distance is the mean over those that were taken out.

    told(share, words): hears how far it is. Raises SimCoreError where there is no frame.
    """
    found: dict[str, list[FrameErrors]] = {}
    spent: list[float] = []
    for number, take in enumerate(takes):
        sheet, truth, errors = take.pair.fine, take.film.fine, found.setdefault(take.name, [])
        out = np.setdiff1d(np.arange(len(sheet.rest)), take.pair.kept)
        for k, (fine, seconds) in enumerate(followed(row, take.pair, take.film.coarse)):
            spent.append(seconds)
            if k % every == every - 1 or len(truth) < every:
                wanted = np.asarray(truth[k], float)
                errors.append(frame_errors(fine, wanted, sheet.faces, sheet.rest, over=out))
            if told is not None and k % 50 == 0:
                told((number + k / len(truth)) / len(takes), f"{row.name} {take.name}")
    whole = [error for errors in found.values() for error in errors]
    frames = {name: tuple(errors) for name, errors in found.items()}
    return Measured(summary(whole), frames, 1000.0 * float(np.median(spent)))


def followed(row: Row, pair: Pair, coarse: np.ndarray) -> Iterator[tuple[np.ndarray, float]]:
    """Each frame of coarse (T, C, 3) [m] as the row has it, (V, 3), and the seconds of processor time it took.

    Raises SimCoreError naming the frame that cannot be followed.
    """
    follow = row.follow(pair)
    for number, frame in enumerate(coarse, 1):
        place = np.asarray(frame, float)
        begun = time.process_time()
        try:
            fine = follow(place)
        except SimCoreError as error:
            raise SimCoreError(f"frame {number}: {error}") from None
        yield fine, time.process_time() - begun


def reference(takes: Sequence[Take], frames: int, told: Told | None = None) -> Measured:
    """The first row: how far fine films are from what half the step makes, over the first so many frames of each, and
    what a frame of the fine film costs. An error that another row claims has to be three times that."""
    found: dict[str, tuple[FrameErrors, ...]] = {}
    for number, take in enumerate(takes):
        if told is not None:
            told(number / len(takes), f"reference {take.name}")
        found[take.name] = halved(take, frames)
    spent = float(np.median([take.film.fine_ms for take in takes]))
    return Measured(summary([error for errors in found.values() for error in errors]), found, spent)


def counting(floor: Measured, rows: Sequence[Measured]) -> dict[str, tuple[int, int]]:
    """Of each sequence, how many of the frames whose floor was measured count, and how many those are.

    A frame counts where its floor is no more than a third of every error that the rows have there, of vertices and by
    Hausdorff distance.
    """
    found = {}
    for name, floors in floor.frames.items():
        own = zip(floors, *(row.frames[name][: len(floors)] for row in rows), strict=True)
        count = sum(
            all(
                base.vertex <= GATE * error.vertex and base.hausdorff <= GATE * error.hausdorff
                for error in errors
            )
            for base, *errors in own
        )
        found[name] = (count, len(floors))
    return found
