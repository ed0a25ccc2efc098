"""Where segments meet that should not: of the contours that are given, and of their samples. Exact."""

import numpy as np
from numba import njit

from sim_core.mesh.exact import orient

__all__ = ["crossed_steps", "first_crossing"]


@njit(cache=True)
def first_crossing(points, following, order):
    """Two segments that meet elsewhere than at the point they share, or (-1, -1). Sweep over the left ends."""
    for s in range(order.size):
        i = order[s]
        i2 = following[i]
        right = max(points[i, 0], points[i2, 0])
        low, high = min(points[i, 1], points[i2, 1]), max(points[i, 1], points[i2, 1])
        for t in range(s + 1, order.size):
            j = order[t]
            j2 = following[j]
            if min(points[j, 0], points[j2, 0]) > right:
                break
            if min(points[j, 1], points[j2, 1]) > high or max(points[j, 1], points[j2, 1]) < low:
                continue
            if i2 == j:
                meet = _folds_back(points, i, i2, j2)
            elif j2 == i:
                meet = _folds_back(points, j, i, i2)
            else:
                meet = _meet(points, i, i2, j, j2)
            if meet:
                return i, j
    return -1, -1


def crossed_steps(lines: list[np.ndarray]) -> list[np.ndarray]:
    """Per step of open or closed lines (n, 2) [m] whether it meets a step it shares no end with. (n - 1,) bool each."""
    a, b = (np.concatenate([line[k : len(line) - 1 + k] for line in lines]) for k in (0, 1))
    order = np.argsort(np.minimum(a[:, 0], b[:, 0]), kind="stable")
    crossed = _crossed(np.concatenate([a, b]), order)
    return np.split(crossed, np.cumsum([len(line) - 1 for line in lines])[:-1])


@njit(cache=True)
def _crossed(points, order):
    """Segments k -> k + n of points (2 n, 2) that meet another without a common end. Sweep over the left ends."""
    n = order.size
    crossed = np.zeros(n, np.bool_)
    for s in range(n):
        i = order[s]
        right = max(points[i, 0], points[i + n, 0])
        low, high = min(points[i, 1], points[i + n, 1]), max(points[i, 1], points[i + n, 1])
        for t in range(s + 1, n):
            j = order[t]
            if min(points[j, 0], points[j + n, 0]) > right:
                break
            if min(points[j, 1], points[j + n, 1]) > high or max(points[j, 1], points[j + n, 1]) < low:
                continue
            common = False
            for p in (i, i + n):
                for q in (j, j + n):
                    common |= points[p, 0] == points[q, 0] and points[p, 1] == points[q, 1]
            if not common and _meet(points, i, i + n, j, j + n):
                crossed[i] = crossed[j] = True
    return crossed


@njit(cache=True)
def _folds_back(points, a, b, c):
    """Whether b -> c runs back along a -> b."""
    if orient(points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1]) != 0:
        return False
    ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    vx, vy = points[c, 0] - points[b, 0], points[c, 1] - points[b, 1]
    return ux * vx + uy * vy < 0


@njit(cache=True)
def _meet(points, a, b, c, d):
    """Whether the closed segments a b and c d, whose bounding boxes overlap, have a common point. Exact."""
    ax, ay, bx, by = points[a, 0], points[a, 1], points[b, 0], points[b, 1]
    cx, cy, dx, dy = points[c, 0], points[c, 1], points[d, 0], points[d, 1]
    s1, s2 = orient(ax, ay, bx, by, cx, cy), orient(ax, ay, bx, by, dx, dy)
    s3, s4 = orient(cx, cy, dx, dy, ax, ay), orient(cx, cy, dx, dy, bx, by)
    return not ((s1 > 0 and s2 > 0) or (s1 < 0 and s2 < 0) or (s3 > 0 and s4 > 0) or (s3 < 0 and s4 < 0))
