"""Layouts: several motifs within one repeat, each in its rectangle, as a loom piece woven to measure has its bands.

A skirt with its woven bands (裙襕), a rank badge on a coat's front and the border of a scarf are one repeat as long as
the panel that is cut from it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.draft.motifs.motif import Motif

__all__ = ["Part", "laid_out"]

Box = tuple[float, float, float, float]
MOST_COPIES = 20_000  # areas of one part


@dataclass(frozen=True)
class Part:
    """What lies within a rectangle of a layout; all lengths in millimetres.

    within: left, low, right, high, from the repeat's lower left corner; program, parameters: of the motif that fills it
    (see `motif_of_program`), "" for one number all over; at: where a corner of the motif's own repeat lies (None: in
    the rectangle's lower left one); numbers: what the motif's numbers become, its ground first (empty: as they are, and
    what lies below is seen in the ground); turned: whether the motif is turned to the left by a right angle, so that
    what runs along the warp runs along the weft; areas: of a drawing, see `Recipe`.
    """

    within: Box
    program: str = ""
    parameters: tuple[tuple[str, float], ...] = ()
    at: tuple[float, float] | None = None
    numbers: tuple[int, ...] = ()
    turned: bool = False
    areas: tuple[tuple[int, str], ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "within", tuple(float(side) for side in self.within))
        object.__setattr__(self, "parameters", tuple((str(k), float(v)) for k, v in self.parameters))
        object.__setattr__(self, "at", None if self.at is None else (float(self.at[0]), float(self.at[1])))
        object.__setattr__(self, "numbers", tuple(int(number) for number in self.numbers))
        object.__setattr__(self, "areas", tuple((int(number), str(text)) for number, text in self.areas))


def laid_out(name: str, size: tuple[float, float], parts: Sequence[tuple[Part, Motif | None]]) -> Motif:
    """One repeat of `size` [mm] with the parts in it, later ones over earlier ones; each with the motif it names.

    A motif whose rectangle reaches from border to border is stretched until whole repeats fill it, so that the cloth
    goes on without a break. Raises WeaveError for a rectangle outside the repeat and numbers that are missing.
    """
    import shapely

    areas: list[tuple[int, Any]] = []  # in millimetres
    for count, (part, motif) in enumerate(parts, 1):
        try:
            areas += _drawn(part, motif, size)
        except WeaveError as error:
            raise WeaveError(f"part.{count}.{error}") from error
    metres = [(number, shapely.transform(area, lambda points: 1e-3 * points)) for number, area in areas]
    return Motif(name, (1e-3 * size[0], 1e-3 * size[1]), tuple(metres))


def _drawn(part: Part, motif: Motif | None, size: tuple[float, float]) -> list[tuple[int, Any]]:
    from shapely import box

    left, low, right, high = part.within
    if not (0 <= left < right <= size[0] and 0 <= low < high <= size[1]):
        raise WeaveError(
            f"within: {list(part.within)} – left, low, right, high within the repeat of {size[0]:g} x {size[1]:g} mm"
        )
    frame = box(*part.within)
    if motif is None:
        if len(part.numbers) != 1:
            raise WeaveError("fill: one number, of the weave that lies there")
        return [(part.numbers[0], frame)]
    if part.numbers and len(part.numbers) < motif.colours:
        raise WeaveError(
            f"numbers: {len(part.numbers)} for a motif of {motif.colours} – give one for each, its ground's first"
        )
    found = [(part.numbers[0], frame)] if part.numbers else []
    for number, area in _repeated(part, motif, size):
        cut = area if frame.contains(area) else area.intersection(frame)
        if not cut.is_empty:
            found.append((part.numbers[number] if part.numbers else number, cut))
    return found


def _repeated(part: Part, motif: Motif, size: tuple[float, float]) -> Iterator[tuple[int, Any]]:
    """The motif's areas [mm] wherever a repeat of it touches the part's rectangle."""
    import shapely

    low, high = np.reshape(part.within, (2, 2))
    own, reach = 1e3 * np.array(motif.size[::-1] if part.turned else motif.size), high - low
    # What reaches from border to border has to close there.
    closed = reach / np.maximum(1, np.round(reach / own)) / own
    stretch = np.where(reach == size, closed, 1.0)
    step, at = own * stretch, np.array(part.at or low)
    # An area may stand out of its repeat by as much again.
    first, last = np.floor((low - at) / step) - 1, np.ceil((high - at) / step) + 1
    count = float(np.prod(last - first + 1))
    if count * len(motif.areas) > MOST_COPIES:
        raise WeaveError(f"motif: {count:,.0f} repeats of it – make it larger, or a weave of its own")
    columns, rows = np.meshgrid(*(np.arange(a, b + 1) for a, b in zip(first, last, strict=True)))
    places = at + step * np.column_stack([columns.ravel(), rows.ravel()])
    for number, area in motif.areas:
        if part.turned:
            area = shapely.transform(area, lambda points: points[:, ::-1] * (-1.0, 1.0))
        box = 1e3 * stretch * np.reshape(shapely.bounds(area), (2, 2))
        near = ((places + box[0] < high) & (places + box[1] > low)).all(axis=1)
        for place in places[near]:
            yield number, shapely.transform(area, lambda points, place=place: 1e3 * stretch * points + place)
