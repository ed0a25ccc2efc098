"""The tree over the triangles: binned surface-area heuristic, then eight children a node, packs of eight triangles.

A node's eight boxes, and a leaf's eight triangles, lie side by side so that the compiler tests them in one go.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["Tree", "build_tree"]

WIDTH = 8  # children of a node, triangles of a pack
_BINS = 16
_STEP_COST = 1.0  # of a node, in tests of one pack
_HUGE = np.float32(1e30)


class Tree(NamedTuple):
    """What rays walk through; empty places hold boxes and triangles no ray meets.

    boxes: (N, 6, 8) float32, x y z of the low, then of the high corners of a node's children;
    child: (N, 8) int32, ≥ 0 a node, < 0 pack −1 − value; packs: (P, 9, 8) float32, corner and two edges;
    face: (P, 8) int32, −1: none; depth: nodes on the longest way down.
    """

    boxes: NDArray[np.float32]
    child: NDArray[np.int32]
    packs: NDArray[np.float32]
    face: NDArray[np.int32]
    depth: int


def build_tree(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> Tree:
    """A tree over vertices (V, 3) [m], faces (F, 3); triangles without area are left out (no ray meets them)."""
    corners = vertices[faces]
    edges = corners[:, 1:] - corners[:, :1]
    doubled = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    longest = np.maximum(np.linalg.norm(edges, axis=2).max(1), 1e-30)
    kept = np.flatnonzero(doubled > 1e-9 * longest**2)
    triangles = corners[kept].astype(np.float32)
    if not len(kept):
        child = np.full((1, WIDTH), -1, np.int32)
        return Tree(_nowhere(1), child, _no_triangles(1), np.full((1, WIDTH), -1, np.int32), 1)
    order, split = _split(triangles.min(1), triangles.max(1))
    return _widen(triangles, kept.astype(np.int32), order, split)


def _nowhere(count: int) -> NDArray[np.float32]:
    boxes = np.full((count, 6, WIDTH), _HUGE, np.float32)
    boxes[:, 3:] = -_HUGE
    return boxes


def _no_triangles(count: int) -> NDArray[np.float32]:
    return np.zeros((count, 9, WIDTH), np.float32)


@njit(cache=True, error_model="numpy")
def _area(low, high):
    a, b, c = high[0] - low[0], high[1] - low[1], high[2] - low[2]
    return a * b + b * c + c * a


@njit(cache=True, error_model="numpy")
def _bin(value, low, scale):
    return min(max(int((value - low) * scale), 0), _BINS - 1)


@njit(cache=True, error_model="numpy")
def _best_plane(order, start, stop, low, high):
    """Axis, bin and cost (areas × packs) of the cheapest of the binned planes; axis −1: all centres coincide."""
    best_axis, best_bin, best_cost = -1, 0, np.inf
    counts = np.zeros(_BINS, np.int64)
    lows, highs = np.zeros((_BINS, 3)), np.zeros((_BINS, 3))
    right = np.zeros(_BINS)
    for axis in range(3):
        first, last = np.inf, -np.inf
        for i in range(start, stop):
            middle = low[order[i], axis] + high[order[i], axis]
            first, last = min(first, middle), max(last, middle)
        if last - first < 1e-7:
            continue
        scale = _BINS / (last - first)
        counts[:] = 0
        lows[:] = np.inf
        highs[:] = -np.inf
        for i in range(start, stop):
            t = order[i]
            k = _bin(low[t, axis] + high[t, axis], first, scale)
            counts[k] += 1
            for c in range(3):
                lows[k, c] = min(lows[k, c], low[t, c])
                highs[k, c] = max(highs[k, c], high[t, c])
        total, a, b = 0, np.full(3, np.inf), np.full(3, -np.inf)
        for k in range(_BINS - 1, 0, -1):
            total += counts[k]
            a, b = np.minimum(a, lows[k]), np.maximum(b, highs[k])
            right[k] = _area(a, b) * ((total + WIDTH - 1) // WIDTH) if total else np.inf
        total, a, b = 0, np.full(3, np.inf), np.full(3, -np.inf)
        for k in range(_BINS - 1):
            total += counts[k]
            a, b = np.minimum(a, lows[k]), np.maximum(b, highs[k])
            if total and right[k + 1] < np.inf:
                cost = _area(a, b) * ((total + WIDTH - 1) // WIDTH) + right[k + 1]
                if cost < best_cost:
                    best_axis, best_bin, best_cost = axis, k, cost
    return best_axis, best_bin, best_cost


@njit(cache=True, error_model="numpy")
def _divide(order, start, stop, low, high, axis, plane):
    """Triangles up to bin `plane` first, in their order; returns where the others begin."""
    first, last = np.inf, -np.inf
    for i in range(start, stop):
        middle = low[order[i], axis] + high[order[i], axis]
        first, last = min(first, middle), max(last, middle)
    scale = _BINS / (last - first)
    left, others = start, []
    for i in range(start, stop):
        t = order[i]
        if _bin(low[t, axis] + high[t, axis], first, scale) <= plane:
            order[left] = t
            left += 1
        else:
            others.append(t)
    for k in range(len(others)):
        order[left + k] = others[k]
    return left


@njit(cache=True, error_model="numpy")
def _split(low, high):
    """order: (T,) triangles leaf by leaf; nodes: (N, 4) start, stop, left, right child (−1: a leaf) of a tree."""
    count = len(low)
    order = np.arange(count)
    nodes = np.full((2 * count, 4), -1)
    nodes[0, 0], nodes[0, 1] = 0, count
    used, todo = 1, [0]
    while len(todo) > 0:
        n = todo.pop()
        start, stop = nodes[n, 0], nodes[n, 1]
        if stop - start <= WIDTH // 2:
            continue
        axis, plane, cost = _best_plane(order, start, stop, low, high)
        a, b = np.full(3, np.inf), np.full(3, -np.inf)
        for i in range(start, stop):
            for c in range(3):
                a[c], b[c] = min(a[c], low[order[i], c]), max(b[c], high[order[i], c])
        if stop - start <= WIDTH and cost + _STEP_COST * _area(a, b) >= _area(a, b):
            continue
        middle = (start + stop) // 2 if axis < 0 else _divide(order, start, stop, low, high, axis, plane)
        nodes[n, 2], nodes[n, 3] = used, used + 1
        nodes[used, 0], nodes[used, 1] = start, middle
        nodes[used + 1, 0], nodes[used + 1, 1] = middle, stop
        todo.append(used)
        todo.append(used + 1)
        used += 2
    return order, nodes[:used]


def _bounds(triangles, order, split):
    """(N, 2, 3) box of each binary node."""
    boxes = np.zeros((len(split), 2, 3), np.float32)
    low, high = triangles.min(1)[order], triangles.max(1)[order]
    for n in range(len(split) - 1, -1, -1):
        start, stop, left, right = split[n]
        if left < 0:
            boxes[n] = low[start:stop].min(0), high[start:stop].max(0)
        else:
            boxes[n, 0] = np.minimum(boxes[left, 0], boxes[right, 0])
            boxes[n, 1] = np.maximum(boxes[left, 1], boxes[right, 1])
    return boxes


def _widen(triangles, kept, order, split) -> Tree:
    """The binary tree with up to eight children a node: the widest child is opened until the places are taken."""
    bounds = _bounds(triangles, order, split)
    # Boxes a hair larger: rounding of the ray's arithmetic must not lose a triangle at the rim.
    grown = np.maximum(np.abs(bounds).max(1), 1.0) * np.float32(4e-7)
    bounds[:, 0] -= grown
    bounds[:, 1] += grown
    size = bounds[:, 1] - bounds[:, 0]
    area = size[:, 0] * size[:, 1] + size[:, 1] * size[:, 2] + size[:, 2] * size[:, 0]
    boxes, child, packs, face = [], [], [], []
    todo, depth = [(0, -1, 0, 1)], 1
    while todo:
        top, parent, place, level = todo.pop()
        depth = max(depth, level)
        here = [top] if split[top, 2] < 0 else [int(split[top, 2]), int(split[top, 3])]
        while len(here) < WIDTH and any(split[n, 2] >= 0 for n in here):
            widest = max((n for n in here if split[n, 2] >= 0), key=lambda n: area[n])
            here.remove(widest)
            here += [int(split[widest, 2]), int(split[widest, 3])]
        number, box, links = len(boxes), _nowhere(1)[0], np.full(WIDTH, -1, np.int32)
        if parent >= 0:
            child[parent][place] = number
        for k, n in enumerate(here):
            box[:3, k], box[3:, k] = bounds[n]
            if split[n, 2] >= 0:
                todo.append((n, number, k, level + 1))
                continue
            start, stop = split[n, :2]
            links[k] = -1 - len(packs)
            pack, names = _no_triangles(1)[0], np.full(WIDTH, -1, np.int32)
            chosen = triangles[order[start:stop]]
            pack[:3, : stop - start] = chosen[:, 0].T
            pack[3:6, : stop - start] = (chosen[:, 1] - chosen[:, 0]).T
            pack[6:, : stop - start] = (chosen[:, 2] - chosen[:, 0]).T
            names[: stop - start] = kept[order[start:stop]]
            packs.append(pack)
            face.append(names)
        boxes.append(box)
        child.append(links)
    return Tree(np.array(boxes), np.array(child), np.array(packs), np.array(face), depth)
