"""The growth method as the paper prints it: every edge searches all points for the least cosine. O(n^2).

Kept as the oracle of the tests and the base line of the bench; nothing else uses it.
"""

import numpy as np
from numba import njit

from sim_core.mesh.geometry import orient

__all__ = ["grow_naive"]

TIE = 1e-9


def grow_naive(points: np.ndarray, edges: np.ndarray | None = None) -> np.ndarray:
    """Triangulate points (n, 2) [m], y down, no two equal. Returns faces (F, 3) int32 with positive area in (x, -y).

    edges: (m, 2) int, oriented outline steps to start from, each of them a Delaunay edge (this form knows no walls);
    None starts from the first point and its nearest neighbour, as the paper does, and grows to the convex hull.
    """
    turned = np.ascontiguousarray(points * (1.0, -1.0))
    seeds = _first_edge(turned) if edges is None else np.asarray(edges, dtype=np.int64)
    count, faces = _grow(turned, seeds, edges is not None)
    return faces[:count].astype(np.int32)


def _first_edge(points: np.ndarray) -> np.ndarray:
    square = ((points - points[0]) ** 2).sum(axis=1)
    square[0] = np.inf
    nearest = int(square.argmin())
    return np.array([[0, nearest], [nearest, 0]])


@njit(cache=True)
def _grow(points, seeds, closed):
    faces = np.zeros((2 * points.shape[0] + 8, 3), np.int64)
    front = [(k, k) for k in range(0)]
    done = set(front)
    for k in range(seeds.shape[0] - 1, -1, -1):
        front.append((seeds[k, 0], seeds[k, 1]))
        if closed:  # nothing grows outward from the outline
            done.add((seeds[k, 1], seeds[k, 0]))
    count = 0
    while len(front) > 0:
        a, b = front.pop()
        if (a, b) in done:
            continue
        c = _least_cosine(points, a, b)
        if c < 0:
            continue
        if count == faces.shape[0]:
            return count, faces
        faces[count, 0], faces[count, 1], faces[count, 2] = a, b, c
        count += 1
        done.add((a, b))
        done.add((b, c))
        done.add((c, a))
        if (c, b) not in done:
            front.append((c, b))
        if (a, c) not in done:
            front.append((a, c))
    return count, faces


@njit(cache=True)
def _square(points, i, j):
    return (points[i, 0] - points[j, 0]) ** 2 + (points[i, 1] - points[j, 1]) ** 2


@njit(cache=True)
def _least_cosine(points, a, b):
    """Eq. 9 over all points left of a -> b; equal cosines go by the fan rule."""
    ax, ay, bx, by = points[a, 0], points[a, 1], points[b, 0], points[b, 1]
    base = _square(points, a, b)
    least, lowest, near_a, near_b = 9.0, -1, -1, -1
    for c in range(points.shape[0]):
        cx, cy = points[c, 0], points[c, 1]
        if c == a or c == b or orient(ax, ay, bx, by, cx, cy) <= 1e-12 * base:
            continue
        ac, bc = _square(points, a, c), _square(points, b, c)
        cosine = (ac + bc - base) / np.sqrt(ac * bc)
        if cosine < least - TIE:
            least, lowest, near_a, near_b = cosine, c, c, c
        elif cosine <= least + TIE:
            lowest = min(lowest, c)
            if ac * _square(points, b, near_a) > bc * _square(points, a, near_a):
                near_a = c
            if bc * _square(points, a, near_b) > ac * _square(points, b, near_b):
                near_b = c
    if lowest < 0 or lowest < min(a, b):
        return lowest
    return near_a if a < b else near_b
