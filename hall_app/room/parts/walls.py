"""Plastered walls: wainscot, rails and openings on every face a visitor can see."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hall_app.room.parts.lattice import screen
from hall_app.room.parts.openings import door, window
from hall_app.room.patch import Frame, Patch, box, panel
from hall_app.room.structure.regions import Regions

if TYPE_CHECKING:
    from hall_app.content.schema import Opening, PlanFile, Wall

__all__ = ["DATUM", "WAINSCOT", "walls_of"]

Floats = NDArray[np.float64]
WAINSCOT, SKIRTING, RAIL = 0.90, 0.14, 0.06  # [m]
DATUM = 0.60  # [m] below the rooms' ceiling: one line for upper rails, red bands and lattice screens
CROWN = 0.16
_CLERESTORY = 0.08  # [m] the wall over an arcade stands this far out of its middle
_LOW = 1.3  # [m] a wall lower than this is bare


@dataclass(frozen=True)
class Face:
    """One side of a wall. frame: at its left end on the floor, z out of the wall; length [m]; top: the wall's own
    height; spans: (from, to, ceiling height) along it; holes: (opening, from, to); depth of its reveals [m]."""

    frame: Frame
    length: float
    top: float
    spans: tuple[tuple[float, float, float], ...]
    holes: tuple[tuple[Opening, float, float], ...]
    depth: float

    def region(self, low: float, high: float | None) -> Any:
        """The face between two heights as a shapely polygon without its openings; high None: up to the top."""
        import shapely

        rooms = [
            shapely.box(a, low, b, min(self.height(h), math.inf if high is None else high))
            for a, b, h in self.spans
            if self.height(h) > low
        ]
        cut = [shapely.box(a, hole.sill, b, hole.sill + hole.height) for hole, a, b in self.holes]
        return shapely.union_all(rooms).difference(shapely.union_all(cut))

    def height(self, ceiling: float) -> float:
        """How high the wall stands under a ceiling of that height."""
        return min(self.top, ceiling)


def walls_of(plan: PlanFile, regions: Regions) -> list[Patch]:
    """All walls of the plan, the outline where it has none, and what rises above a lower ceiling."""
    patches: list[Patch] = []
    for wall in plan.wall:
        if wall.kind == "lattice":
            patches += screen(wall.start, wall.end, min(wall.height, plan.height), wall.thickness)
            continue
        for face in _faces(wall, plan, regions):
            patches += _drawn(face, plan)
        patches += _ends(wall, plan, regions)
    for start, end in bare_outline(plan, regions):
        patches += _drawn(_face(start, end, math.inf, (), 0.1, regions), plan)
    for start, end, low, _ in regions.steps():
        patches += _clerestory(start, end, low, plan, regions)
    return patches


def _clerestory(start: Floats, end: Floats, low: float, plan: PlanFile, regions: Regions) -> list[Patch]:
    """The wall over an arcade, from the lower ceiling up, seen from the higher room; with the openings that lie in
    it, a rail at its foot and a plate at its head."""
    along = (end - start) / np.linalg.norm(end - start)
    out = _CLERESTORY * np.array([-along[1], along[0]])
    holes = [o for o in plan.opening if o.kind == "window" and o.sill > low and o.beside(start, end, 0.2)]
    face = _face(start + out, end + out, math.inf, holes, 0.16, regions)
    right, up, _ = face.frame.axes
    patches = panel(face.frame.at, right, up, face.region(low, None), "plaster")
    patches += _rail(face, low, low + 0.10, 0.09, "lacquer")
    return patches + _crown(face) + _filled(face)


def _crown(face: Face) -> list[Patch]:
    patches = []
    for a, b, ceiling in face.spans:
        low, high = (a, ceiling - CROWN, 0), (b, ceiling, 0.06)
        patches += box(face.frame, low, high, "lacquer", skip="back top left right")
    return patches


def _filled(face: Face) -> list[Patch]:
    """What stands in the face's openings."""
    patches = []
    for hole, a, b in face.holes:
        draw = door if hole.kind == "door" else window
        patches += draw(face.frame.moved(x=(a + b) / 2, y=hole.sill), b - a, hole.height, face.depth)
    return patches


def _faces(wall: Wall, plan: PlanFile, regions: Regions) -> list[Face]:
    a, b = np.asarray(wall.start, float), np.asarray(wall.end, float)
    along = (b - a) / np.linalg.norm(b - a)
    out = np.array([-along[1], along[0]]) * wall.thickness / 2
    top = math.inf if plan.to_ceiling(wall) else wall.height
    holes = plan.openings_in(wall)
    depth = min(0.16, 0.45 * wall.thickness) if regions.along(a, b) else 0.16
    pairs = ((a + out, b + out), (b - out, a - out))
    faces = [_face(start, end, top, holes, depth, regions) for start, end in pairs]
    return [face for face in faces if face.spans]


