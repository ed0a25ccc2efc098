"""Points in the cells of a square grid: the order in which growth keeps and searches them."""

from typing import NamedTuple

import numpy as np
from numba import njit

__all__ = ["Cells", "Grid", "bounds", "cell_of", "point_cells"]

PER_CELL = 1.0  # points on average; one search meets about six cells


class Grid(NamedTuple):
    """Square cells. x0, y0: their lower corner.  per_metre: cells a metre.  columns, rows: how many there are."""

    x0: float
    y0: float
    per_metre: float
    columns: int
    rows: int


class Cells(NamedTuple):
    """A grid over points in growth order. start: (columns * rows + 1,) int32, first point of each cell, row by row."""

    start: np.ndarray
    grid: Grid


@njit(cache=True, error_model="numpy")
def cell_of(value, low, per_metre, count):
    """The column (or row) of a coordinate. Never falls where the coordinate grows: an interval's cells hold it all."""
    return int(min(max((value - low) * per_metre, 0.0), count - 1.0))


@njit(cache=True, error_model="numpy")
def bounds(points):
    """Least and greatest coordinates (left, low, right, high) of points (n, 2), n > 0, sooner than numpy has them."""
    left, low = points[0, 0], points[0, 1]
    right, high = left, low
    for k in range(1, points.shape[0]):
        x, y = points[k, 0], points[k, 1]
        left, right = min(left, x), max(right, x)
        low, high = min(low, y), max(high, y)
    return left, low, right, high


def point_cells(points: np.ndarray) -> tuple[np.ndarray, Cells]:
    """Sort points (n, 2) float64 into cells; returns order (n,) int32 and the cells over points[order].

    Within a cell points go by (y, x), so the order follows from the places alone; equal points become neighbours.
    """
    left, low, right, top = bounds(points)
    wide, high = right - left, top - low
    longest = max(wide, high)
    if longest == 0.0:
        wide = high = longest = 1.0
    count = len(points)
    cell = max(np.sqrt(PER_CELL * wide * high / count), PER_CELL * longest / count)
    columns, rows = int(wide / cell) + 1, int(high / cell) + 1
    grid = Grid(left, low, 1.0 / float(cell), columns, rows)
    order, start = _sorted(points, grid)
    return order, Cells(start, grid)


@njit(cache=True, error_model="numpy")
def _sorted(points, grid):
    """Counting sort by cell, then by (y, x) within each: short cells by insertion, long ones as heaps."""
    x0, y0, per_metre, columns, rows = grid
    count = points.shape[0]
    start = np.zeros(columns * rows + 1, np.int32)
    place = np.zeros(count, np.int32)
    for k in range(count):
        row = cell_of(points[k, 1], y0, per_metre, rows)
        place[k] = row * columns + cell_of(points[k, 0], x0, per_metre, columns)
        start[place[k] + 1] += 1
    for k in range(columns * rows):
        start[k + 1] += start[k]
    order = np.zeros(count, np.int32)
    for k in range(count - 1, -1, -1):
        c = place[k] + 1
        start[c] -= 1
        order[start[c]] = k
    # Counting down left in start[c] the first place of cell c - 1: shift back by one.
    for k in range(columns * rows):
        start[k] = start[k + 1]
    start[columns * rows] = count
    for c in range(columns * rows):
        first, last = start[c], start[c + 1]
        if last - first > 40:
            _sort_long(points, order, first, last)
            continue
        for i in range(first + 1, last):
            k, j = order[i], i
            while j > first and _before(points, k, order[j - 1]):
                order[j] = order[j - 1]
                j -= 1
            order[j] = k
    return order, start


@njit(cache=True, error_model="numpy")
def _before(points, i, j):
    if points[i, 1] != points[j, 1]:
        return points[i, 1] < points[j, 1]
    if points[i, 0] != points[j, 0]:
        return points[i, 0] < points[j, 0]
    return i < j


@njit(cache=True, error_model="numpy")
def _sort_long(points, order, first, last):
    """Heap-sort of one crowded cell by (y, x, index). numpy's sorts take ten seconds to compile."""
    count = last - first
    for unsifted in range(count // 2 - 1, -1, -1):
        _sift(points, order, first, unsifted, count)
    for left in range(count - 1, 0, -1):
        order[first], order[first + left] = order[first + left], order[first]
        _sift(points, order, first, 0, left)


@njit(cache=True, error_model="numpy")
def _sift(points, order, first, root, count):
    """Sink `root` among the first `count` of the heap that begins at `first`, the last point on top."""
    while 2 * root + 1 < count:
        child = 2 * root + 1
        if child + 1 < count and _before(points, order[first + child], order[first + child + 1]):
            child += 1
        if not _before(points, order[first + root], order[first + child]):
            return
        order[first + root], order[first + child] = order[first + child], order[first + root]
        root = child
