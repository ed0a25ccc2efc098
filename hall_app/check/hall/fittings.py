"""Openings, lanterns, paper ceilings, curtains and signs: what the room would draw beside its walls, or not at all."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from hall_app.check.hall.signs import sign_faults
from hall_app.check.hall.walls import INSIDE, Fault, Floats, body, ends, height, measured, spot
from hall_app.content.folder import Content
from hall_app.content.problems import Problem
from hall_app.content.schema.plan import BESIDE, Curtain, Opening, PlanFile, Wall
from hall_app.content.schema.values import Point
from hall_app.room.structure.regions import Regions

ARCADE = 0.2  # [m] the same of a high window, from the line where two ceilings meet
COLUMN = 0.25  # [m] a curtain's end may be beside a column


def fitting_problems(content: Content) -> list[Problem]:
    """What the plan fits into the hall where no wall, column or ceiling holds it. One line each."""
    plan = content.plan
    regions = Regions(plan)
    faults = [
        *_openings(plan, regions),
        *_above(plan, regions),
        *_curtains(plan, regions),
        *sign_faults(content, regions),
    ]
    return [Problem("plan.toml", *fault) for fault in faults]


def _openings(plan: PlanFile, regions: Regions) -> Iterator[Fault]:
    lines = [
        (ends(wall), height(wall, plan, regions), wall.thickness / 2 + BESIDE, 0.0)
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
    for line, high, beside, _ in lines:
        along, across = measured(ends, line)
        length = float(np.linalg.norm(line[1] - line[0]))
        if np.abs(across).max() > beside or along.max() < 0 or along.min() > length:
            continue
        if along.min() < -beside or along.max() > length + beside:
            wide = float(np.ptp(along))
            beyond = f"the {opening.kind} of {wide:.2f} m reaches beyond its wall of {length:.2f} m"
            continue
        top = opening.sill + opening.height
        if top > high + 1e-6:
            what = f"the {opening.kind} reaches up to {top:.2f} m, its wall to {high:.2f} m"
            return what, "lower its sill or its height"
        return None
    if beyond:
        return beyond, "move from and to between the wall's ends"
    return (
        f"the {opening.kind} lies in no wall and would not be drawn",
        "move from and to onto a wall's middle line",
    )


def _plastered(plan: PlanFile) -> list[Wall]:
    return [wall for wall in plan.wall if wall.kind == "wall"]


def _above(plan: PlanFile, regions: Regions) -> Iterator[Fault]:
    """Lanterns and paper ceilings."""
    import shapely

    for number, lantern in enumerate(plan.lantern, 1):
        ceiling = regions.height_at(*lantern.at)
        if ceiling is None:
            yield (
                f"lantern[{number}].at",
                f"the lantern hangs outside the hall ({spot(lantern.at)})",
                INSIDE,
            )
        elif lantern.height > ceiling:
            what = f"the lantern hangs at {lantern.height:g} m, above the ceiling of {ceiling:g} m"
            yield f"lantern[{number}].height", what, "hang it lower"
    for number, light in enumerate(plan.laylight, 1):
        (x, z), (wide, deep) = light.at, light.size
        shape = shapely.box(x - wide / 2, z - deep / 2, x + wide / 2, z + deep / 2)
        if not regions.floor.buffer(1e-6).covers(shape):
            what = f"the paper ceiling reaches outside the hall ({spot(light.at)})"
            yield f"laylight[{number}]", what, "move it inside, or make it smaller"


def _curtains(plan: PlanFile, regions: Regions) -> Iterator[Fault]:
    import shapely

    from hall_app.content.floor.footprints import solid_footprint

    columns = [solid_footprint(solid).shape() for solid in plan.solid if solid.kind == "column"]
    held: Any = shapely.union_all([*columns, *map(body, plan.wall), regions.floor.boundary])
    for number, curtain in enumerate(plan.curtain, 1):
        for key, point in _curtain_ends(curtain):
            if held.distance(shapely.Point(point)) > COLUMN:
                what = f"the curtain's end is at no column and no wall ({spot(point)})"
                yield f"curtain[{number}].{key}", what, "write the middle of a column"


def _curtain_ends(curtain: Curtain) -> tuple[tuple[str, Point], tuple[str, Point]]:
    return ("from", curtain.start), ("to", curtain.end)
