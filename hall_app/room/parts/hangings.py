"""What hangs: tied curtains in the openings of an arcade, and paper lanterns."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hall_app.room.parts.timber import BAND
from hall_app.room.patch import Frame, Patch, disc, quad, strip, tube
from hall_app.room.structure.frame import beams_of
from hall_app.room.structure.regions import Regions

if TYPE_CHECKING:
    from hall_app.content.schema import Curtain, Lantern, PlanFile

__all__ = ["TIE", "hangings_of"]

Floats = NDArray[np.float64]
TIE = 2.06  # [m] height of the ties: what hangs wide is above everybody's head
_HEM = 0.62
_BUNDLE, _GATHERED = 0.262, 0.062  # [m] where the tied bundle hangs beside the column's middle, its radius
_PLEATS = 11  # of one half
_DEPTH = 0.045  # [m] of the pleats
_RADIUS, _HEIGHT = 0.24, 0.46  # [m] of a lantern


def hangings_of(plan: PlanFile, regions: Regions) -> list[Patch]:
    """Curtains and lanterns of the plan."""
    patches: list[Patch] = []
    for curtain in plan.curtain:
        patches += _curtain(curtain, plan, regions)
    for lantern in plan.lantern:
        patches += _lantern(lantern, plan, regions)
    return patches


def _curtain(curtain: Curtain, plan: PlanFile, regions: Regions) -> list[Patch]:
    a, b = np.asarray(curtain.start, float), np.asarray(curtain.end, float)
    length = float(np.linalg.norm(b - a))
    top = _underside((a + b) / 2, plan, regions)
    patches = _valance(a, b, top)
    along = (b - a) / length
    for start, way in ((a, along), (b, -along)):
        facing = float(np.degrees(np.arctan2(-way[1], way[0])))
        patches += _half(Frame.on_floor(start, facing), length / 2, top)
    return patches


def _underside(at: Floats, plan: PlanFile, regions: Regions) -> float:
    """Height [m] of what a curtain at `at` hangs from: the beam's band, else the ceiling."""
    import shapely

    spot = shapely.Point(at)
    for beam in beams_of(plan, regions):
        if shapely.LineString([beam.start, beam.end]).distance(spot) < 0.2:
            return beam.low - (BAND[1] if beam.arcade else 0.0)
    return regions.height_at(float(at[0]), float(at[1])) or plan.height


def _half(frame: Frame, reach: float, top: float) -> list[Patch]:
    """One half, from the column at the frame's origin to `reach` [m] along local x, tied to the column."""
    columns = 2 * _PLEATS + 1
    lines = [frame(_row(columns, y, reach, top)) for y in _levels(top)]
    grid = np.array(lines)  # (levels, columns, 3), from the hem upwards
    patches = [
        strip(grid[:, k + 1], grid[:, k], "curtain", two_sided=True, density=5.0) for k in range(columns - 1)
    ]
    tie = frame.moved(x=_BUNDLE, y=TIE - 0.06)
    ring = [(0.086, 0.0), (0.080, 0.02), (0.080, 0.09), (0.086, 0.11)]
    return patches + tube(tie, ring, "gold", sides=12)


def _levels(top: float) -> Floats:
    above = TIE + (top - TIE) * np.array([0.0, 0.07, 0.17, 0.33, 0.56, 0.8, 1.0])
    return np.concatenate([[_HEM, TIE - 0.55, TIE - 0.16], above])


def _row(columns: int, y: float, reach: float, top: float) -> Floats:
    """(columns, 3) local points of the cloth at height `y`: a gathered bundle below the tie, a pleated sheet above."""
    share = np.linspace(0, 1, columns)
    pleat = np.where(np.arange(columns) % 2 == 0, 0.5, -0.5)
    wide = 1.0 + 0.28 * min(max(TIE - y, 0.0) / 0.6, 1.0) ** 0.7
    round_ = (_GATHERED + 0.034 * pleat) * wide
    angle = np.pi * (1 - 2 * share)
    bundle = np.column_stack([_BUNDLE + round_ * np.cos(angle), np.full(columns, y), round_ * np.sin(angle)])
    if y <= TIE:
        return bundle
    rise = (y - TIE) / (top - TIE)
    # The inner edge falls steeply first and sweeps to the tie at last; the outer edge hangs straight.
    bow = rise ** (0.30 + 0.28 * share)
    tied, edge = _BUNDLE + 0.06 * (2 * share - 1), 0.17 + share * (reach - 0.17)
    depth = _DEPTH + 0.05 * (1 - rise) ** 2
    sheet = np.column_stack([tied + (edge - tied) * bow, np.full(columns, y), pleat * depth])
    spread = min(rise / 0.25, 1.0)
    return bundle + (sheet - bundle) * spread


