"""Contact with solids: vertices, edge midpoints and centroids stay outside, with Coulomb friction.

A vertex nearer than the clearance r is moved back along the gradient n by its depth; its approach is taken
away and the tangential velocity loses mu * depth / dt, which for a resting vertex is exactly mu g dt.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from sim_core.cloth.distance import signed_distance


@njit(cache=True, error_model="numpy")
def near_samples(packed, x, samples, reach, near):
    """Those of the samples (S, 3) int32 that are nearer than `reach` [m]: (i, j, i) midpoint, (i, i, i) vertex.

    near: (S, 3) int32, room for them; the answer is its front part.
    """
    count = 0
    for s in range(len(samples)):
        i, j, k = samples[s, 0], samples[s, 1], samples[s, 2]
        w = 0.0 if i == k else 1.0 / 3.0  # a midpoint is (i, j, i): see collide_samples
        u = 0.5 * (1.0 - w)
        px = u * (x[i, 0] + x[j, 0]) + w * x[k, 0]
        py = u * (x[i, 1] + x[j, 1]) + w * x[k, 1]
        pz = u * (x[i, 2] + x[j, 2]) + w * x[k, 2]
        if signed_distance(packed, px, py, pz)[0] < reach:
            near[count, 0], near[count, 1], near[count, 2] = i, j, k
            count += 1
    return near[:count]


@njit(cache=True, error_model="numpy")
def _resolve(x, v, i, n, depth, speed, dt, friction, cap):
    """Pushes vertex i out along n = (nx, ny, nz), at least as fast as the surface moves, and applies friction."""
    push = min(depth, cap)
    vn = v[i, 0] * n[0] + v[i, 1] * n[1] + v[i, 2] * n[2]
    tx, ty, tz = v[i, 0] - vn * n[0], v[i, 1] - vn * n[1], v[i, 2] - vn * n[2]
    slide = math.sqrt(tx * tx + ty * ty + tz * tz)
    lost = 0.0
    if slide > 0.0:
        lost = min(1.0, friction * push / (dt * slide))
    vn = max(vn, speed)
    for c in range(3):
        t = tx if c == 0 else (ty if c == 1 else tz)
        x[i, c] += push * n[c] - lost * t * dt
        v[i, c] = vn * n[c] + (1.0 - lost) * t


@njit(cache=True, error_model="numpy")
def collide_vertices(packed, inverse_mass, x, v, near, clearance, dt, friction, cap):
    """Resolves the vertices near[:, 0]; returns the deepest depth seen [m]."""
    deepest = 0.0
    for s in range(len(near)):
        i = near[s, 0]
        if inverse_mass[i] == 0.0:
            continue
        d, nx, ny, nz, speed = signed_distance(packed, x[i, 0], x[i, 1], x[i, 2])
        depth = clearance - d
        if depth > 0.0 and nx * nx + ny * ny + nz * nz > 0.5:
            deepest = max(deepest, depth)
            _resolve(x, v, i, (nx, ny, nz), depth, speed, dt, friction, cap)
    return deepest


@njit(cache=True, error_model="numpy")
def collide_samples(packed, inverse_mass, x, v, near, clearance, cap):
    """Keeps midpoints (i, j, j') and centroids outside by moving their vertices; no friction here.

    A midpoint is stored as (i, j, i) and means weights 1/2, 1/2; a centroid as (i, j, k).
    """
    for s in range(len(near)):
        i, j, k = near[s]
        pair = i == k
        w = 0.5 if pair else 1.0 / 3.0
        count = 2 if pair else 3
        px = w * (x[i, 0] + x[j, 0]) + (0.0 if pair else w * x[k, 0])
        py = w * (x[i, 1] + x[j, 1]) + (0.0 if pair else w * x[k, 1])
        pz = w * (x[i, 2] + x[j, 2]) + (0.0 if pair else w * x[k, 2])
        d, nx, ny, nz, _ = signed_distance(packed, px, py, pz)
        if d >= clearance or nx * nx + ny * ny + nz * nz < 0.5:
            continue
        push = min(clearance - d, cap) / (w * w * count)
        vn = 0.0
        for a in range(count):
            u = near[s, a]
            vn += w * (v[u, 0] * nx + v[u, 1] * ny + v[u, 2] * nz)
        gain = max(-vn, 0.0) / (w * w * count)
        for a in range(count):
            u = near[s, a]
            if inverse_mass[u] > 0.0:
                x[u, 0] += w * push * nx
                x[u, 1] += w * push * ny
                x[u, 2] += w * push * nz
                v[u, 0] += w * gain * nx
                v[u, 1] += w * gain * ny
                v[u, 2] += w * gain * nz


def contact_samples(edges: np.ndarray, faces: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Index triples of the vertices (V, 3) and of the edge midpoints and centroids (E + F, 3), int32."""
    vertices = np.repeat(np.arange(count, dtype=np.int32)[:, None], 3, axis=1)
    middles = np.concatenate([edges[:, [0, 1, 0]], faces]).astype(np.int32)
    return vertices, middles
