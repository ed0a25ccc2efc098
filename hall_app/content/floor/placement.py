"""Do plan, start and exhibits fit together on the floor? Exact polygon tests, no walking."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator

from hall_app.content.floor.footprints import Footprint, body_footprint, plan_footprints, solid_footprint
from hall_app.content.problems import Problem
from hall_app.content.schema.exhibit import ExhibitFile
from hall_app.content.schema.hall import HallFile
from hall_app.content.schema.plan import PlanFile
from hall_app.content.schema.values import Point

STANDING = ("booth", "dais", "stand")  # kinds an exhibit can stand on
FARTHEST = 200.0  # [m] from the hall's middle; the studio of close-ups stands at 500 m
TOUCHING = 1e-4  # [m2], overlap of footprints that only touch


def ring_fault(ring: Iterable[Point]) -> str | None:
    """What is wrong with an outline [[x, z], …], or None."""
    from shapely import Polygon
    from shapely.validation import explain_validity

    polygon = Polygon(tuple(ring))
    if not polygon.is_valid:
        reason, _, spot = explain_validity(polygon).partition("[")
        crossing = reason.startswith(("Self-intersection", "Ring Self-intersection"))
        what = "the outline crosses itself" if crossing else f"the outline is not simple ({reason.lower()})"
        x, _, z = spot.rstrip("]").partition(" ")
        return f"{what} at x = {float(x):.2f}, z = {float(z):.2f}" if spot else what
    return "the outline encloses no floor" if polygon.area < TOUCHING else None


def _points(plan: PlanFile) -> Iterator[tuple[str, Point]]:
    """(key, [x, z]) of every place the plan names."""
    for number, point in enumerate(plan.outline, 1):
        yield f"outline[{number}]", point
    for table in ("wall", "opening", "solid", "bay", "laylight", "lantern", "curtain", "sign"):
        for number, entry in enumerate(getattr(plan, table), 1):
            key = f"{table}[{number}]"
            for name, alias in (("start", "from"), ("end", "to"), ("at", "at")):
                if (point := getattr(entry, name, None)) is not None:
                    yield f"{key}.{alias}", point
            for index, point in enumerate(getattr(entry, "polygon", None) or (), 1):
                yield f"{key}.polygon[{index}]", point
            if (disc := getattr(entry, "round", None)) is not None:
                yield f"{key}.round", (disc.x, disc.z)


def _far_away(plan: PlanFile) -> list[Problem]:
    """Places no hall reaches; most often a drawing in millimetres, so the first is named and the rest counted."""
    far = [(key, max(point, key=abs)) for key, point in _points(plan) if max(map(abs, point)) > FARTHEST]
    if not far:
        return []
    key, worst = far[0]
    what = f"{worst:g} m is no place in a hall, which reaches {FARTHEST:g} m from its middle at most"
    others = f"; {len(far) - 1} more are as far" if len(far) > 1 else ""
    return [Problem("plan.toml", key, what + others, "write metres")]


def plan_problems(plan: PlanFile) -> list[Problem]:
    """Places beyond any hall, outlines that cross themselves, ids given twice, solids and walls off the floor."""
    if far := _far_away(plan):
        return far
    rings = [("outline", plan.outline)]
    rings += [(f"solid[{n}].polygon", s.polygon) for n, s in enumerate(plan.solid, 1) if s.polygon]
    rings += [(f"bay[{n}].polygon", bay.polygon) for n, bay in enumerate(plan.bay, 1)]
    fix = "list the corners in order round the floor, each once"
    found = [Problem("plan.toml", key, fault, fix) for key, ring in rings if (fault := ring_fault(ring))]
    for table, ids in (("solid", [s.id for s in plan.solid]), ("bay", [b.id for b in plan.bay])):
        for name, times in Counter(ids).items():
            if times > 1:
                what = f"the id {name!r} is given {times} times"
                found.append(
                    Problem("plan.toml", f"{table}[{ids.index(name) + 1}].id", what, "rename all but one")
                )
    return found or _off_floor(plan)


def _off_floor(plan: PlanFile) -> list[Problem]:
    from shapely import Polygon

    floor = Polygon(plan.outline)
    found = []
    for number, solid in enumerate(plan.solid, 1):
        if not floor.intersects(solid_footprint(solid).shape().centroid):
            what = f"{solid.id!r} stands outside the outline"
            found.append(
                Problem("plan.toml", f"solid[{number}]", what, "move it inside or widen the outline")
            )
    return found


def start_problems(hall: HallFile, plan: PlanFile, bodies: Iterable[Footprint] = ()) -> list[Problem]:
    """Is a visitor's circle free where the hall begins?"""
    from shapely import Point as Spot
    from shapely import Polygon

    from hall_app.walk import BODY

    reach = BODY.radius + BODY.skin
    start = hall.start
    visitor = Spot(start.x, start.z)
    fix = "move start.x and start.z to free floor"
    if not Polygon(plan.outline).contains(visitor.buffer(reach)):
        return [Problem("hall.toml", "start", "a visitor would begin outside the outline", fix)]
    for footprint in (*plan_footprints(plan), *bodies):
        if footprint.shape().distance(visitor) < reach:
            what = f"a visitor would begin inside {footprint.kind} {footprint.id!r}"
            return [Problem("hall.toml", "start", what, fix)]
    return []


def place_faults(plan: PlanFile, identity: str, file: ExhibitFile) -> list[tuple[str, str, str]]:
    """(key, what, fix) of an exhibit that cannot stand where it says."""
    from shapely import Polygon

    on = file.place.on
    if on is not None and on not in {solid.id for solid in plan.solid}:
        known = ", ".join(s.id for s in plan.solid if s.kind in STANDING) or "none"
        return [("place.on", f"plan.toml has no solid {on!r}", f"use one of its booths and stands: {known}")]
    body = body_footprint(identity, file).shape()
    if not Polygon(plan.outline).covers(body):
        at = f"x = {file.place.x:g}, z = {file.place.z:g}"
        return [
            ("place", f"outside the hall's outline ({at})", "change place.x and place.z to a spot inside")
        ]
    faults = []
    for footprint in plan_footprints(plan):
        if footprint.id == on:
            continue
        if footprint.shape().intersection(body).area > TOUCHING:
            fix = "move it with place.x, place.z"
            if footprint.kind in STANDING:
                fix += f', or write place.on = "{footprint.id}" if it stands on top'
            faults.append(("place", f"stands inside {footprint.kind} {footprint.id!r}", fix))
    return faults


def overlapping_bodies(exhibits: Iterable[tuple[str, ExhibitFile]]) -> list[tuple[str, str]]:
    """Pairs of exhibits whose rigid bodies overlap."""
    bodies = [(name, body_footprint(name, file).shape()) for name, file in exhibits]
    return [
        (first, second)
        for index, (first, shape) in enumerate(bodies)
        for second, other in bodies[index + 1 :]
        if shape.intersection(other).area > TOUCHING
    ]