def _valance(a: Floats, b: Floats, top: float) -> list[Patch]:
    """A short pleated strip across the head of the opening, a line of gold along its foot."""
    length = float(np.linalg.norm(b - a))
    along = (b - a) / length
    frame = Frame.on_floor(a, float(np.degrees(np.arctan2(-along[1], along[0]))))
    count = 2 * max(4, round(length / 0.22)) + 1
    x = np.linspace(0.17, length - 0.17, count)
    z = np.where(np.arange(count) % 2 == 0, 0.5, -0.5) * 0.05
    patches = []
    for side in (1, -1):
        off = z + side * 0.055
        rows = [frame(np.column_stack([x, np.full(count, y), off])) for y in (top - 0.34, top - 0.31, top)]
        if side < 0:
            rows = [row[::-1] for row in rows]
        for (low, high), material in zip(zip(rows, rows[1:], strict=False), ("gold", "curtain"), strict=True):
            patches.append(strip(low, high, material, density=5.0))
    return patches


def _lantern(lantern: Lantern, plan: PlanFile, regions: Regions) -> list[Patch]:
    """A ribbed body of paper between two rings, a cord to what is above, a tassel below."""
    frame = Frame.on_floor(lantern.at, 0.0, lantern.height)
    half, sides = _HEIGHT / 2, 16
    turn = np.linspace(-0.92, 0.92, 7)
    profile = [(_RADIUS * (0.42 + 0.58 * np.cos(t * 1.35)), half * t / 0.92) for t in turn]
    patches = []
    for k, ((r0, y0), (r1, y1)) in enumerate(zip(profile, profile[1:], strict=False)):
        angle = 2 * np.pi * np.arange(sides + 1) / sides
        ring = np.column_stack([np.sin(angle), np.zeros(sides + 1), np.cos(angle)])
        patch = strip(
            frame(ring * [r0, 1, r0] + [0, y0, 0]), frame(ring * [r1, 1, r1] + [0, y1, 0]), "lantern"
        )
        u = np.tile(np.arange(sides + 1) / 2, 2)
        v = np.repeat([1 - k / 6, 1 - (k + 1) / 6], sides + 1) * 0.96 + 0.02
        patches.append(Patch(**{**_fields(patch), "uv": np.column_stack([u, v])}))
    cap = profile[0][0] + 0.012
    for y, way in ((-half - 0.045, -1), (half, 1)):
        ring = frame.moved(y=y)
        patches += tube(ring, [(cap, 0), (cap, 0.045)], "lacquer", sides=sides, density=5.0)
        patches += disc(ring.moved(y=0.045 if way > 0 else 0.0), cap, "lacquer", sides=sides, up=way > 0)
    patches += _tassel(frame.moved(y=-half - 0.045))
    return patches + _cord(frame, half + 0.045, _above(lantern, plan, regions) - lantern.height)


def _fields(patch: Patch) -> dict:
    return {name: getattr(patch, name) for name in Patch.__slots__}


def _tassel(frame: Frame) -> list[Patch]:
    patches = tube(frame, [(0.006, -0.10), (0.006, 0.0)], "gold", sides=5, density=2.0)
    patches += tube(frame, [(0.022, -0.15), (0.026, -0.125), (0.010, -0.10)], "gold", sides=8, density=5.0)
    return patches + tube(
        frame, [(0.036, -0.42), (0.026, -0.30), (0.022, -0.15)], "band", sides=8, density=5.0
    )


def _cord(frame: Frame, low: float, high: float) -> list[Patch]:
    """Four-sided, thin."""
    patches = []
    for turn in (0, 90, 180, 270):
        side = frame.moved(turn=turn)
        corners = [(-0.007, low, 0.007), (0.007, low, 0.007), (0.007, high, 0.007), (-0.007, high, 0.007)]
        patches.append(quad(side(corners), "lacquer", density=2.0))
    return patches


def _above(lantern: Lantern, plan: PlanFile, regions: Regions) -> float:
    """Height [m] of what the lantern's cord is tied to."""
    import shapely

    spot = shapely.Point(lantern.at)
    for beam in beams_of(plan, regions):
        if shapely.LineString([beam.start, beam.end]).distance(spot) < beam.width / 2 - 0.01:
            return beam.low
    return regions.height_at(*lantern.at) or plan.height
