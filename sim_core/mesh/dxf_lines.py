"""Entities of a DXF file as polylines: straight pieces, bulges, arcs, ellipses and splines."""

from math import radians

import numpy as np

from sim_core.mesh.curves import bulge_points

__all__ = ["Entity", "Tags", "as_seen", "entity_lines"]

ROUND = 128  # pieces of a full circle
PIECES = 64  # of a spline between knots
IN_ENTITY_AXES = ("LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE")  # the others are given in the drawing's own

Tags = list[tuple[int, str]]
Entity = tuple[str, Tags]


def as_seen(entity: Entity, line: tuple[np.ndarray, bool]) -> tuple[np.ndarray, bool]:
    """A line as the drawing shows it: an extrusion towards -z (group 230) mirrors what is given in entity axes."""
    kind, tags = entity
    mirrored = kind in IN_ENTITY_AXES and any(code == 230 and float(text) < 0 for code, text in tags)
    return (line[0] * (-1.0, 1.0), line[1]) if mirrored else line


def entity_lines(entity: Entity) -> list[tuple[np.ndarray, bool]]:
    """The lines (points (n, 2), closed) that an entity draws, in its own axes and the drawing's unit."""
    kind, tags = entity
    if kind == "LWPOLYLINE":
        return _polyline(tags, 10)
    if kind == "POLYLINE":
        first = next((k for k, (code, _) in enumerate(tags) if code == -1), len(tags))
        return _polyline([t for t in tags[:first] if t[0] == 70] + tags[first:], -1)
    value = {code: text for code, text in tags}

    def number(code: int, default: float = 0.0) -> float:
        return float(value.get(code, default))

    if kind == "LINE":
        return [(np.array([[number(10), number(20)], [number(11), number(21)]]), False)]
    if kind in ("ARC", "CIRCLE"):
        begin, end = (0.0, 360.0) if kind == "CIRCLE" else (number(50), number(51))
        span = (end - begin) % 360 or 360.0
        return [
            _turned(
                number(10),
                number(20),
                number(40),
                number(40),
                0.0,
                radians(begin),
                radians(span),
                span == 360,
            )
        ]
    if kind == "ELLIPSE":
        x, y, begin, end = number(11), number(21), number(41), number(42, 2 * np.pi)
        long, span = float(np.hypot(x, y)), (end - begin) % (2 * np.pi) or 2 * np.pi
        whole = abs(span - 2 * np.pi) < 1e-9
        return [
            _turned(
                number(10),
                number(20),
                long,
                long * number(40, 1),
                float(np.arctan2(y, x)),
                begin,
                span,
                whole,
            )
        ]
    if kind == "SPLINE":
        return [_spline(tags)]
    return []


def _turned(cx, cy, a, b, tilt, begin, span, closed: bool) -> tuple[np.ndarray, bool]:
    t = begin + span * np.linspace(0, 1, max(8, int(np.ceil(ROUND * span / (2 * np.pi)))) + 1)
    if closed:
        t = t[:-1]
    c, s = np.cos(tilt), np.sin(tilt)
    x, y = a * np.cos(t), b * np.sin(t)
    return np.column_stack([cx + c * x - s * y, cy + s * x + c * y]), closed


def _polyline(tags: list[tuple[int, str]], opens: int) -> list[tuple[np.ndarray, bool]]:
    flag, corners = 0, []
    for code, value in tags:
        if code == 70 and not corners:
            flag = int(value)
        if code == opens:
            corners.append([0.0, 0.0, 0.0])
        if corners and code in (10, 20, 42):
            corners[-1][(10, 20, 42).index(code)] = float(value)
    if len(corners) < 2:
        return []
    closed = bool(flag & 1)
    points = [np.array(corners[0][:2])]
    following = [*corners[1:], corners[0]] if closed else corners[1:]
    for here, ahead in zip(corners, following, strict=False):
        points.extend(bulge_points(here[:2], ahead[:2], here[2]))
    return [(np.array(points[:-1] if closed else points), closed)]


def _spline(tags: list[tuple[int, str]]) -> tuple[np.ndarray, bool]:
    from scipy.interpolate import BSpline

    def all_of(code: int) -> np.ndarray:
        return np.array([float(text) for c, text in tags if c == code])

    degree = int(next((text for c, text in tags if c == 71), "3"))
    flag = int(next((text for c, text in tags if c == 70), "0"))
    knots, control = all_of(40), np.column_stack([all_of(10), all_of(20)])
    if len(knots) != len(control) + degree + 1:
        raise ValueError(f"a spline of {len(control)} control points and {len(knots)} knots")
    weights = all_of(41) if len(all_of(41)) == len(control) else np.ones(len(control))
    spans = np.unique(knots[degree : len(control) + 1])
    t = np.unique(
        np.concatenate([np.linspace(a, b, PIECES + 1) for a, b in zip(spans[:-1], spans[1:], strict=True)])
    )
    curve = BSpline(knots, np.column_stack([control * weights[:, None], weights]), degree)(t)
    points = curve[:, :2] / curve[:, 2:]
    return points, bool(flag & 1) and bool(np.allclose(points[0], points[-1]))
