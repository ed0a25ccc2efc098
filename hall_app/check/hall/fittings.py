"""Openings, lanterns, paper ceilings, curtains and signs: what the room would draw beside its walls, or not at all."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hall_app.content.folder import Content
from hall_app.content.problems import Problem
from hall_app.content.schema.plan import Curtain, Opening, PlanFile, Sign, Wall
from hall_app.content.schema.values import Point
from hall_app.room.structure.regions import Regions

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

Floats = NDArray[np.float64]
Fault = tuple[str, str, str]  # key, what is wrong, remedy
BESIDE = 0.05  # [m] an opening may lie beside its wall's faces, as the room's geometry has it
ARCADE = 0.2  # [m] the same of a high window, from the line where two ceilings meet
HUNG = 0.10  # [m] a sign may hang before its wall
COLUMN = 0.25  # [m] a curtain's end may be beside a column


def fitting_problems(content: Content) -> list[Problem]:
    """What the plan fits into the hall where no wall, column or ceiling holds it. One line each."""
    plan = content.plan
    regions = Regions(plan)
    faults = [
        *_openings(plan, regions),
        *_above(plan, regions),
        *_curtains(plan, regions),
        *_signs(plan, regions),
    ]
    return [Problem("plan.toml", *fault) for fault in faults]


def _openings(plan: PlanFile, regions: Regions) -> Iterator[Fault]:
    lines = [
        (_ends(wall), _height(wall, plan, regions), wall.thickness / 2 + BESIDE, 0.0)
        for wall in _plastered(plan)
    ]
    # A wall over an arcade stands between a lower and a higher ceiling; it holds windows alone.
    steps = [(np.array([start, end]), high, ARCADE, low) for start, end, low, high in regions.steps()]
    for number, opening in enumerate(plan.opening, 1):
        own = [*lines, *(step for step in steps if opening.kind == "window" and opening.sill > step[3])]
        if fault := _unheld(opening, own):
            yield f"opening[{number}]", *fault


def _unheld(opening: Opening, lines: list[tuple[Floats, float, float, float]]) -> tuple[str, str] | None:
    """What keeps an opening from standing in one of the `lines`: (ends, height, how far beside, foot)."""
    ends = np.array([opening.start, opening.end], float)
    beyond = None
    for line, height, beside, _ in lines:
        along, across = _measured(ends, line)
        length = float(np.linalg.norm(line[1] - line[0]))
        if np.abs(across).max() > beside or along.max() < 0 or along.min() > length:
            continue
        if along.min() < -beside or along.max() > length + beside:
            wide = float(np.ptp(along))
            beyond = f"the {opening.kind} of {wide:.2f} m reaches beyond its wall of {length:.2f} m"
            continue
        top = opening.sill + opening.height
        if top > height + 1e-6:
            what = f"the {opening.kind} reaches up to {top:.2f} m, its wall to {height:.2f} m"
            return what, "lower its sill or its height"
        return None
    if beyond:
        return beyond, "move from and to between the wall's ends"
    return (
        f"the {opening.kind} lies in no wall and would not be drawn",
        "move from and to onto a wall's middle line",
    )


def _measured(points: Floats, line: Floats) -> tuple[Floats, Floats]:
    """(N,) [m] of points (N, 2): how far along the line from its first end, how far beside it."""
    along = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    away = points - line[0]
    return away @ along, away @ np.array([-along[1], along[0]])


def _plastered(plan: PlanFile) -> list[Wall]:
    return [wall for wall in plan.wall if wall.kind == "wall"]


def _ends(wall: Wall) -> Floats:
    return np.array([wall.start, wall.end], float)


def _height(wall: Wall, plan: PlanFile, regions: Regions) -> float:
    """How high a wall is drawn [m]: one as high as the rooms goes up to the ceiling on either side."""
    if wall.height <= plan.height - 0.05:
        return wall.height
    ends = _ends(wall)
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    out = np.array([-along[1], along[0]]) * (wall.thickness / 2 + 1e-3)
    beside = [span[2] for way in (out, -out) for span in regions.along(ends[0] + way, ends[1] + way)]
    return max(beside, default=wall.height)


def _above(plan: PlanFile, regions: Regions) -> Iterator[Fault]:
    """Lanterns and paper ceilings."""
    import shapely

    for number, lantern in enumerate(plan.lantern, 1):
        ceiling = regions.height_at(*lantern.at)
        if ceiling is None:
            yield (
                f"lantern[{number}].at",
                f"the lantern hangs outside the hall ({_spot(lantern.at)})",
                _INSIDE,
            )
        elif lantern.height > ceiling:
            what = f"the lantern hangs at {lantern.height:g} m, above the ceiling of {ceiling:g} m"
            yield f"lantern[{number}].height", what, "hang it lower"
    for number, light in enumerate(plan.laylight, 1):
        (x, z), (wide, deep) = light.at, light.size
        shape = shapely.box(x - wide / 2, z - deep / 2, x + wide / 2, z + deep / 2)
        if not regions.floor.buffer(1e-6).covers(shape):
            what = f"the paper ceiling reaches outside the hall ({_spot(light.at)})"
            yield f"laylight[{number}]", what, "move it inside, or make it smaller"


def _curtains(plan: PlanFile, regions: Regions) -> Iterator[Fault]:
    import shapely

    from hall_app.content.floor.footprints import solid_footprint

    columns = [solid_footprint(solid).shape() for solid in plan.solid if solid.kind == "column"]
    held: Any = shapely.union_all([*columns, *_bodies(plan), regions.floor.boundary])
    for number, curtain in enumerate(plan.curtain, 1):
        for key, point in _curtain_ends(curtain):
            if held.distance(shapely.Point(point)) > COLUMN:
                what = f"the curtain's end is at no column and no wall ({_spot(point)})"
                yield f"curtain[{number}].{key}", what, "write the middle of a column"


def _curtain_ends(curtain: Curtain) -> tuple[tuple[str, Point], tuple[str, Point]]:
    return ("from", curtain.start), ("to", curtain.end)


def _bodies(plan: PlanFile) -> list[BaseGeometry]:
    import shapely

    return [shapely.LineString([w.start, w.end]).buffer(w.thickness / 2, cap_style="flat") for w in plan.wall]


def _signs(plan: PlanFile, regions: Regions) -> Iterator[Fault]:
    import shapely

    walls: Any = shapely.union_all([*_bodies(plan), regions.floor.boundary])
    for number, sign in enumerate(plan.sign, 1):
        edges = _edges(sign)
        far = max(walls.distance(shapely.Point(point)) for point in edges)
        ceiling = regions.height_at(*(np.mean(edges, 0) + 0.05 * _front(sign)))
        if ceiling is None:
            yield f"sign[{number}].at", f"the {sign.kind} hangs outside the hall ({_spot(sign.at)})", _INSIDE
        elif far > HUNG:
            what = f"the {sign.kind} hangs off its wall: an edge is {far:.2f} m from any"
            yield f"sign[{number}].at", what, "write a spot on the wall's face, and facing away from it"
        elif sign.height + sign.size[1] / 2 > ceiling:
            top = sign.height + sign.size[1] / 2
            what = f"the {sign.kind} reaches up to {top:.2f} m, the ceiling is at {ceiling:g} m"
            yield f"sign[{number}].height", what, "hang it lower, or make it smaller"


def _front(sign: Sign) -> Floats:
    angle = np.radians(sign.facing)
    return np.array([np.sin(angle), np.cos(angle)])


def _edges(sign: Sign) -> Floats:
    """(2, 2) [m]: where the left and right edge of a board stand, [x, z]."""
    x, z = _front(sign)
    half = sign.size[0] / 2 * np.array([z, -x])
    return np.array([np.asarray(sign.at) - half, np.asarray(sign.at) + half])


def _spot(point: Point) -> str:
    return f"x = {point[0]:g}, z = {point[1]:g}"


_INSIDE = "move it inside the outline"
