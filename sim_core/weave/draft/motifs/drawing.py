"""A motif drawn as SVG: what is filled or stroked in a colour becomes an area with that colour's number.

The drawing's own frame is the repeat; what leaves it comes in at the other side, as in every motif.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.errors import WeaveError
from sim_core.validation.svg import (
    LENGTHS,
    NUMBER,
    PIXEL,
    check_bounds,
    curves_of,
    drawing_of,
    left_out_of,
    polylines,
    svg_root,
    told,
)

__all__ = ["Area", "Drawing", "areas_of", "read_drawing"]

WHAT = "a motif drawn as SVG"
FINE = 0.01  # [mm] to which places are kept
MOST_POINTS = 200_000
MOST_CROSSED = 800  # points and crossings of a path that crosses itself
MOST_WORK = 500_000_000  # edges times areas of one path
MOST_TEXT = 2_000_000  # characters of all areas of a motif
MOST_TURNS = 4_000  # outlines, in repeats
BEYOND = 1.0  # repeats by which an area may stand out of its own
REMEDY = "fill closed paths with plain colours"
SIZES = {"mm", "cm", "m", "in", "pt", "pc", "q"}
CAPS = {"butt": "flat", "square": "square", "round": "round"}
JOINS = {"miter": "mitre", "bevel": "bevel", "round": "round"}
Area = tuple[int, str]  # a number, and where it lies: WKT [mm], from the repeat's lower left corner, y up
Size = tuple[float, float]
Drawing = tuple[Size, tuple[Area, ...]]
Colours = Mapping[str, int]


def read_drawing(
    path: Path, colours: Colours, repeat: Sequence[float] | None, changes: Mapping[str, float]
) -> Drawing:
    """The size of a drawing's repeat (along the weft, along the warp) [mm], and its areas in the order of painting.

    colours: the number of every colour in it, by "#rrggbb".  repeat: to which the drawing's frame is stretched [mm];
    None: its own size, which then has to be in units of length.  changes: `width` or `height` [mm] that is to be
    another; one alone keeps the proportions.
    Raises FileProblem for what cannot be read, and in one line for what no loom can weave: texts, pictures, gradients,
    colours without a number, lines out of all range.
    """
    from shapely.errors import ShapelyError

    root = svg_root(path, WHAT)
    with told(path, REMEDY, ShapelyError, longest=240):
        check_bounds(root)
        for what in left_out_of(root):
            if not what.startswith("hidden"):
                raise ValueError(f"{what[:60]}: nothing that can be woven – {REMEDY}")
        size = _changed(tuple(repeat) if repeat else _own_size(root), changes)
        frame = _frame(root)
        drawing, _ = drawing_of(root, PIXEL)  # a user unit is a unit then
        with np.errstate(all="ignore"):
            return size, tuple(_areas(drawing, frame, size, {key.lower(): n for key, n in colours.items()}))


def _changed(size: tuple[float, ...], changes: Mapping[str, float]) -> Size:
    for key in changes:
        if key not in ("width", "height"):
            raise ValueError(f"parameters.{key}: unknown – a drawing has width, height")
    width, height = size
    new = (
        changes.get("width", width * changes.get("height", height) / height),
        changes.get("height", height * changes.get("width", width) / width),
    )
    return new


def areas_of(areas: Sequence[Area]) -> tuple[tuple[int, Any], ...]:
    """Numbers and polygons [m] of areas as they are stored; raises WeaveError."""
    import shapely
    from shapely.errors import ShapelyError

    if sum(len(text) for _, text in areas) > MOST_TEXT:
        raise WeaveError(f"svg: more than {MOST_TEXT:,} characters of outlines – simplify the drawing")
    try:
        found = [(number, shapely.from_wkt(text)) for number, text in areas]
        if any(area.geom_type not in ("Polygon", "MultiPolygon") for _, area in found):
            raise WeaveError("svg: an area that is no polygon – read the drawing anew")
        return tuple(
            (number, shapely.transform(area, lambda points: 1e-3 * points)) for number, area in found
        )
    except (ShapelyError, ValueError, TypeError, AttributeError) as error:
        raise WeaveError("svg: areas that cannot be read – read the drawing anew") from error


def _own_size(root: Any) -> tuple[float, float]:
    """Width and height [mm] that the file itself states; raises ValueError."""
    styled = dict(re.findall(r"([a-z-]+)\s*:\s*([^;]+)", root.get("style", "")))
    found = []
    for side in ("width", "height"):
        text = styled.get(side, root.get(side, "")).strip().lower()
        match = re.fullmatch(rf"({NUMBER.pattern})\s*([a-z]+)", text)
        if match is None or match[2] not in SIZES:
            raise ValueError(
                f"its {side} {text[:30]!r} is no length – state width and height in mm, or `repeat` in the motif file"
            )
        length = float(match[1]) * LENGTHS[match[2]] * 25.4 / 96
        if not 0.1 <= length <= 4000:
            raise ValueError(f"its {side} is {length:g} mm – give .1 to 4000 mm")
        found.append(length)
    return found[0], found[1]


def _frame(root: Any) -> np.ndarray:
    """(2,) width and height of the drawing's frame in user units; raises ValueError."""
    box = [float(value) for value in NUMBER.findall(root.get("viewBox", ""))]
    if len(box) == 4:
        found = np.array(box[2:])
    else:
        sides = [
            re.fullmatch(rf"({NUMBER.pattern})\s*([a-z]*)", root.get(side, "").strip().lower())
            for side in ("width", "height")
        ]
        found = np.array([float(side[1]) * LENGTHS[side[2]] for side in sides if side and side[2] in LENGTHS])
    if len(found) != 2 or not (np.isfinite(found).all() and (found > 0).all()):
        raise ValueError("its frame has no size – give it a viewBox, which is the repeat")
    return found