def _face(
    start: Floats, end: Floats, top: float, holes: Sequence[Opening], depth: float, regions: Regions
) -> Face:
    """The face from `start` to `end` [x, z], to the right as it is seen."""
    along = end - start
    length = float(np.linalg.norm(along))
    along = along / length
    out = np.array([-along[1], along[0]])
    spans = regions.along(start + 1e-3 * out, end + 1e-3 * out)
    placed = []
    for hole in holes:
        ends = sorted(float((np.asarray(p) - start) @ along) for p in (hole.start, hole.end))
        placed.append((hole, max(ends[0], 0.0), min(ends[1], length)))
    facing = float(np.degrees(np.arctan2(out[0], out[1])))
    frame = Frame(np.array([start[0], 0.0, start[1]]), facing)
    return Face(frame, length, top, tuple(spans), tuple(placed), depth)


def _drawn(face: Face, plan: PlanFile) -> list[Patch]:
    right, up, front = face.frame.axes
    tallest = max(face.height(h) for _, _, h in face.spans)
    foot = WAINSCOT if tallest > _LOW else 0.0
    patches = panel(face.frame.at, right, up, face.region(foot, None), "plaster")
    if foot:
        boards = face.region(SKIRTING, WAINSCOT)
        patches += panel(face.frame.at + 0.015 * front, right, up, boards, "panel", grain=1)
        patches += _rail(face, 0.0, SKIRTING, 0.03, "lacquer")
        patches += _rail(face, WAINSCOT, WAINSCOT + RAIL, 0.035, "lacquer")
    if tallest > plan.height - 0.05:
        datum = plan.height - DATUM
        patches += _rail(face, datum, datum + 0.08, 0.03, "lacquer")
        patches += _crown(face)
    return patches + _filled(face)


def _rail(face: Face, low: float, high: float, proud: float, material: str) -> list[Patch]:
    """A bar along the face wherever no opening is in its way."""
    import shapely

    patches = []
    for piece in shapely.get_parts(face.region(low, high)):
        x0, y0, x1, y1 = piece.bounds
        if x1 - x0 > 0.02 and y1 - y0 > 0.5 * (high - low):
            patches += box(face.frame, (x0, low, 0), (x1, high, proud), material, skip="back left right")
    return patches


def _ends(wall: Wall, plan: PlanFile, regions: Regions) -> list[Patch]:
    """Posts at the free ends of a wall, and a coping where it does not reach the ceiling."""
    import shapely

    a, b = np.asarray(wall.start, float), np.asarray(wall.end, float)
    length = float(np.linalg.norm(b - a))
    along = (b - a) / length
    facing = float(np.degrees(np.arctan2(-along[1], along[0])))
    half = wall.thickness / 2 + 0.03
    others = shapely.union_all(
        [shapely.LineString([w.start, w.end]).buffer(w.thickness / 2) for w in plan.wall if w is not wall]
    )
    patches = []
    for at, way in ((a, -along), (b, along)):
        spot = at + 0.05 * way
        ceiling = regions.height_at(*spot)
        if ceiling is not None and not others.intersects(shapely.Point(spot)):
            frame = Frame.on_floor(at, facing)
            top = ceiling if plan.to_ceiling(wall) else wall.height
            patches += box(frame, (-0.06, 0, -half), (0.03, top, half), "lacquer", skip="bottom top")
    if not plan.to_ceiling(wall) and regions.along(a, b):
        frame = Frame.on_floor((a + b) / 2, facing)
        patches += box(
            frame,
            (-length / 2 - 0.03, wall.height, -half),
            (length / 2 + 0.03, wall.height + 0.07, half),
            "lacquer",
        )
    return patches


def bare_outline(plan: PlanFile, regions: Regions) -> list[tuple[Floats, Floats]]:
    """Stretches of the outline without a wall, as (start, end) seen from the floor."""
    import shapely

    built = shapely.union_all(
        [
            shapely.LineString([w.start, w.end]).buffer(w.thickness / 2 + 0.06)
            for w in plan.wall
            if w.kind == "wall"
        ]
    )
    ring = np.asarray(regions.floor.exterior.coords)
    found = []
    for a, b in zip(ring, ring[1:], strict=False):
        for piece in shapely.get_parts(shapely.LineString([a, b]).difference(built)):
            if piece.length > 0.05:
                ends = np.asarray(piece.coords)
                found.append((ends[0], ends[-1]))
    return found
