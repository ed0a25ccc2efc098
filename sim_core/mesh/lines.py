"""Inner lines of a panel (pleat folds, motif borders): inside the outline, cut where they meet, joined to it."""

import numpy as np

from sim_core.errors import OutlineError
from sim_core.mesh.outline import clean_points

__all__ = ["clean_lines"]

NEAR = 1e-6  # of the panel's extent: a line's point this near to a contour or to another line lies on it


def clean_lines(
    lines, contours: list[np.ndarray]
) -> tuple[tuple[np.ndarray, ...], list[np.ndarray], np.ndarray]:
    """Check inner lines and join them to the contours.

    lines: (n, 2) [m] each, open; they may cross and touch.  contours: as `clean_contours` returns them.
    Returns the lines cut at every crossing, the contours with the points lines end at put in, and those points.
    Raises OutlineError naming the line where it is no line or leaves the cloth.
    """
    from shapely import LineString, MultiLineString, Polygon, get_coordinates, line_merge, unary_union

    near = NEAR * float(np.ptp(contours[0], axis=0).max())
    cloth = Polygon(contours[0], contours[1:]).buffer(near)
    given, kept = [], []
    contours = [contour.copy() for contour in contours]
    for k, line in enumerate(lines):
        points = clean_points(line, f"constraint {k}")
        gaps = np.hypot(*np.diff(points, axis=0).T) if len(points) > 1 else np.zeros(0)
        points = points[np.concatenate([[True], gaps > near])] if len(points) else points
        if len(points) < 2:
            raise OutlineError(f"constraint {k}: {len(points)} different points – a line needs at least two")
        if not cloth.covers(LineString(points)):
            x, y = np.array(get_coordinates(LineString(points).difference(cloth)))[0]
            raise OutlineError(
                f"constraint {k}: leaves the cloth near ({x:.4f}, {y:.4f}) m – keep inner lines inside the outline"
            )
        for m, point in enumerate(points):
            points[m] = _put_in(point, contours, near, kept)
        given.append(points)
    for k, points in enumerate(given):
        for end in (0, -1):
            for m, other in enumerate(given):
                if m != k:
                    given[m] = _with_point(points[end], other, near)
    edges = unary_union(MultiLineString([points.tolist() for points in given]))
    rims = [LineString(np.vstack([contour, contour[:1]])).buffer(near / 2) for contour in contours]
    for rim in rims:  # what runs along a contour is that contour already
        edges = _without(edges, rim)
    merged = line_merge(edges) if edges.geom_type == "MultiLineString" else edges
    parts = list(getattr(merged, "geoms", [merged]))
    found = tuple(np.array(part.coords) for part in parts if not part.is_empty and part.length > near)
    return tuple(_opened(found)), contours, np.array(kept).reshape(-1, 2)


def _put_in(point: np.ndarray, contours: list[np.ndarray], near: float, kept: list) -> np.ndarray:
    """The point, or its foot on a contour that is near, which then holds it as a point of its own."""
    for k, contour in enumerate(contours):
        ahead = np.roll(contour, -1, axis=0)
        foot, gap = _feet(point, contour, ahead)
        m = int(gap.argmin())
        if gap[m] > near:
            continue
        for end in (m, (m + 1) % len(contour)):
            if np.hypot(*(contour[end] - point)) <= 2 * near:
                kept.append(contour[end])
                return contour[end]
        contours[k] = np.insert(contour, m + 1, foot[m], axis=0)
        kept.append(foot[m])
        return foot[m]
    return point


def _feet(point: np.ndarray, a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nearest points (m, 2) of segments a b to a point, and their distances (m,)."""
    along = b - a
    t = np.clip(((point - a) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-300), 0, 1)
    foot = a + t[:, None] * along
    return foot, np.hypot(*(foot - point).T)


def _with_point(point: np.ndarray, line: np.ndarray, near: float) -> np.ndarray:
    """A line that holds `point` as a point of its own where it passes near it."""
    _, gap = _feet(point, line[:-1], line[1:])
    m = int(gap.argmin())
    if gap[m] > near or (line == point).all(axis=1).any():
        return line
    for end in (m, m + 1):
        if np.hypot(*(line[end] - point)) <= near:
            line = line.copy()
            line[end] = point
            return line
    return np.insert(line, m + 1, point, axis=0)


def _without(edges, rim):
    """The parts of noded lines that do not run wholly along a contour."""
    from shapely import LineString, MultiLineString

    kept = []
    for part in getattr(edges, "geoms", [edges]):
        coords = np.array(part.coords)
        for a, b in zip(coords[:-1], coords[1:], strict=True):
            if not rim.covers(LineString([a, b])):
                kept.append([a.tolist(), b.tolist()])
    return MultiLineString(kept)


def _opened(parts: tuple[np.ndarray, ...]):
    """Closed lines as two open ones, so that every line has two ends."""
    for part in parts:
        if (part[0] == part[-1]).all():
            middle = len(part) // 2
            yield part[: middle + 1]
            yield part[middle:]
        else:
            yield part
