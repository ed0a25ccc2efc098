"""Where points of a sheet at rest lie in its triangles: the face and the barycentric weights."""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["located"]

ROUNDING = 1e-9  # of a triangle's height: a point that is so little outside counts as inside


def located(rest: np.ndarray, faces: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The face (N,) and the weights (N, 3) of its corners, 0 or more and 1 in all, for points (N, 2) [m].

    rest: (V, 2) [m]; faces: (F, 3), either way round. A point outside the mesh is taken to be the nearest on it.
    """
    low = rest.min(0)
    cell = float(np.sqrt(np.prod(np.maximum(np.ptp(rest, axis=0), 1e-300)) / len(faces)))
    cell = max(cell, float(np.ptp(rest, axis=0).max()) / 4096)
    return _located(rest, np.ascontiguousarray(faces, np.int64), points, low, cell)


@njit(cache=True)
def _weights(x, y, a, b, c):
    """Barycentric weights of (x, y); not finite in a triangle without area."""
    ux, uy, vx, vy = b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]
    px, py = x - a[0], y - a[1]
    double = ux * vy - uy * vx
    if double == 0.0:
        return -np.inf, -np.inf, -np.inf
    v, w = (px * vy - py * vx) / double, (ux * py - uy * px) / double
    return 1.0 - v - w, v, w


@njit(cache=True)
def _on_segment(x, y, a, b):
    """Where between a and b the nearest place to (x, y) lies, 0 to 1, and its squared distance."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    long2 = dx * dx + dy * dy
    t = min(1.0, max(0.0, ((x - a[0]) * dx + (y - a[1]) * dy) / long2)) if long2 > 0.0 else 0.0
    return t, (x - a[0] - t * dx) ** 2 + (y - a[1] - t * dy) ** 2


@njit(cache=True)
def _nearest(x, y, rest, faces, out):
    """The face whose border is nearest to a point that lies in none; its weights go to `out`."""
    found, least = 0, np.inf
    for f in range(len(faces)):
        for k in range(3):
            t, apart = _on_segment(x, y, rest[faces[f, k]], rest[faces[f, (k + 1) % 3]])
            if apart < least:
                found, least = f, apart
                out[:] = 0.0
                out[k], out[(k + 1) % 3] = 1.0 - t, t
    return found


@njit(cache=True)
def _cells(rest, faces, low, cell, shape):
    """Faces by the cells that their boxes touch: start and face."""
    start = np.zeros(shape[0] * shape[1] + 1, np.int64)
    entry = np.zeros(0, np.int64)
    for fill in range(2):
        if fill == 1:
            start = np.cumsum(start)
            entry = np.zeros(start[-1], np.int64)
        place = start.copy()
        for f in range(len(faces)):
            x, y = rest[faces[f], 0], rest[faces[f], 1]
            for i in range(int((x.min() - low[0]) / cell), int((x.max() - low[0]) / cell) + 1):
                for j in range(int((y.min() - low[1]) / cell), int((y.max() - low[1]) / cell) + 1):
                    number = i * shape[1] + j
                    if fill == 0:
                        start[number + 1] += 1
                    else:
                        entry[place[number]] = f
                        place[number] += 1
    return start, entry


@njit(cache=True)
def _located(rest, faces, points, low, cell):
    columns = int((rest[:, 0].max() - low[0]) / cell) + 1
    rows = int((rest[:, 1].max() - low[1]) / cell) + 1
    start, entry = _cells(rest, faces, low, cell, (columns, rows))
    face, weights = np.zeros(len(points), np.int64), np.zeros((len(points), 3))
    for n in range(len(points)):
        x, y = points[n, 0], points[n, 1]
        i = min(max(int((x - low[0]) / cell), 0), columns - 1)
        j = min(max(int((y - low[1]) / cell), 0), rows - 1)
        best = -np.inf
        for m in range(start[i * rows + j], start[i * rows + j + 1]):
            f = entry[m]
            u, v, w = _weights(x, y, rest[faces[f, 0]], rest[faces[f, 1]], rest[faces[f, 2]])
            inside = min(u, min(v, w))
            if inside > best:
                best, face[n] = inside, f
                weights[n, 0], weights[n, 1], weights[n, 2] = u, v, w
        if best < -ROUNDING:
            face[n] = _nearest(x, y, rest, faces, weights[n])
        for k in range(3):
            if weights[n, k] < ROUNDING:
                weights[n, k] = 0.0
        weights[n] /= weights[n].sum()
    return face, weights
