"""Contact with solids: vertices, edge midpoints and centroids stay outside, with Coulomb friction.

A vertex nearer than the clearance r is moved back along the gradient n by its depth; its approach is taken
away and the tangential velocity, seen from the surface, loses mu * depth / dt, which for a resting vertex is
exactly mu g dt.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.cloth.contact.distance import carried, fields_of, signed_distance
from sim_core.cloth.contact.packed import FASTEST, MOVING
from sim_core.cloth.contact.sleep import SOON, asleep

SETTLE = 6  # more looks at samples inside, at the end of a frame


class Push(NamedTuple):
    """How samples are brought out of a solid in a step."""

    clearance: float  # [m] that they keep
    cap: float  # [m] the largest push
    friction: float  # of vertices; midpoints and centroids have none
    dt: float  # [s]


class Watch(NamedTuple):
    """Samples (S, 3) int32 and the steps (S,) int32 until which they sleep: as long as they cannot arrive.

    A vertex is stored as (i, i, i), a midpoint as (i, j, i) with weights 1/2, 1/2, a centroid as (i, j, k).
    """

    samples: np.ndarray
    wake: np.ndarray


@njit(cache=True, error_model="numpy")
def _resolve(x, v, i, n, depth, speed, carry, push):
    """Pushes vertex i out along n = (nx, ny, nz), at least as fast as the surface moves, and applies friction.

    carry: the surface's velocity, (x, y, z), of which what lies in the surface takes the vertex along.
    """
    way, dt = min(depth, push.cap), push.dt
    vn = v[i, 0] * n[0] + v[i, 1] * n[1] + v[i, 2] * n[2]
    cn = carry[0] * n[0] + carry[1] * n[1] + carry[2] * n[2]
    cx, cy, cz = carry[0] - cn * n[0], carry[1] - cn * n[1], carry[2] - cn * n[2]
    tx, ty, tz = v[i, 0] - vn * n[0] - cx, v[i, 1] - vn * n[1] - cy, v[i, 2] - vn * n[2] - cz
    slide = math.sqrt(tx * tx + ty * ty + tz * tz)
    lost = 0.0
    if slide > 0.0:
        lost = min(1.0, push.friction * way / (dt * slide))
    vn = max(vn, speed)
    for c in range(3):
        t, along = (tx, cx) if c == 0 else ((ty, cy) if c == 1 else (tz, cz))
        x[i, c] += way * n[c] - lost * t * dt
        v[i, c] = vn * n[c] + (1.0 - lost) * t + along


@njit(error_model="numpy", inline="always")  # a call would hand on every array of both, for each vertex
def _meet(packed, fields, x, v, i, push):
    """Resolves vertex i; returns how far outside the clearance it was [m]. fields: those of packed."""
    d, (nx, ny, nz), speed = signed_distance(fields, x[i, 0], x[i, 1], x[i, 2])
    if d < push.clearance and nx * nx + ny * ny + nz * nz > 0.5:
        carry = (0.0, 0.0, 0.0)
        if len(packed.ways) > 0:
            carry = carried(packed, d, x[i, 0], x[i, 1], x[i, 2])
        _resolve(x, v, i, (nx, ny, nz), push.clearance - d, speed, carry, push)
    return d - push.clearance


@njit(cache=True, error_model="numpy")
def collide_vertices(packed, inverse_mass, x, v, near, push):
    """Resolves the vertices near[:, 0]; returns the deepest depth seen [m]."""
    deepest, fields = 0.0, fields_of(packed)
    for s in range(len(near)):
        i = near[s, 0]
        if inverse_mass[i] == 0.0:
            continue
        room = _meet(packed, fields, x, v, i, push)
        deepest = max(deepest, -room)
    return deepest


@njit(cache=True, error_model="numpy")
def collide_due_vertices(packed, inverse_mass, x, v, watch, step, push):
    """As `collide_vertices`, for those who are due."""
    drift, fields, samples, wake = drift_of(packed), fields_of(packed), watch.samples, watch.wake
    for s in range(len(samples)):
        if wake[s] > step:
            continue
        i = samples[s, 0]
        if inverse_mass[i] == 0.0:
            continue
        room = _meet(packed, fields, x, v, i, push)
        wake[s] = step + 1 + asleep(room, v[i, 0] ** 2 + v[i, 1] ** 2 + v[i, 2] ** 2, drift, push.dt)


@njit(cache=True, error_model="numpy")
def drift_of(packed):
    """The most that the distance at a place loses in a second [m/s] as the body moves."""
    return abs(packed.blend[1]) * packed.data[0, FASTEST] if packed.kind[0] == MOVING else 0.0


@njit(cache=True, error_model="numpy")
def _way_of_corners(fields, x, sample, count):
    """Which way out (unit, or 0) the corners know where a sample has none: in a lip thinner than a cell."""
    gx = gy = gz = 0.0
    for a in range(count):
        u = sample[a]
        _, (nx, ny, nz), _ = signed_distance(fields, x[u, 0], x[u, 1], x[u, 2])
        gx, gy, gz = gx + nx, gy + ny, gz + nz
    size = math.sqrt(gx * gx + gy * gy + gz * gz)
    if size < 0.25:
        return 0.0, 0.0, 0.0
    return gx / size, gy / size, gz / size


@njit(cache=True, error_model="numpy")
def _meet_middle(fields, inverse_mass, x, v, sample, push):
    """Pushes one midpoint (i, j, i) or centroid (i, j, k) out; returns how far outside it was [m]."""
    i, j, k = sample[0], sample[1], sample[2]
    pair = i == k
    w = 0.5 if pair else 1.0 / 3.0
    count = 2 if pair else 3
    px = w * (x[i, 0] + x[j, 0]) + (0.0 if pair else w * x[k, 0])
    py = w * (x[i, 1] + x[j, 1]) + (0.0 if pair else w * x[k, 1])
    pz = w * (x[i, 2] + x[j, 2]) + (0.0 if pair else w * x[k, 2])
    d, (nx, ny, nz), _ = signed_distance(fields, px, py, pz)
    if d >= push.clearance:
        return d - push.clearance
    if nx * nx + ny * ny + nz * nz < 0.5:
        nx, ny, nz = _way_of_corners(fields, x, sample, count)
        if nx * nx + ny * ny + nz * nz < 0.5:
            return d - push.clearance
    way = min(push.clearance - d, push.cap) / (w * w * count)
    vn = 0.0
    for a in range(count):
        u = sample[a]
        vn += w * (v[u, 0] * nx + v[u, 1] * ny + v[u, 2] * nz)
    gain = max(-vn, 0.0) / (w * w * count)
    for a in range(count):
        u = sample[a]
        if inverse_mass[u] > 0.0:
            x[u, 0] += w * way * nx
            x[u, 1] += w * way * ny
            x[u, 2] += w * way * nz
            v[u, 0] += w * gain * nx
            v[u, 1] += w * gain * ny
            v[u, 2] += w * gain * nz
    return d - push.clearance


@njit(cache=True, error_model="numpy")
def collide_samples(packed, inverse_mass, x, v, near, push):
    """Keeps the midpoints and centroids near (S, 3) outside by moving their vertices."""
    fields = fields_of(packed)
    for s in range(len(near)):
        _meet_middle(fields, inverse_mass, x, v, near[s], push)


@njit(cache=True, error_model="numpy")
def settle_samples(packed, inverse_mass, x, v, watch, step, push):
    """Goes again over the samples that were found inside in this step, until none is or SETTLE times."""
    fields, samples, wake = fields_of(packed), watch.samples, watch.wake
    for _ in range(SETTLE):
        inside = 0
        for s in range(len(samples)):
            if wake[s] == step + 1:
                if _meet_middle(fields, inverse_mass, x, v, samples[s], push) < 0.0:
                    inside += 1
        if inside == 0:
            return


@njit(cache=True, error_model="numpy")
def collide_due_samples(packed, inverse_mass, x, v, watch, step, awake, push):
    """As `collide_samples`, for those who are due, or all that would be SOON where they are `awake`."""
    drift, fields, samples, wake = drift_of(packed), fields_of(packed), watch.samples, watch.wake
    for s in range(len(samples)):
        if wake[s] > (step + SOON if awake else step):
            continue
        room = _meet_middle(fields, inverse_mass, x, v, samples[s], push)
        fast = 0.0
        for a in range(3):
            u = samples[s, a]
            fast = max(fast, v[u, 0] ** 2 + v[u, 1] ** 2 + v[u, 2] ** 2)
        wake[s] = step + 1 + asleep(room, fast, drift, push.dt)


def contact_samples(edges: np.ndarray, faces: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Index triples of the vertices (V, 3) and of the edge midpoints and centroids (E + F, 3), int32."""
    vertices = np.repeat(np.arange(count, dtype=np.int32)[:, None], 3, axis=1)
    middles = np.concatenate([edges[:, [0, 1, 0]], faces]).astype(np.int32)
    return vertices, middles
