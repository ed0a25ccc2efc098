"""Which closed lines of a sheet are pieces, which lie inside them, and which two are one piece's cut and seam."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import shapely

from sim_core.errors import OutlineError
from sim_core.mesh.sheets.pieces.boxes import Boxes
from sim_core.mesh.sheets.strokes.stroke import Stroke
from sim_core.mesh.sheets.strokes.words import Role, material_of, names_piece, speaks, spoken

__all__ = ["GENERIC", "Contour", "contours", "owner_of", "piece_name", "seam_inside"]

NARROWEST = 0.002  # [m] of a piece both ways
SLACK = 5e-4  # [m] by which a line inside may leave its outline
LOOPS = 0.02  # most of the area in loops
WIDEST = 0.06  # [m] most of a seam allowance
TWIN = 0.98  # least share of the area in a line drawn twice
MOST_STEPS = 4000  # along what sticks out of an outline
FEW = 10  # corners that are tried before all that sticks out
MOST_TRIED = 40  # outlines that may lie around one, on average over a sheet of as many and more
FRAMES = {"border", "borders", "frame", "page", "paper", "sheet", "rahmen", "cadre", "background"}
GENERIC = {"pieces", "piece", "pattern", "patterns", "sheet", "drawing", "main", "model", "parts", "outline"}


@dataclass
class Contour:
    """A closed line and what it turned out to be: inside: contours right inside it; within: how deep it lies;
    size: of the sizes of one piece that lie on each other, which one it is."""

    stroke: Stroke
    role: Role
    area: float
    shape: Any
    material: str
    owner: tuple[str, ...]
    inside: list[Contour] = field(default_factory=list)
    within: int = 0
    size: str = ""


def owner_of(stroke: Stroke) -> tuple[str, ...]:
    """Names around a line that may be a piece's: not those that say what kind of lines they hold."""
    return tuple(
        name for name in stroke.groups if name in stroke.told or not (speaks(name) or name.lower() in GENERIC)
    )


def piece_name(owner: tuple[str, ...]) -> str:
    """The innermost name, without what FreeSewing sets before it."""
    return owner[-1].rsplit("-part-", 1)[-1] if owner else ""


def contours(
    strokes: list[tuple[Stroke, Role]],
    remarks: list[str],
    left_out: Counter[str],
    sizes: dict[str, str],
) -> list[Contour]:
    """The outermost contours, each with what lies inside; open cutting lines are closed, which a remark says.

    sizes: of layers that are named after one.
    """
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
            found.append(
                Contour(
                    stroke, role, float(shape.area), shape, material, owner, size=sizes.get(stroke.layer, "")
                )
            )
        else:
            left_out["closed lines of less than 2 mm"] += 1
    return _pieces(_nested(found, left_out), left_out)


def _pieces(outermost: list[Contour], left_out: Counter[str]) -> list[Contour]:
    """Outermost contours that are pieces. One whose layer names a kind of line and a piece ("BUTTON PLACKET") is a
    piece where it lies in none, and else what the kind says."""
    kept = []
    for contour in outermost:
        if contour.role in ("hole", "inner", "mark"):
            if not names_piece(contour.stroke.layer):
                left_out[f"{contour.stroke.layer or contour.role} outside every piece"] += 1
                continue
            contour.role = ""
        kept.append(contour)
        for inner in contour.inside:
            inner.inside = _unmarked(inner.inside, left_out)
        contour.inside = _unmarked(contour.inside, left_out)
    return kept


def _unmarked(inside: list[Contour], left_out: Counter[str]) -> list[Contour]:
    for contour in inside:
        left_out[contour.stroke.layer] += contour.role == "mark"
    return [contour for contour in inside if contour.role != "mark"]


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
    boxes = Boxes(np.array([contour.shape.bounds for contour in found]).reshape(-1, 4))
    outermost: list[Contour] = []
    first: dict[int, int] = {}  # of a line drawn twice, the one it is
    patience = MOST_TRIED * (len(found) + MOST_TRIED)
    for k, contour in enumerate(found):
        holder, tried = _holder(found, boxes, k, first)
        patience -= tried
        if patience < 0:
            raise OutlineError(
                "too many outlines lie on each other – give each size or layer a sheet of its own"
            )
        if holder is None:
            outermost.append(contour)
        elif _twin(found[holder], contour):
            found[holder].role = found[holder].role or contour.role
            left_out["outlines drawn twice"] += 1
            first[k] = holder
        else:
            found[holder].inside.append(contour)
            contour.within = found[holder].within + 1
    frames = {id(contour) for contour in outermost if _frame(contour)}
    kept = [contour for contour in outermost if id(contour) not in frames]
    for frame in (contour for contour in outermost if id(contour) in frames):
        kept += frame.inside
        left_out["frame around pieces"] += 1
    return sorted(kept, key=lambda contour: order[id(contour)])


def _holder(found: list[Contour], boxes: Boxes, number: int, first: dict[int, int]) -> tuple[int | None, int]:
    """The number of the least contour around one of them, and how many were tried."""
    contour, tried, failed = found[number], 0, set()
    for tried, last in enumerate(boxes.around(number, SLACK), 1):  # noqa: B007 - told to whoever counts
        k = first.get(last, last)
        if k not in failed and _may_hold(found[k], contour) and _holds(found[k].shape, contour.shape):
            return k, tried
        failed.add(k)
    return None, tried


def _holds(outer: Any, inner: Any) -> bool:
    """Whether an area lies in another, or leaves it by no more than SLACK. (An outline of many teeth cannot be grown
    by SLACK in bounded time, so what sticks out of it is measured instead.)"""
    if outer.covers(inner):
        return True
    corners = shapely.get_coordinates(inner)
    if not shapely.dwithin(outer, shapely.points(corners[:: 1 + len(corners) // FEW]), SLACK).all():
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
    """Lines of two materials, sizes, or named groups side by side are two pieces even where one lies on the other."""
    if outer.material and inner.material and outer.material != inner.material:
        return False
    if outer.size and inner.size and outer.size != inner.size:
        return False
    least = min(len(outer.owner), len(inner.owner))
    return outer.owner[:least] == inner.owner[:least]


def _frame(contour: Contour) -> bool:
    """Whether it is a rectangle around pieces: a page, a title block."""
    if contour.role or len(contour.stroke.points) != 4 or not contour.inside:
        return False
    said = spoken(contour.stroke.name, contour.stroke.layer)
    if any(word in FRAMES for word in said):
        return True
    if len(contour.inside) < 2:
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