def _areas(drawing: Any, frame: np.ndarray, size: Size, numbers: dict[str, int]) -> Iterator[Area]:
    """Numbers and areas as WKT [mm], y up, in the order of painting; raises ValueError."""
    import shapely
    from svgelements import Shape

    corner = np.array([0.0, frame[1]])  # of the frame, where y up begins
    scale = np.array(size) / frame * (1.0, -1.0)
    count, length = 0, 0.0
    for element in drawing.elements(lambda one: isinstance(one, Shape)):
        values = element.values or {}
        if values.get("visibility") in ("hidden", "collapse") or not _solid(values.get("opacity")):
            continue
        found = {
            kind: number
            for kind in ("fill", "stroke")
            if (number := _number(element, kind, numbers)) is not None
        }
        if not found:
            continue
        width = float(element.implicit_stroke_width) * abs(float(np.prod(scale))) ** 0.5
        lines = [((points - corner) * scale, closed) for points, closed in polylines(curves_of(element))]
        for points, _ in lines:
            _check_reach(points, size)
            count += len(points)
            length += float(np.abs(np.diff(points, axis=0) / size).sum())
        if count > MOST_POINTS or length > MOST_TURNS:
            raise ValueError(
                f"more than {MOST_POINTS:,} points or {MOST_TURNS:,} repeats of line – simplify its paths"
            )
        for kind, number in found.items():
            area = (
                _filled([points for points, _ in lines], values.get("fill-rule", "nonzero"))
                if kind == "fill"
                else _stroked(lines, width, values)
            )
            area = shapely.set_precision(area, FINE)
            parts = [
                one for one in getattr(area, "geoms", [area]) if one.geom_type == "Polygon" and one.area > 0
            ]
            if parts:
                yield number, shapely.to_wkt(shapely.multipolygons(parts), rounding_precision=2)


def _solid(text: Any) -> bool:
    """Whether an opacity leaves anything to be seen; raises ValueError."""
    return text is None or float(str(text).rstrip("%")) > 0


def _number(element: Any, kind: str, numbers: dict[str, int]) -> int | None:
    """The number of what an element is filled or stroked with; None: with nothing. Raises ValueError."""
    values = element.values or {}
    said = str(values.get(kind, "black" if kind == "fill" else "none")).strip()
    if "url(" in said:
        raise ValueError(f"{kind} {said[:40]!r} is no plain colour – {REMEDY}")
    colour = getattr(element, kind)
    if (
        colour is None
        or colour.value is None
        or not colour.alpha
        or not _solid(values.get(f"{kind}-opacity"))
    ):
        return None
    name = f"#{colour.red:02x}{colour.green:02x}{colour.blue:02x}"
    if name not in numbers:
        known = ", ".join(numbers) or "none"
        raise ValueError(f"{kind} {name} has no number – add it to `colours` of the motif file ({known})")
    return numbers[name]


