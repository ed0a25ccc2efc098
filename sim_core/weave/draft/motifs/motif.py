"""Motifs: areas that repeat in the plane, in metres, and what a loom of some sett makes of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.draft.draft import check_size

__all__ = ["Motif", "cut"]

MOST_COLOURS = 16


@dataclass(frozen=True)
class Motif:
    """One repeat of a figure. size: along the weft and along the warp [m]; areas: what is drawn in this order, a number
    from 0 (the ground) and a polygon or several (shapely, in metres, x along the weft, y along the warp), of which what
    leaves the repeat comes in at the other side.

    Raises WeaveError for a size that is none, a number out of range, and where nothing is drawn.
    """

    name: str
    size: tuple[float, float]
    areas: tuple[tuple[int, Any], ...]

    def __post_init__(self) -> None:
        if not all(1e-4 <= side <= 4.0 for side in self.size):
            raise WeaveError(f"motif {self.name}: a repeat of {self.size} m – give .0001 to 4 m each way")
        if not any(not area.is_empty for _, area in self.areas):
            raise WeaveError(f"motif {self.name}: nothing is drawn – give one area at least")
        if not all(0 <= number < MOST_COLOURS for number, _ in self.areas):
            raise WeaveError(f"motif {self.name}: numbers are 0 to {MOST_COLOURS - 1}")

    @property
    def colours(self) -> int:
        """How many numbers there are, the ground's among them."""
        return 1 + max(number for number, _ in self.areas)


def cut(
    motif: Motif,
    ends_per_m: float,
    picks_per_m: float,
    *,
    multiple: tuple[int, int] = (1, 1),
) -> np.ndarray:
    """The motif at a sett: (picks, ends) int8, the number at the middle of every crossing, the first pick lowest.

    multiple: of how many picks and ends the repeat has to be, so that the weaves bound into it close; the sett gives
    way by half of that at most. Raises WeaveError where the draft would be larger than any.
    """
    counts = [
        max(1, round(side * sett / times)) * times
        for side, sett, times in zip(motif.size, (ends_per_m, picks_per_m), multiple[::-1], strict=True)
    ]
    ends, picks = counts
    check_size(motif.name, picks, ends)
    scale = np.array([ends / motif.size[0], picks / motif.size[1]])
    found = np.zeros((picks, ends), np.int8)
    for number, area in motif.areas:
        _painted(found, list(_rings(area, scale)), number)
    return found


def _painted(found: np.ndarray, rings: list[np.ndarray], number: int) -> None:
    """Writes a number into the crossings whose middles the rings cover, in place, round the repeat's borders."""
    if not rings:
        return
    picks, ends = found.shape
    every = np.concatenate(rings)
    (left, low), (right, high) = np.floor(every.min(0)).astype(int), np.ceil(every.max(0)).astype(int)
    if (
        right - left <= ends and high - low <= picks
    ):  # then it meets itself nowhere, and only its own box is looked at
        inside = _covered([ring - (left, low) for ring in rings], high - low, right - left)
        for rows, own_rows in _round(low, high, picks):
            for columns, own_columns in _round(left, right, ends):
                found[rows, columns][inside[own_rows, own_columns]] = number
    else:
        found[_covered(rings, picks, ends)] = number


def _round(begin: int, end: int, count: int) -> list[tuple[slice, slice]]:
    """A stretch that may leave the repeat, as one or two pieces: where they lie in it, and where in the stretch."""
    here = begin % count
    first = min(end - begin, count - here)
    pieces = [(slice(here, here + first), slice(0, first))]
    if first < end - begin:
        pieces.append((slice(0, end - begin - first), slice(first, end - begin)))
    return pieces


def _rings(area: Any, scale: np.ndarray) -> Iterable[np.ndarray]:
    """All rings of an area (N, 2), closed, in crossings: outlines anticlockwise, holes clockwise."""
    for polygon in getattr(area, "geoms", [area]):
        if polygon.geom_type != "Polygon":
            continue
        for hole, ring in enumerate((polygon.exterior, *polygon.interiors)):
            corners = np.asarray(ring.coords, float)[:, :2] * scale
            x, y = corners.T
            turned = (x[:-1] * y[1:] - x[1:] * y[:-1]).sum() < 0.0
            yield corners[::-1] if turned == (hole == 0) else corners


def _covered(rings: Iterable[np.ndarray], picks: int, ends: int) -> np.ndarray:
    """Which crossings (picks, ends) have their middle within the rings, by how often a pick has entered them.

    The plane is rolled up: what of a ring lies beyond the repeat counts on its other side, upon what lies there.
    """
    entered, begin = np.zeros((picks, ends), np.int16), np.zeros(picks, np.int16)
    for ring in rings:
        rows, places, enters = _crossed(ring[:-1], ring[1:])
        first = np.ceil(places - 0.5).astype(np.int64)  # the first crossing whose middle lies beyond
        np.add.at(entered, (rows % picks, first % ends), enters)
        np.add.at(begin, rows % picks, (-enters * (first // ends)).astype(np.int16))
    return np.cumsum(entered, axis=1, dtype=np.int16) + begin[:, None] > 0


def _crossed(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where edges from a to b (N, 2) cross the middles of picks: rows (M,), places along them, and whether a pick that
    goes to the right enters there (1) or leaves (-1)."""
    low, high = np.minimum(a[:, 1], b[:, 1]), np.maximum(a[:, 1], b[:, 1])
    begin, end = np.ceil(low - 0.5).astype(np.int64), np.ceil(high - 0.5).astype(np.int64)
    many = end - begin
    which = np.repeat(np.arange(len(a)), many)
    rows = np.arange(len(which)) - np.repeat(np.cumsum(many) - many, many) + begin[which]
    along = (rows + 0.5 - a[which, 1]) / (b[which, 1] - a[which, 1])
    enters = np.where(b[which, 1] < a[which, 1], 1, -1).astype(np.int16)
    return rows, a[which, 0] + along * (b[which, 0] - a[which, 0]), enters
