"""Rows measured: their errors on sequences that nobody has learned from, and what a frame costs."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from sim_core.errors import SimCoreError
from sim_core.learn.data import GATE, Pair, Take, floor, looked_at
from sim_core.learn.evaluation import ErrorSummary, FrameErrors, frame_errors, summary, two_sided
from sim_core.learn.rows.row import Row
from sim_core.learn.upsampling import linear, weighted_sums

__all__ = ["Measured", "Told", "coarse_measured", "counting", "followed", "measured", "reference"]

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


def measured(row: Row, takes: Sequence[Take], *, told: Told | None = None) -> Measured:
    """A row over sequences: all frames are followed, those of `looked_at` are measured; of pooled sheets a vertex's own
    distance is the mean over those that were taken out.

    told(share, words): hears how far it is. Raises SimCoreError where there is no frame.
    """
    found: dict[str, list[FrameErrors]] = {}
    spent: list[float] = []
    for number, take in enumerate(takes):
        sheet, truth, errors = take.pair.fine, take.film.fine, found.setdefault(take.name, [])
        out, wanted = np.setdiff1d(np.arange(len(sheet.rest)), take.pair.kept), looked_at(len(truth))
        for k, (fine, seconds) in enumerate(followed(row, take.pair, take.film.coarse)):
            spent.append(seconds)
            if k in wanted:
                errors.append(frame_errors(fine, truth[k].astype(float), sheet.faces, sheet.rest, over=out))
            if told is not None and k % 50 == 0:
                told((number + k / len(truth)) / len(takes), f"{row.name} {take.name}")
    whole = [error for errors in found.values() for error in errors]
    frames = {name: tuple(errors) for name, errors in found.items()}
    return Measured(summary(whole), frames, 1000.0 * float(np.median(spent)))


def coarse_measured(takes: Sequence[Take]) -> Measured:
    """The coarse sheet itself: vertices, normals and strain against the places of the fine sheet where its own lie at
    rest, surfaces against each other; it costs nothing more."""
    found: dict[str, tuple[FrameErrors, ...]] = {}
    for take in takes:
        coarse, fine, film = take.pair.coarse, take.pair.fine, take.film
        places = linear(fine.rest, fine.faces, coarse.rest)
        found[take.name] = tuple(
            _coarse_errors(take, places, film.coarse[k].astype(float), film.fine[k].astype(float))
            for k in looked_at(len(film.fine))
        )
    return Measured(summary([one for errors in found.values() for one in errors]), found, 0.0)


def _coarse_errors(take: Take, places: csr_array, now: np.ndarray, fine: np.ndarray) -> FrameErrors:
    coarse = take.pair.coarse
    apart = two_sided(now, coarse.faces, fine, take.pair.fine.faces)
    own = frame_errors(now, weighted_sums(places, fine), coarse.faces, coarse.rest)
    return replace(own, hausdorff=float(apart.max()), surface=float(apart.mean()))


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


def reference(takes: Sequence[Take], frames: int, told: Told | None = None) -> tuple[Measured, float]:
    """The first row: how far fine films are from what half the step makes, over the first so many frames of each, and
    what a frame of the fine film costs; and what one of the coarse sheet does [ms]. All are simulated here and now. An
    error that another row claims has to be three times that."""
    found = []
    for number, take in enumerate(takes):
        if told is not None:
            told(number / len(takes), f"reference {take.name}")
        found.append(floor(take.recipe, min(frames, len(take.film.fine))))
    each = {take.name: one.frames for take, one in zip(takes, found, strict=True)}
    coarse, fine = (
        float(np.median([getattr(one, name) for one in found])) for name in ("coarse_ms", "fine_ms")
    )
    return Measured(summary([error for errors in each.values() for error in errors]), each, fine), coarse


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