def _check_reach(points: np.ndarray, size: Size) -> None:
    low, high = -BEYOND * np.array(size), (1.0 + BEYOND) * np.array(size)
    if not ((points >= low) & (points <= high)).all():  # false for NaN too
        raise ValueError(
            f"a path leaves the frame of {size[0]:g} x {size[1]:g} mm by more than a repeat – draw it within; what "
            "crosses a border comes in at the other side"
        )


def _stroked(lines: list[tuple[np.ndarray, bool]], width: float, values: Mapping[str, Any]) -> Any:
    """What a line of some width [mm] covers."""
    import shapely

    if not 0 <= width <= 4000:
        raise ValueError("a stroke-width out of all range – give it in the units of the drawing")
    cap: Any = CAPS.get(str(values.get("stroke-linecap", "butt")), "flat")
    join: Any = JOINS.get(str(values.get("stroke-linejoin", "miter")), "mitre")
    strokes = [
        shapely.LinearRing(points) if closed and len(points) > 2 else shapely.LineString(points)
        for points, closed in lines
        if len(points) > 1
    ]
    return shapely.union_all(
        shapely.buffer(strokes, width / 2, cap_style=cap, join_style=join, mitre_limit=4.0)
    )


def _filled(rings: list[np.ndarray], rule: str) -> Any:
    """What rings (N, 2) enclose, by how often they wind round it: an odd number of times, or any."""
    import shapely

    rings = [ring for ring in rings if len(np.unique(ring, axis=0)) > 2]
    if not rings:
        return shapely.Polygon()
    if len(rings) == 1 and (whole := shapely.Polygon(rings[0])).is_valid:
        return whole
    edges: Any = shapely.MultiLineString([shapely.LinearRing(ring) for ring in rings])
    if not shapely.is_simple(edges):
        many = sum(map(len, rings))
        if many > MOST_CROSSED or _crossings(rings) > MOST_CROSSED:
            raise ValueError(
                f"a path of {many:,} points that crosses itself too often – unite it, or part it"
            )
        edges = shapely.union_all(edges)
    faces = [
        face for face in shapely.get_parts(shapely.polygonize(shapely.get_parts(edges))) if face.area > 0
    ]
    inner = shapely.get_coordinates([face.representative_point() for face in faces])
    if len(faces) * sum(map(len, rings)) > MOST_WORK:
        raise ValueError(f"a path of {len(rings):,} rings – part it into several paths")
    turns = np.sum([_winding(ring, inner) for ring in rings], axis=0)
    chosen = turns % 2 == 1 if rule == "evenodd" else turns != 0
    return shapely.union_all([face for face, there in zip(faces, chosen, strict=True) if there])


def _crossings(rings: list[np.ndarray]) -> int:
    """How many pairs of edges cross each other."""
    a, b = np.concatenate(rings), np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])

    def side(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> np.ndarray:
        one, other = q - p, r[None] - p[:, None]
        return np.sign(one[:, None, 0] * other[..., 1] - one[:, None, 1] * other[..., 0])

    apart = side(a, b, a) * side(a, b, b) < 0
    return int((apart & apart.T).sum()) // 2


def _winding(ring: np.ndarray, places: np.ndarray) -> np.ndarray:
    """How often a ring (N, 2) goes round each place (M, 2), anticlockwise: by its edges that cross the ray to +x."""
    a, b = ring, np.roll(ring, -1, axis=0)
    found = np.zeros(len(places), int)
    for k, (x, y) in enumerate(places):
        up, down = (a[:, 1] <= y) & (b[:, 1] > y), (a[:, 1] > y) & (b[:, 1] <= y)
        beyond = (b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (x - a[:, 0]) * (b[:, 1] - a[:, 1])
        found[k] = int((up & (beyond > 0)).sum()) - int((down & (beyond < 0)).sum())
    return found
