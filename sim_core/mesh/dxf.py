"""Outlines from text DXF: LWPOLYLINE, POLYLINE, LINE, ARC, CIRCLE, ELLIPSE and SPLINE, joined where their ends meet.

Closed lines are contours (the largest is the outline, the others are holes), open ones are inner lines. $INSUNITS
gives the unit; without it a drawing is taken to be in millimetres. DXF has y up; the outline has y down.
"""

from math import radians
from pathlib import Path

import numpy as np
from scipy.spatial import KDTree

from sim_core.errors import FileProblem
from sim_core.mesh.curves import bulge_points
from sim_core.reading import read_text

__all__ = ["read_dxf"]

METRES = {0: 1e-3, 1: 0.0254, 2: 0.3048, 4: 1e-3, 5: 1e-2, 6: 1.0, 10: 0.9144, 14: 0.1}
NEAR = 1e-6  # of the drawing's extent: ends this near are joined
ROUND = 128  # pieces of a full circle
PIECES = 64  # of a spline between knots
IN_ENTITY_AXES = ("LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE")  # the others are given in the drawing's own

Entity = tuple[str, list[tuple[int, str]]]


def read_dxf(path: Path) -> list[tuple[np.ndarray, bool]]:
    """The lines of a DXF file as (points (n, 2) [m], y down, closed). Raises FileProblem."""
    text = read_text(path, "an outline drawn as DXF")
    if text.startswith("AutoCAD Binary DXF"):
        raise FileProblem(f"{path}: binary DXF – save it as text (ASCII) DXF")
    lines = text.splitlines()
    try:
        pairs = [(int(lines[k]), lines[k + 1].strip()) for k in range(0, len(lines) - 1, 2)]
    except ValueError as error:
        raise FileProblem(f"{path}: not a DXF file ({error}) – give an outline drawn as text DXF") from error
    if not any(pair == (0, "SECTION") for pair in pairs):
        raise FileProblem(f"{path}: no section in it – give an outline drawn as text DXF")
    try:
        with np.errstate(all="ignore"):  # what leaves the range is told by whoever sorts the lines
            drawn = [_seen(entity, line) for entity in _entities(pairs) for line in _line(entity)]
        scale = METRES.get(_unit(pairs))
    except (ValueError, IndexError, ZeroDivisionError, OverflowError) as error:
        raise FileProblem(f"{path}: an entity cannot be read ({error}) – draw it as polylines") from error
    if scale is None:
        raise FileProblem(f"{path}: $INSUNITS {_unit(pairs)} – draw in mm, cm, m, dm, inches, feet or yards")
    return [(points * (scale, -scale), closed) for points, closed in _joined(drawn)]


def _unit(pairs: list[tuple[int, str]]) -> int:
    for k, pair in enumerate(pairs[:-1]):
        if pair == (9, "$INSUNITS"):
            return int(pairs[k + 1][1])
    return 0


def _entities(pairs: list[tuple[int, str]]) -> list[Entity]:
    """Entities of the ENTITIES section, vertices of a POLYLINE folded into it."""
    found: list[Entity] = []
    inside, outline = False, None
    for k, (code, value) in enumerate(pairs):
        if code == 0:
            if value == "SECTION":
                inside = k + 1 < len(pairs) and pairs[k + 1] == (2, "ENTITIES")
            elif value == "ENDSEC":
                inside = False
            elif inside and value == "SEQEND":
                outline = None
            elif inside and value == "VERTEX" and outline is not None:
                outline.append((-1, ""))
            elif inside:
                found.append((value, []))
                outline = found[-1][1] if value == "POLYLINE" else None
        elif inside and found:
            found[-1][1].append((code, value))
    return found


def _seen(entity: Entity, line: tuple[np.ndarray, bool]) -> tuple[np.ndarray, bool]:
    """A line as the drawing shows it: an extrusion towards -z (group 230) mirrors what is given in entity axes."""
    kind, tags = entity
    mirrored = kind in IN_ENTITY_AXES and any(code == 230 and float(text) < 0 for code, text in tags)
    return (line[0] * (-1.0, 1.0), line[1]) if mirrored else line


def _line(entity: Entity) -> list[tuple[np.ndarray, bool]]:
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


def _joined(drawn: list[tuple[np.ndarray, bool]]) -> list[tuple[np.ndarray, bool]]:
    """Open lines joined end to end where only two ends meet; what comes back to its start is closed.

    A line that hangs free at its other end does not count where it meets a joint: it is an inner line.
    """
    if not drawn or not all(np.isfinite(points).all() for points, _ in drawn):
        return drawn
    near = NEAR * float(np.ptp(np.concatenate([points for points, _ in drawn]), axis=0).max())
    found = [line for line in drawn if line[1]]
    rest = [points for points, closed in drawn if not closed and np.ptp(points, axis=0).max() > near]
    mate = _mates(rest, near)
    done: set[int] = set()
    for k in range(len(rest)):
        if k in done:
            continue
        begin = 2 * k  # ends are numbered 2 k and 2 k + 1: back to where this chain begins, or once around
        while mate[begin] >= 0 and mate[begin] ^ 1 != 2 * k:
            begin = mate[begin] ^ 1
        parts, end = [], begin
        while end >= 0 and end // 2 not in done:
            done.add(end // 2)
            part = rest[end // 2][:: -1 if end % 2 else 1]
            parts.append(part[1:] if parts else part)
            end = mate[end ^ 1]
        line = np.vstack(parts)
        closed = len(line) > 3 and bool(np.hypot(*(line[0] - line[-1])) <= near)
        found.append((line[:-1] if closed else line, closed))
    return found


def _mates(lines: list[np.ndarray], near: float) -> list[int]:
    """For both ends of each line the one other end that it meets, or -1."""
    if not lines:
        return []
    ends = np.array([line[k] for line in lines for k in (0, -1)])
    pairs = KDTree(ends).query_pairs(near, output_type="ndarray")
    meets = np.bincount(pairs.ravel(), minlength=len(ends))
    other = np.arange(len(ends)) ^ 1
    hangs = (meets > 1) & (meets[other] == 0)
    pairs = pairs[~hangs[pairs].any(axis=1)]
    meets = np.bincount(pairs.ravel(), minlength=len(ends))
    pairs = pairs[(meets[pairs] == 1).all(axis=1)]
    mate = np.full(len(ends), -1)
    mate[pairs] = pairs[:, ::-1]
    return mate.tolist()
