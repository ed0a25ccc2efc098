"""Compiled geometry of points and triangles behind `metrics`: distance, winding number, crossings of a ray."""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["crossings", "squared_gap", "winding"]


@njit(cache=True, error_model="numpy")
def _segment2(x, y, z, q, r):
    """Squared distance of (x, y, z) to the segment q r."""
    sx, sy, sz = r[0] - q[0], r[1] - q[1], r[2] - q[2]
    px, py, pz = x - q[0], y - q[1], z - q[2]
    long2 = sx * sx + sy * sy + sz * sz
    t = min(1.0, max(0.0, (px * sx + py * sy + pz * sz) / long2)) if long2 > 0.0 else 0.0
    return (px - t * sx) ** 2 + (py - t * sy) ** 2 + (pz - t * sz) ** 2


@njit(cache=True, error_model="numpy")
def _side(x, y, z, q, r, nx, ny, nz):
    """On which side of q r, seen along n, lies the point?"""
    ux, uy, uz = r[0] - q[0], r[1] - q[1], r[2] - q[2]
    px, py, pz = x - q[0], y - q[1], z - q[2]
    return (uy * pz - uz * py) * nx + (uz * px - ux * pz) * ny + (ux * py - uy * px) * nz


@njit(cache=True, error_model="numpy")
def squared_gap(p, a, b, c):
    """Squared distance of p to triangle a b c: its plane where the foot is inside, else the nearest side."""
    x, y, z = p[0], p[1], p[2]
    ux, uy, uz, vx, vy, vz = b[0] - a[0], b[1] - a[1], b[2] - a[2], c[0] - a[0], c[1] - a[1], c[2] - a[2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    size2 = nx * nx + ny * ny + nz * nz
    if size2 > 0.0 and _side(x, y, z, a, b, nx, ny, nz) >= 0.0:
        if _side(x, y, z, b, c, nx, ny, nz) >= 0.0 and _side(x, y, z, c, a, nx, ny, nz) >= 0.0:
            return ((x - a[0]) * nx + (y - a[1]) * ny + (z - a[2]) * nz) ** 2 / size2
    return min(_segment2(x, y, z, a, b), _segment2(x, y, z, b, c), _segment2(x, y, z, c, a))


@njit(cache=True, error_model="numpy")
def winding(points, vertices, faces):
    """Generalised winding number (N,): solid angle of all faces over 4 pi (van Oosterom and Strackee 1983)."""
    out = np.zeros(len(points))
    for i in range(len(points)):
        total = 0.0
        for f in range(len(faces)):
            a = vertices[faces[f, 0]] - points[i]
            b = vertices[faces[f, 1]] - points[i]
            c = vertices[faces[f, 2]] - points[i]
            la, lb, lc = np.sqrt(a @ a), np.sqrt(b @ b), np.sqrt(c @ c)
            above = a @ np.cross(b, c)
            below = la * lb * lc + (a @ b) * lc + (b @ c) * la + (c @ a) * lb
            total += 2.0 * np.arctan2(above, below)
        out[i] = total / (4.0 * np.pi)
    return out


@njit(cache=True, error_model="numpy")
def crossings(points, vertices, faces, cell):
    """Signed crossings (N,) of the rays from points along +x with closed meshes: how often each point is inside.

    Faces lie in columns of `cell` [m] in y and z. Rays start 1e-7 cells aside, so that none meets an edge exactly.
    """
    low_y, low_z = vertices[:, 1].min(), vertices[:, 2].min()
    rows, columns = (
        int((vertices[:, 1].max() - low_y) / cell) + 1,
        int((vertices[:, 2].max() - low_z) / cell) + 1,
    )
    start = np.zeros(rows * columns + 1, np.int64)
    entry = np.zeros(0, np.int64)
    for fill in range(2):
        if fill == 1:
            start[:] = np.cumsum(start)
            entry = np.zeros(start[-1], np.int64)
            place = start.copy()
        for f in range(len(faces)):
            y, z = vertices[faces[f], 1], vertices[faces[f], 2]
            for i in range(int((y.min() - low_y) / cell), int((y.max() - low_y) / cell) + 1):
                for j in range(int((z.min() - low_z) / cell), int((z.max() - low_z) / cell) + 1):
                    if fill == 0:
                        start[i * columns + j + 1] += 1
                    else:
                        entry[place[i * columns + j]] = f
                        place[i * columns + j] += 1
    out = np.zeros(len(points), np.int64)
    for n in range(len(points)):
        x, y, z = points[n, 0], points[n, 1] + 0.6180339e-7 * cell, points[n, 2] + 0.4142136e-7 * cell
        i, j = int(np.floor((y - low_y) / cell)), int(np.floor((z - low_z) / cell))
        if i < 0 or j < 0 or i >= rows or j >= columns:
            continue
        for k in range(start[i * columns + j], start[i * columns + j + 1]):
            a, b, c = faces[entry[k]]
            ay, az = vertices[a, 1] - y, vertices[a, 2] - z
            by, bz = vertices[b, 1] - y, vertices[b, 2] - z
            cy, cz = vertices[c, 1] - y, vertices[c, 2] - z
            u, v, w = by * cz - bz * cy, cy * az - cz * ay, ay * bz - az * by
            total = u + v + w
            if total == 0.0 or min(u, v, w) * max(u, v, w) < 0.0:
                continue
            if (u * vertices[a, 0] + v * vertices[b, 0] + w * vertices[c, 0]) / total > x:
                out[n] += 1 if total > 0.0 else -1
    return out
