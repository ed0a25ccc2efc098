"""The least of size + gradation * distance over many points, and the nearest of them: boxes within boxes, so that most
are never looked at."""

from typing import NamedTuple

import numpy as np
from numba import njit
from scipy.spatial import KDTree

__all__ = ["SizeBoxes", "least_sizes", "nearest_others", "size_boxes"]

FANOUT = 8  # points in a box, boxes in a wider box


class SizeBoxes(NamedTuple):
    """Points in an order that keeps neighbours together, and a tree of boxes over them.

    points: (k, 2) [m].  sizes: (k,) [m].  boxes: (b, 5) left, low, right, high, least size [m]; level by level from
    the finest, whose boxes hold 8 points each, to the one box over all.  first: (levels + 1,) int64 into boxes.
    """

    points: np.ndarray
    sizes: np.ndarray
    boxes: np.ndarray
    first: np.ndarray


def size_boxes(points: np.ndarray, sizes: np.ndarray) -> SizeBoxes:
    """The boxes over points (k, 2) [m] with sizes (k,) [m], k > 0."""
    order = KDTree(points, leafsize=FANOUT).indices
    points, sizes = np.ascontiguousarray(points[order]), np.ascontiguousarray(sizes[order])
    level = np.column_stack([points, points, sizes])
    levels = []
    while not levels or len(level) > 1:
        begin = np.arange(0, len(level), FANOUT)
        low = np.minimum.reduceat(level, begin)
        level = np.column_stack([low[:, :2], np.maximum.reduceat(level[:, 2:4], begin), low[:, 4]])
        levels.append(level)
    first = np.cumsum([0, *(len(boxes) for boxes in levels)])
    return SizeBoxes(points, sizes, np.concatenate(levels), first.astype(np.int64))


@njit(cache=True, error_model="numpy")
def least_sizes(places, most, gradation, points, sizes, boxes, first):
    """Per place (n, 2) [m] the least of `most` and size + gradation * distance; the rest as `SizeBoxes`. (n,) [m]"""
    found = np.full(places.shape[0], most)
    levels = first.size - 1
    waiting = np.zeros((levels * FANOUT + 1, 2), np.int64)  # boxes still to be opened: level, number
    for k in range(places.shape[0]):
        x, y, best = places[k, 0], places[k, 1], most
        waiting[0, 0], waiting[0, 1] = levels - 1, 0
        top = 1
        while top > 0:
            top -= 1
            level, number = waiting[top, 0], waiting[top, 1]
            if _bound(boxes, first[level] + number, x, y, gradation) >= best:
                continue
            begin = number * FANOUT
            if level == 0:
                for m in range(begin, min(begin + FANOUT, sizes.size)):
                    dx, dy = x - points[m, 0], y - points[m, 1]
                    best = min(best, sizes[m] + gradation * np.sqrt(dx * dx + dy * dy))
                continue
            from_box = first[level - 1]
            end = min(begin + FANOUT, first[level] - from_box)
            nearest, bound = -1, np.inf  # is opened next, so that the others are seldom opened at all
            for m in range(begin, end):
                at = _bound(boxes, from_box + m, x, y, gradation)
                if at < bound:
                    nearest, bound = m, at
            for m in range(begin, end):
                if m != nearest and _bound(boxes, from_box + m, x, y, gradation) < best:
                    waiting[top, 0], waiting[top, 1] = level - 1, m
                    top += 1
            if bound < best:
                waiting[top, 0], waiting[top, 1] = level - 1, nearest
                top += 1
        found[k] = best
    return found


@njit(cache=True, error_model="numpy")
def nearest_others(places, reach, known, points, boxes, first):
    """Per place (n, 2) [m] the nearest point that is nearer than reach (n,) [m] and at none of its known places
    (n, k, 2), or -1; the rest as `SizeBoxes`. (n,) int64

    Not by scipy's KDTree: where thousands lie just outside the reach, as along a star's rings, it looks at most.
    """
    found = np.full(places.shape[0], -1)
    levels = first.size - 1
    waiting = np.zeros((levels * FANOUT + 1, 2), np.int64)
    for k in range(places.shape[0]):
        x, y, best = places[k, 0], places[k, 1], reach[k]
        waiting[0, 0], waiting[0, 1] = levels - 1, 0
        top = 1
        while top > 0:
            top -= 1
            level, number = waiting[top, 0], waiting[top, 1]
            begin = number * FANOUT
            if level > 0:
                from_box = first[level - 1]
                for m in range(begin, min(begin + FANOUT, first[level] - from_box)):
                    if _away(boxes, from_box + m, x, y) < best:
                        waiting[top, 0], waiting[top, 1] = level - 1, m
                        top += 1
                continue
            for m in range(begin, min(begin + FANOUT, points.shape[0])):
                away = np.hypot(points[m, 0] - x, points[m, 1] - y)
                if away < best and not _among(known[k], points[m]):
                    best, found[k] = away, m
    return found


@njit(cache=True, error_model="numpy")
def _among(places, point):
    for k in range(places.shape[0]):
        if places[k, 0] == point[0] and places[k, 1] == point[1]:
            return True
    return False


@njit(cache=True, error_model="numpy")
def _away(boxes, box, x, y):
    """The distance to a box; a little less, for rounding."""
    dx = max(boxes[box, 0] - x, max(x - boxes[box, 2], 0.0))
    dy = max(boxes[box, 1] - y, max(y - boxes[box, 3], 0.0))
    return np.sqrt(dx * dx + dy * dy) * (1 - 1e-14)


@njit(cache=True, error_model="numpy")
def _bound(boxes, box, x, y, gradation):
    """What no point in a box can be below; a little less, for rounding."""
    dx = max(boxes[box, 0] - x, max(x - boxes[box, 2], 0.0))
    dy = max(boxes[box, 1] - y, max(y - boxes[box, 3], 0.0))
    return (boxes[box, 4] + gradation * np.sqrt(dx * dx + dy * dy)) * (1 - 1e-14)
