"""Walls: outline steps and inner lines that are no Delaunay edges by themselves, kept in the cells they pass."""

from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.mesh.geometry.cells import Cells, cell_of
from sim_core.mesh.geometry.predicates import orient

__all__ = ["Walls", "crosses", "hidden", "wall_cells"]

RECENT = 4


class Walls(NamedTuple):
    """ends: (w, 2) int32 points.  first: (cells + 1,) and items: per cell the walls whose bounding box meets it.
    recent: (RECENT,) int32, walls that hid the last points, latest first, or -1: under a wide circle, as a triangle
    across a narrow gap has it, a few walls hide nearly everything.  spent: (1,) int64, walls tried, counted on."""

    ends: np.ndarray
    first: np.ndarray
    items: np.ndarray
    recent: np.ndarray
    spent: np.ndarray


def wall_cells(
    places: np.ndarray, ends: np.ndarray, cells: Cells, spent: np.ndarray, most: int
) -> Walls | None:
    """Sort walls (w, 2) into the grid of the points they join; None where they would fill more than `most` places."""
    ends = np.unique(np.sort(ends, axis=1), axis=0).astype(np.int32)
    first, items = _fill(places, ends, cells.grid, most)
    if first[-1] > most:
        return None
    return Walls(ends, first, items, np.full(RECENT, -1, np.int32), spent)


@njit(cache=True, error_model="numpy")
def _fill(places, ends, grid, most):
    x0, y0, per_metre, columns, rows = grid
    first = np.zeros(columns * rows + 1, np.int64)
    total = 0
    spans = np.zeros((ends.shape[0], 4), np.int32)
    for k in range(ends.shape[0]):
        p, q = ends[k, 0], ends[k, 1]
        spans[k, 0] = cell_of(min(places[p, 0], places[q, 0]), x0, per_metre, columns)
        spans[k, 1] = cell_of(max(places[p, 0], places[q, 0]), x0, per_metre, columns)
        spans[k, 2] = cell_of(min(places[p, 1], places[q, 1]), y0, per_metre, rows)
        spans[k, 3] = cell_of(max(places[p, 1], places[q, 1]), y0, per_metre, rows)
        total += (spans[k, 1] - spans[k, 0] + 1) * (spans[k, 3] - spans[k, 2] + 1)
        if total > most:
            first[-1] = total
            return first, np.zeros(0, np.int32)
        for i in range(spans[k, 2], spans[k, 3] + 1):
            for j in range(spans[k, 0], spans[k, 1] + 1):
                first[i * columns + j + 1] += 1
    for k in range(columns * rows):
        first[k + 1] += first[k]
    items = np.zeros(first[-1], np.int32)
    filled = first.copy()
    for k in range(ends.shape[0]):
        for i in range(spans[k, 2], spans[k, 3] + 1):
            for j in range(spans[k, 0], spans[k, 1] + 1):
                items[filled[i * columns + j]] = k
                filled[i * columns + j] += 1
    return first, items


@njit(cache=True, error_model="numpy")
def hidden(places, a, b, c, grid, walls):
    """Whether a wall keeps c from being joined to a or to b; those that hid the last points are tried first."""
    recent = walls.recent
    for k in range(recent.size):
        w = recent[k]
        if w < 0:
            break
        p, q = walls.ends[w, 0], walls.ends[w, 1]
        if crosses(places, a, c, p, q) or crosses(places, b, c, p, q):
            return True
    w = _wall_between(places, a, c, grid, walls)
    if w < 0:
        w = _wall_between(places, b, c, grid, walls)
    if w < 0:
        return False
    for k in range(recent.size - 1, 0, -1):
        recent[k] = recent[k - 1]
    recent[0] = w
    return True


@njit(cache=True, error_model="numpy")
def _wall_between(places, a, c, grid, walls):
    """A wall that the segment a c meets, or -1: those in the cells that it passes, row by row, and next to them."""
    x0, y0, per_metre, columns, rows = grid
    ax, ay, cx, cy = places[a, 0], places[a, 1], places[c, 0], places[c, 1]
    if ay > cy:
        ax, ay, cx, cy = cx, cy, ax, ay
    left, right = min(ax, cx), max(ax, cx)
    low, high = cell_of(ay, y0, per_metre, rows), cell_of(cy, y0, per_metre, rows)
    slope = (cx - ax) / (cy - ay) if high > low else 0.0
    beyond = 1.0 / per_metre  # a cell on every side: far more than rounding
    for i in range(low, high + 1):
        from_x, to_x = left, right
        if high > low:
            # where it enters the row below and leaves the row above
            enter = ax + slope * (y0 + (i - 1) / per_metre - ay)
            leave = ax + slope * (y0 + (i + 2) / per_metre - ay)
            from_x = max(left, min(enter, leave) - beyond)
            to_x = min(right, max(enter, leave) + beyond)
        j, j2 = cell_of(from_x, x0, per_metre, columns), cell_of(to_x, x0, per_metre, columns)
        walls.spent[0] += 1 + walls.first[i * columns + j2 + 1] - walls.first[i * columns + j]
        for k in range(walls.first[i * columns + j], walls.first[i * columns + j2 + 1]):
            w = walls.items[k]
            if crosses(places, a, c, walls.ends[w, 0], walls.ends[w, 1]):
                return w
    return -1


@njit(cache=True, error_model="numpy")
def crosses(places, a, c, p, q):
    """Whether the segment a c meets the wall p q elsewhere than at an end of both. Exact."""
    ax, ay, cx, cy = places[a, 0], places[a, 1], places[c, 0], places[c, 1]
    px, py, qx, qy = places[p, 0], places[p, 1], places[q, 0], places[q, 1]
    if max(px, qx) < min(ax, cx) or min(px, qx) > max(ax, cx):
        return False
    if max(py, qy) < min(ay, cy) or min(py, qy) > max(ay, cy):
        return False
    if p == a or p == c or q == a or q == c:
        return False
    s1, s2 = orient(ax, ay, cx, cy, px, py), orient(ax, ay, cx, cy, qx, qy)
    if (s1 > 0 and s2 > 0) or (s1 < 0 and s2 < 0):
        return False
    s3, s4 = orient(px, py, qx, qy, ax, ay), orient(px, py, qx, qy, cx, cy)
    return not ((s3 > 0 and s4 > 0) or (s3 < 0 and s4 < 0))
