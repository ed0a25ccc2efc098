"""Which closed lines of a sheet are pieces, which lie inside them, and which two are one piece's cut and seam."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import shapely

from sim_core.mesh.sheets.strokes.stroke import Stroke
from sim_core.mesh.sheets.strokes.words import Role, material_of, speaks

__all__ = ["Contour", "contours", "owner_of", "piece_name", "seam_inside"]

NARROWEST = 0.002  # [m] of a piece both ways
SLACK = 5e-4  # [m] by which a line inside may leave its outline
LOOPS = 0.02  # most of the area in loops
WIDEST = 0.06  # [m] most of a seam allowance
TWIN = 0.98  # least share of the area in a line drawn twice
MOST_STEPS = 4000  # along what sticks out of an outline
GENERIC = {"pieces", "piece", "pattern", "patterns", "sheet", "drawing", "main", "model", "parts", "outline"}


@dataclass
class Contour:
    """A closed line and what it turned out to be: inside: contours right inside it; within: how deep it lies."""

    stroke: Stroke
    role: Role
    area: float
    shape: Any
    material: str
    owner: tuple[str, ...]
    inside: list[Contour] = field(default_factory=list)
    within: int = 0


def owner_of(stroke: Stroke) -> tuple[str, ...]:
    """Names around a line that may be a piece's: not those that say what kind of lines they hold."""
    return tuple(name for name in stroke.groups if not speaks(name) and name.lower() not in GENERIC)


def piece_name(owner: tuple[str, ...]) -> str:
    """The innermost name, without what FreeSewing sets before it."""
    return owner[-1].rsplit("-part-", 1)[-1] if owner else ""


def contours(strokes: list[tuple[Stroke, Role]], remarks: list[str], left_out: Counter[str]) -> list[Contour]:
    """The outermost contours, each with what lies inside; open cutting lines are closed, which a remark says."""
    found = []
    for stroke, role in strokes:
        if not stroke.closed:
            stroke = replace(stroke, closed=True)
            name = piece_name(owner_of(stroke)) or stroke.layer or "a piece"
            remarks.append(
                f"{name}: its {role or 'outer'} line is open, closed straight from end to end as on a fold"
            )
        stroke, shape = _without_loops(stroke, remarks)
        if np.ptp(stroke.points, axis=0).min() >= NARROWEST and shape.area > 0:
            owner = owner_of(stroke)
            material = material_of(stroke.words)
            found.append(Contour(stroke, role, float(shape.area), shape, material, owner))
        else:
            left_out["closed lines of less than 2 mm"] += 1
    return _nested(found, left_out)


def _without_loops(stroke: Stroke, remarks: list[str]) -> tuple[Stroke, Any]:
    """A line and its area, without the small loops that an offset line makes at corners; a remark tells of them."""
    given = shapely.Polygon(stroke.points)
    if given.is_valid:
        return stroke, given
    shape = shapely.make_valid(given)
    parts: list[Any] = [part for part in shapely.get_parts(shape) if isinstance(part, shapely.Polygon)]
    rims = [shapely.Polygon(part.exterior) for part in parts]
    if not rims:
        return stroke, shape
    largest = max(rims, key=lambda rim: rim.area)
    away = shapely.symmetric_difference(
        shape, largest
    ).area  # a loop is a hole of the one and none of the other
    if not away < LOOPS * largest.area:
        return stroke, shape
    name = piece_name(owner_of(stroke)) or stroke.layer or "a piece"
    remarks.append(f"{name}: its outline crosses itself, small loops are left out")
    return replace(stroke, points=np.array(largest.exterior.coords)[:-1]), largest


def _nested(found: list[Contour], left_out: Counter[str]) -> list[Contour]:
    """Every contour put into the least one around it; returns those within none, or within a frame."""
    order = {id(contour): k for k, contour in enumerate(found)}
    found = sorted(found, key=lambda contour: (-contour.area, contour.role != "cut"))
    for each in found:
        shapely.prepare(each.shape)
    tree = shapely.STRtree([contour.shape for contour in found])
    outermost, twins = [], set()
    for k, contour in enumerate(found):
        around = tree.query(contour.shape, predicate="intersects")
        holders = [
            m
            for m in sorted(around.tolist(), reverse=True)
            if m < k and m not in twins and _may_hold(found[m], contour)
        ]
        holder = next((m for m in holders if _holds(found[m].shape, contour.shape)), None)
        if holder is None:
            outermost.append(contour)
        elif _twin(found[holder], contour):
            found[holder].role = found[holder].role or contour.role
            left_out["outlines drawn twice"] += 1
            twins.add(k)
        else:
            found[holder].inside.append(contour)
            contour.within = found[holder].within + 1
    kept = [c for c in outermost if not _frame(c)]
    for frame in (c for c in outermost if _frame(c)):
        kept += frame.inside
        left_out["frame around pieces"] += 1
    return sorted(kept, key=lambda contour: order[id(contour)])


def _holds(outer: Any, inner: Any) -> bool:
    """Whether an area lies in another, or leaves it by no more than SLACK. (An outline of many teeth cannot be grown
    by SLACK in bounded time, so what sticks out of it is measured instead.)"""
    if outer.covers(inner):
        return True
    low, high = np.array(outer.bounds).reshape(2, 2)
    least, most = np.array(inner.bounds).reshape(2, 2)
    if (least < low - SLACK).any() or (most > high + SLACK).any():
        return False
    out = shapely.difference(inner, outer)
    step = max(SLACK, out.length / MOST_STEPS)
    points = shapely.points(shapely.get_coordinates(shapely.segmentize(out, step)))
    return bool(shapely.dwithin(outer, points, SLACK).all())


def _twin(outer: Contour, inner: Contour) -> bool:
    """Whether it is the same line again, such as a fill and its rim; a cut and a seam in one place are two."""
    if inner.area < TWIN * outer.area or (outer.role and inner.role and outer.role != inner.role):
        return False
    return _holds(inner.shape, outer.shape)


def _may_hold(outer: Contour, inner: Contour) -> bool:
    """Lines of two materials, or of two named groups side by side, are two pieces even where one lies on the other."""
    if outer.material and inner.material and outer.material != inner.material:
        return False
    least = min(len(outer.owner), len(inner.owner))
    return outer.owner[:least] == inner.owner[:least]


def _frame(contour: Contour) -> bool:
    """Whether it is a rectangle around pieces: a page, a title block."""
    if contour.role or len(contour.stroke.points) != 4 or len(contour.inside) < 2:
        return False
    told = sum(inner.role in ("cut", "sew") for inner in contour.inside)
    if told > 1 or len({inner.owner for inner in contour.inside}) > 1:
        return True
    names = {
        inner.stroke.name for inner in contour.inside if inner.role == "" and not speaks(inner.stroke.name)
    }
    return not contour.stroke.name and len(names) > 1


def seam_inside(outer: Contour) -> Contour | None:
    """The contour right inside another that runs along it at the distance of a seam allowance, if there is one."""
    for inner in sorted(outer.inside, key=lambda contour: -contour.area):
        if outer.role != "sew" and inner.role == "sew" and inner.area > 0.3 * outer.area:
            return inner
        if outer.role == "sew" or inner.role == "hole" or inner.area < 0.3 * outer.area:
            continue
        steps = shapely.distance(shapely.points(inner.stroke.points), shapely.boundary(outer.shape))
        usual = float(np.median(steps))
        same = np.mean((steps > usual / 2 - SLACK) & (steps < 2 * usual + SLACK))
        if SLACK < steps.max() and usual < WIDEST and steps.max() < 3 * WIDEST and same > 0.7:
            return inner
    return None
