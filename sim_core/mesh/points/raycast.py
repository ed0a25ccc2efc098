"""Redundant points: outside the contours, on them, or nearer than a threshold (the paper's two methods)."""

import numpy as np
from numba import njit

from sim_core.mesh.geometry.cells import bounds
from sim_core.mesh.geometry.predicates import orient

__all__ = ["distance_below", "inside", "keep_points"]

MOST_ROWS = 8  # that a segment passes on average: rows are as fine as that allows


def inside(points: np.ndarray, contours: list[np.ndarray]) -> np.ndarray:
    """Whether points lie strictly inside: a horizontal ray to the right crosses the contours an odd number of times.

    points: (n, 2) [m]; contours: outline and holes, (m, 2) [m] each, in any direction. Returns (n,) bool.
    An edge counts where exactly one of its ends is above the ray (half-open rule), so a ray through a corner counts
    once. Points on a contour are found exactly and are not inside, as the paper has it.
    """
    points = np.ascontiguousarray(points, dtype=float).reshape(-1, 2)
    segments = np.concatenate([np.hstack([c, np.roll(c, -1, axis=0)]) for c in contours])
    low, high = float(segments[:, [1, 3]].min()), float(segments[:, [1, 3]].max())
    passed = float(np.abs(segments[:, 3] - segments[:, 1]).sum()) / max(high - low, 1e-300)
    rows = max(1, min(len(segments), int(MOST_ROWS * len(segments) / max(passed, 1.0))))
    per_metre = rows / max(high - low, 1e-300)
    start, items = _row_buckets(segments, low, per_metre, rows)
    return _strictly_inside(points, segments, start, items, low, per_metre, rows)


@njit(cache=True, error_model="numpy")
def _row(y, low, per_metre, rows):
    """The bucket of a height; it never falls where y grows, so a segment's buckets hold those of all its points."""
    return int(min(max((y - low) * per_metre, 0.0), rows - 1.0))


@njit(cache=True, error_model="numpy")
def _row_buckets(segments, low, per_metre, rows):
    """For each row the segments that touch it, as start (rows + 1,) and items."""
    start = np.zeros(rows + 1, np.int64)
    for k in range(segments.shape[0]):
        first = _row(min(segments[k, 1], segments[k, 3]), low, per_metre, rows)
        last = _row(max(segments[k, 1], segments[k, 3]), low, per_metre, rows)
        for row in range(first, last + 1):
            start[row + 1] += 1
    start = np.cumsum(start)
    items = np.zeros(start[-1], np.int64)
    fill = start.copy()
    for k in range(segments.shape[0]):
        first = _row(min(segments[k, 1], segments[k, 3]), low, per_metre, rows)
        last = _row(max(segments[k, 1], segments[k, 3]), low, per_metre, rows)
        for row in range(first, last + 1):
            items[fill[row]] = k
            fill[row] += 1
    return start, items


@njit(cache=True, error_model="numpy")
def _strictly_inside(points, segments, start, items, low, per_metre, rows):
    result = np.zeros(points.shape[0], np.bool_)
    for i in range(points.shape[0]):
        x, y = points[i, 0], points[i, 1]
        row = _row(y, low, per_metre, rows)
        odd = False
        for m in range(start[row], start[row + 1]):
            k = items[m]
            ax, ay, bx, by = segments[k, 0], segments[k, 1], segments[k, 2], segments[k, 3]
            if (ay > y and by > y) or (ay < y and by < y) or (ax < x and bx < x):
                continue
            side = orient(ax, ay, bx, by, x, y)
            if side == 0 and min(ax, bx) <= x <= max(ax, bx) and min(ay, by) <= y <= max(ay, by):
                odd = False
                break
            if (ay > y) != (by > y) and (side > 0) == (by > ay):
                odd = not odd
        result[i] = odd
    return result


def keep_points(
    points: np.ndarray,
    contours: list[np.ndarray],
    *,
    edge: float,
    threshold: float = 0.7,
    segments: np.ndarray | None = None,
) -> np.ndarray:
    """The points that are not redundant: strictly inside the contours and at least threshold * edge away from them.

    points: (n, 2) [m]; contours: sampled outline and holes (m, 2) [m]; edge: [m]; threshold: fraction of the edge.
    segments: (m, 4) a.x a.y b.x b.y [m] to keep off instead of the contours, such as these and inner lines.
    With threshold >= 1/2 and outline steps <= edge no point lies in the circle over an outline step as diameter, so
    every step becomes a mesh edge. (The paper says points within the threshold are retained; that would keep a
    crowded band along the outline and nothing else, so the sign is turned.)
    """
    kept = points[inside(points, contours)]
    if segments is None:
        segments = np.concatenate([np.hstack([c, np.roll(c, -1, axis=0)]) for c in contours])
    return kept[~distance_below(kept, segments, threshold * edge)]


def distance_below(points: np.ndarray, segments: np.ndarray, reach: float) -> np.ndarray:
    """Whether points (n, 2) lie nearer than `reach` to any segment (m, 4) a.x a.y b.x b.y. Returns (n,) bool."""
    if len(points) == 0:
        return np.zeros(0, dtype=bool)
    left, bottom, right, top = bounds(points)
    low, wide, high = np.array([left, bottom]), right - left, top - bottom
    cell = max(reach, max(wide, high) / 2048, 1e-300)
    columns, rows = int(wide // cell) + 1, int(high // cell) + 1
    start, items = _cell_buckets(points, low, cell, columns, rows)
    return _near(points, segments, reach, low, cell, columns, rows, start, items)


@njit(cache=True, error_model="numpy")
def _cell_buckets(points, low, cell, columns, rows):
    """For each cell the points in it, as start (columns * rows + 1,) and items."""
    place = np.zeros(points.shape[0], np.int64)
    start = np.zeros(columns * rows + 1, np.int64)
    for k in range(points.shape[0]):
        row = min(int((points[k, 1] - low[1]) // cell), rows - 1)
        place[k] = row * columns + min(int((points[k, 0] - low[0]) // cell), columns - 1)
        start[place[k] + 1] += 1
    for k in range(columns * rows):
        start[k + 1] += start[k]
    items, filled = np.zeros(points.shape[0], np.int64), start.copy()
    for k in range(points.shape[0]):
        items[filled[place[k]]] = k
        filled[place[k]] += 1
    return start, items


@njit(cache=True)
def _near(points, segments, reach, low, cell, columns, rows, start, items):
    near = np.zeros(points.shape[0], np.bool_)
    end = start[1:].copy()  # points found near leave their cell, so that each is found once
    for s in range(segments.shape[0]):
        ax, ay, bx, by = segments[s]
        ux, uy = bx - ax, by - ay
        square = max(ux * ux + uy * uy, 1e-300)
        first_row = max(int((min(ay, by) - reach - low[1]) // cell), 0)
        last_row = min(int((max(ay, by) + reach - low[1]) // cell), rows - 1)
        first_column = max(int((min(ax, bx) - reach - low[0]) // cell), 0)
        last_column = min(int((max(ax, bx) + reach - low[0]) // cell), columns - 1)
        for i in range(first_row, last_row + 1):
            for c in range(i * columns + first_column, i * columns + last_column + 1):
                k = start[c]
                while k < end[c]:
                    p = items[k]
                    px, py = points[p, 0] - ax, points[p, 1] - ay
                    t = min(max((px * ux + py * uy) / square, 0.0), 1.0)
                    dx, dy = px - t * ux, py - t * uy
                    if dx * dx + dy * dy < reach * reach:
                        near[p] = True
                        end[c] -= 1
                        items[k] = items[end[c]]
                    else:
                        k += 1
    return near
