"""The nearest face of a mesh, and what passes through it: a tree of boxes over its faces in the order of a curve."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.metrics.triangles import squared_gap

__all__ = ["FaceTree", "crossings_with", "face_tree", "nearest_face"]

LEAF = 4  # faces of a leaf, at most
BITS = 20  # of the curve each way
DEEPEST = 64  # boxes that wait to be looked into


class FaceTree(NamedTuple):
    """F faces in L leaves, a power of two; the boxes 2 n and 2 n + 1 lie in the box n, and 1 holds all."""

    corners: np.ndarray  # (F, 9) [m] of each face, in the order of the curve (Morton 1966)
    face: np.ndarray  # (F,) int64 which face of the mesh that is
    start: np.ndarray  # (L + 1,) int64 the faces of each leaf
    box: np.ndarray  # (2 L, 6) lowest and highest corner


def face_tree(vertices: np.ndarray, faces: np.ndarray) -> FaceTree:
    """The tree of a mesh, vertices (V, 3) [m] and faces (F, 3), F > 0."""
    corner = vertices[faces]
    centre = corner.mean(1)
    low = centre.min(0)
    cell = (centre - low) * ((2**BITS - 1) / max(float(np.ptp(centre, axis=0).max()), 1e-300))
    order = np.argsort(_curve(cell.astype(np.int64)), kind="stable")
    corner = corner[order]
    leaves = 1
    while leaves * LEAF < len(faces):
        leaves *= 2
    start = np.arange(leaves + 1) * len(faces) // leaves
    box = np.tile([np.inf] * 3 + [-np.inf] * 3, (2 * leaves, 1))
    leaf = np.repeat(np.arange(leaves), np.diff(start)) + leaves
    np.minimum.at(box[:, :3], leaf, corner.min(1))
    np.maximum.at(box[:, 3:], leaf, corner.max(1))
    level = leaves
    while level > 1:
        pairs, level = box[level : 2 * level].reshape(-1, 2, 6), level // 2
        box[level : 2 * level, :3], box[level : 2 * level, 3:] = (
            pairs[:, :, :3].min(1),
            pairs[:, :, 3:].max(1),
        )
    return FaceTree(np.ascontiguousarray(corner.reshape(-1, 9)), order, start, box)


def _curve(cell: np.ndarray) -> np.ndarray:
    """Where cells (N, 3) of BITS bits each lie along the curve (N,): their bits in turn."""
    place = np.zeros(len(cell), np.int64)
    for bit in range(BITS):
        for axis in range(3):
            place |= ((cell[:, axis] >> bit) & 1) << (3 * bit + axis)
    return place


@njit(error_model="numpy", inline="always")
def _gap2(x, y, z, corners, f):
    """Squared distance of a point to the face f."""
    return squared_gap(
        (x, y, z),
        (corners[f, 0], corners[f, 1], corners[f, 2]),
        (corners[f, 3], corners[f, 4], corners[f, 5]),
        (corners[f, 6], corners[f, 7], corners[f, 8]),
    )


@njit(error_model="numpy", inline="always")
def _box2(x, y, z, box, n):
    """Squared distance of a point to a box."""
    dx = max(box[n, 0] - x, x - box[n, 3], 0.0)
    dy = max(box[n, 1] - y, y - box[n, 4], 0.0)
    dz = max(box[n, 2] - z, z - box[n, 5], 0.0)
    return dx * dx + dy * dy + dz * dz


@njit(cache=True, error_model="numpy")
def nearest_face(points, tree, limit):
    """Distance (N,) [m] of points (N, 3) to the nearest face of a `FaceTree`; `limit` where it is further."""
    corners, start, box = tree.corners, tree.start, tree.box
    leaves, out = len(start) - 1, np.zeros(len(points))
    waits, gap, found = np.zeros(DEEPEST, np.int64), np.zeros(DEEPEST), 0
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        best = min(limit * limit, _gap2(x, y, z, corners, found))  # of neighbours the face is often the same
        waits[0], gap[0], left = 1, _box2(x, y, z, box, 1), 1
        while left > 0:
            left -= 1
            n = waits[left]
            if gap[left] >= best:
                continue
            if n >= leaves:
                for f in range(start[n - leaves], start[n - leaves + 1]):
                    there = _gap2(x, y, z, corners, f)
                    if there < best:
                        best, found = there, f
                continue
            first, second = _box2(x, y, z, box, 2 * n), _box2(x, y, z, box, 2 * n + 1)
            near = 2 * n if first <= second else 2 * n + 1
            waits[left], gap[left] = (
                4 * n + 1 - near,
                max(first, second),
            )  # the nearer one is looked into first
            waits[left + 1], gap[left + 1] = near, min(first, second)
            left += 2
        out[i] = math.sqrt(best)
    return out


@njit(cache=True, error_model="numpy")
def _crosses(p, q, a, b, c):
    """Does the segment p q pass through the triangle a b c (shared points excluded by the caller)?"""
    n = np.cross(b - a, c - a)
    dp, dq = (p - a) @ n, (q - a) @ n
    if dp * dq >= 0.0:
        return False
    x = p + (q - p) * (dp / (dp - dq))
    inside = np.cross(b - a, x - a) @ n >= 0.0 and np.cross(c - b, x - b) @ n >= 0.0
    return inside and np.cross(a - c, x - c) @ n >= 0.0


@njit(error_model="numpy", inline="always")
def _overlap(box, n, low, high):
    return (
        box[n, 0] <= high[0]
        and box[n, 3] >= low[0]
        and box[n, 1] <= high[1]
        and box[n, 4] >= low[1]
        and box[n, 2] <= high[2]
        and box[n, 5] >= low[2]
    )


@njit(cache=True, error_model="numpy")
def crossings_with(vertices, edges, faces, tree):
    """How often one of the edges (E, 2) passes through one of the tree's faces (F, 3) and shares no vertex with it."""
    leaves, count, waits = len(tree.start) - 1, 0, np.zeros(DEEPEST, np.int64)
    for e in range(len(edges)):
        i, j = edges[e]
        low, high = np.minimum(vertices[i], vertices[j]), np.maximum(vertices[i], vertices[j])
        waits[0], left = 1, 1
        while left > 0:
            left -= 1
            n = waits[left]
            if not _overlap(tree.box, n, low, high):
                continue
            if n < leaves:
                waits[left], waits[left + 1] = 2 * n, 2 * n + 1
                left += 2
                continue
            for s in range(tree.start[n - leaves], tree.start[n - leaves + 1]):
                a, b, c = faces[tree.face[s]]
                if i == a or i == b or i == c or j == a or j == b or j == c:
                    continue
                if _crosses(vertices[i], vertices[j], vertices[a], vertices[b], vertices[c]):
                    count += 1
    return count
