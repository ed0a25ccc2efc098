"""The row of points next to the outline: where equilateral triangles on the outline's steps have their apex.

A lattice meets the outline at any angle and phase; the misfit then lies between fixed points, where nothing can move.
One row that follows the outline puts it between free points, and smoothing spreads it.
"""

import numpy as np
from numba import njit

from sim_core.mesh.geometry.cells import bounds

__all__ = ["apart", "layer_points"]

HEIGHT = np.sqrt(3) / 2


def layer_points(points: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """The apex over each directed step (m, 2) of points (b, 2) [m], y down, on its left in (x, -y): (m, 2) [m]."""
    a, b = points[steps[:, 0]], points[steps[:, 1]]
    along = b - a
    return (a + b) / 2 + HEIGHT * np.column_stack([along[:, 1], -along[:, 0]])


def apart(points: np.ndarray, reach: np.ndarray, first: int) -> np.ndarray:
    """Which points to keep so that none lies nearer to an earlier kept one than its own reach. Returns (n,) bool.

    points: (n, 2) [m]; reach: (n,) [m], at least a little above zero; the first `first` points stay in any case.
    """
    left, low, right, high = bounds(points)
    cell = float(reach.max())
    columns, rows = int((right - left) / cell) + 1, int((high - low) / cell) + 1
    return _apart(points, reach, first, left, low, 1.0 / cell, columns, rows)


@njit(cache=True, error_model="numpy")
def _apart(points, reach, first, x0, y0, per_metre, columns, rows):
    count = points.shape[0]
    head, later = np.full(columns * rows, -1, np.int32), np.zeros(count, np.int32)
    kept = np.ones(count, np.bool_)
    for k in range(count):
        x, y = points[k, 0], points[k, 1]
        j, i = int((x - x0) * per_metre), int((y - y0) * per_metre)
        if k >= first:
            square = reach[k] * reach[k]
            for m in range(max(i - 1, 0), min(i + 2, rows)):
                for n in range(max(j - 1, 0), min(j + 2, columns)):
                    other = head[m * columns + n]
                    while other >= 0 and kept[k]:
                        dx, dy = points[other, 0] - x, points[other, 1] - y
                        kept[k] = dx * dx + dy * dy >= square
                        other = later[other]
        if kept[k]:
            later[k] = head[i * columns + j]
            head[i * columns + j] = k
    return kept
