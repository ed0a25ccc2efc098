"""A surface that is asked again and again: how far it is from points, and where on it they are nearest."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from sim_core.metrics.face_tree import DEEPEST, FaceTree, _box2, face_tree, nearest_face

__all__ = ["Surface"]


class Surface:
    """A mesh, vertices (V, 3) [m] and faces (F, 3), sorted once."""

    def __init__(self, vertices: np.ndarray, faces: np.ndarray) -> None:
        self._tree: FaceTree = face_tree(
            np.ascontiguousarray(vertices, float), np.ascontiguousarray(faces, np.int32)
        )

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Exact unsigned distance (N,) [m] of points (N, 3)."""
        return nearest_face(np.ascontiguousarray(points, float), self._tree, np.inf)

    def places(self, points: np.ndarray, facing: np.ndarray, limit: float) -> tuple[np.ndarray, np.ndarray]:
        """Where points (N, 3) are nearest: the face (N,) and the weights (N, 3) of its corners.

        facing: (N, 3); within `limit` [m] only faces that look its way count, so that the other side of thin cloth is
        not taken for this one; where there is none, the nearest of all is.
        """
        points, facing = np.ascontiguousarray(points, float), np.ascontiguousarray(facing, float)
        face, weights = nearest_place(points, facing, self._tree, float(limit))
        return self._tree.face[face], weights


@njit(cache=True, error_model="numpy")
def _weights(x, y, z, corners, f, out):
    """Weights of the corners at the point of the face f that is nearest (Ericson 2005, 5.1.5)."""
    ax, ay, az = corners[f, 0], corners[f, 1], corners[f, 2]
    ux, uy, uz = corners[f, 3] - ax, corners[f, 4] - ay, corners[f, 5] - az
    vx, vy, vz = corners[f, 6] - ax, corners[f, 7] - ay, corners[f, 8] - az
    px, py, pz = x - ax, y - ay, z - az
    d1, d2 = ux * px + uy * py + uz * pz, vx * px + vy * py + vz * pz
    uu, uv, vv = ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz, vx * vx + vy * vy + vz * vz
    d3, d4, d5, d6 = d1 - uu, d2 - uv, d1 - uv, d2 - vv
    a, b, c = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    s = t = 0.0
    if d1 <= 0.0 and d2 <= 0.0:
        s, t = 0.0, 0.0
    elif d3 >= 0.0 and d4 <= d3:
        s, t = 1.0, 0.0
    elif d6 >= 0.0 and d5 <= d6:
        s, t = 0.0, 1.0
    elif c <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        s, t = d1 / (d1 - d3), 0.0
    elif b <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        s, t = 0.0, d2 / (d2 - d6)
    elif a <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        t = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        s = 1.0 - t
    else:
        whole = a + b + c
        s, t = b / whole, c / whole
    out[0], out[1], out[2] = 1.0 - s - t, s, t
    dx, dy, dz = px - s * ux - t * vx, py - s * uy - t * vy, pz - s * uz - t * vz
    return dx * dx + dy * dy + dz * dz


@njit(cache=True, error_model="numpy")
def _looks_away(facing, i, corners, f):
    ux, uy, uz = corners[f, 3] - corners[f, 0], corners[f, 4] - corners[f, 1], corners[f, 5] - corners[f, 2]
    vx, vy, vz = corners[f, 6] - corners[f, 0], corners[f, 7] - corners[f, 1], corners[f, 8] - corners[f, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    return nx * facing[i, 0] + ny * facing[i, 1] + nz * facing[i, 2] < 0.0


@njit(cache=True, error_model="numpy")
def _nearest(i, x, y, z, facing, tree, best, turned, waits, gap, weight, out):
    """The nearest face nearer than `best` (squared), or -1; turned: those that look away count, too."""
    corners, start, box = tree.corners, tree.start, tree.box
    leaves, found = len(start) - 1, -1
    waits[0], gap[0], left = 1, _box2(x, y, z, box, 1), 1
    while left > 0:
        left -= 1
        n = waits[left]
        if gap[left] >= best:
            continue
        if n >= leaves:
            for f in range(start[n - leaves], start[n - leaves + 1]):
                there = _weights(x, y, z, corners, f, weight)
                if there < best and (turned or not _looks_away(facing, i, corners, f)):
                    best, found = there, f
                    out[0], out[1], out[2] = weight[0], weight[1], weight[2]
            continue
        first, second = _box2(x, y, z, box, 2 * n), _box2(x, y, z, box, 2 * n + 1)
        near = 2 * n if first <= second else 2 * n + 1
        waits[left], gap[left] = 4 * n + 1 - near, max(first, second)
        waits[left + 1], gap[left + 1] = near, min(first, second)
        left += 2
    return found


@njit(cache=True, error_model="numpy")
def nearest_place(points, facing, tree, limit):
    """Face in the tree's order (N,) and weights (N, 3) of the nearest places, as `Surface.places` has them."""
    face, weights = np.zeros(len(points), np.int64), np.zeros((len(points), 3))
    waits, gap, weight = np.zeros(DEEPEST, np.int64), np.zeros(DEEPEST), np.zeros(3)
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        found = _nearest(i, x, y, z, facing, tree, limit * limit, False, waits, gap, weight, weights[i])
        if found < 0:
            found = _nearest(i, x, y, z, facing, tree, math.inf, True, waits, gap, weight, weights[i])
        face[i] = max(found, 0)
    return face, weights
