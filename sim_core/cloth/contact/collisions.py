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

from sim_core.cloth.contact.distance import carried, distance_at, fields_of, signed_distance
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
    stirred: (V,) bool, vertices that samples have pushed since they were looked at, whom no sleep accounts for.
    """

    samples: np.ndarray
    wake: np.ndarray
    stirred: np.ndarray


@njit(error_model="numpy", inline="always")
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


@njit(cache=True, error_model="numpy")
def _carried(packed, d, x, i):
    return carried(packed, d, x[i, 0], x[i, 1], x[i, 2])


@njit(cache=True, error_model="numpy")
def collide_vertices(packed, inverse_mass, x, v, near, push):
    """Resolves the vertices near[:, 0]; returns the deepest depth seen [m]."""
    deepest, (kind, data, grid, later, blend) = 0.0, fields_of(packed)
    carries = len(packed.ways) > 0
    for s in range(len(near)):
        i = near[s, 0]
        if inverse_mass[i] == 0.0:
            continue
        d, nx, ny, nz, speed, _ = distance_at(kind, data, grid, later, blend, x[i, 0], x[i, 1], x[i, 2])
        if d < push.clearance and nx * nx + ny * ny + nz * nz > 0.5:
            carry = _carried(packed, d, x, i) if carries else (0.0, 0.0, 0.0)
            _resolve(x, v, i, (nx, ny, nz), push.clearance - d, speed, carry, push)
        deepest = max(deepest, push.clearance - d)
    return deepest


@njit(cache=True, error_model="numpy")
def collide_due_vertices(packed, inverse_mass, x, v, watch, step, push):
    """As `collide_vertices`, for those who are due; returns the furthest that one was pushed [m]."""
    samples, wake, stirred, deepest = watch.samples, watch.wake, watch.stirred, 0.0
    (kind, data, grid, later, blend), carries = fields_of(packed), len(packed.ways) > 0
    for s in range(len(samples)):
        i = samples[s, 0]
        if wake[s] > step and not stirred[i]:
            continue
        stirred[i] = False
        if inverse_mass[i] == 0.0:
            continue
        d, nx, ny, nz, speed, drift = distance_at(kind, data, grid, later, blend, x[i, 0], x[i, 1], x[i, 2])
        room = d - push.clearance
        if room < 0.0 and nx * nx + ny * ny + nz * nz > 0.5:
            carry = _carried(packed, d, x, i) if carries else (0.0, 0.0, 0.0)
            _resolve(x, v, i, (nx, ny, nz), push.clearance - d, speed, carry, push)
            deepest = max(deepest, -room)
        wake[s] = step + 1 + asleep(room, v[i, 0] ** 2 + v[i, 1] ** 2 + v[i, 2] ** 2, drift, push.dt)
    return min(deepest, push.cap)


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


@njit(error_model="numpy", inline="always")
def _middle(x, i, j, k):
    """The place of a midpoint (i, j, i) or centroid (i, j, k), and the weight of its corners."""
    w = 0.5 if i == k else 1.0 / 3.0
    third = 0.0 if i == k else w
    px = w * (x[i, 0] + x[j, 0]) + third * x[k, 0]
    py = w * (x[i, 1] + x[j, 1]) + third * x[k, 1]
    pz = w * (x[i, 2] + x[j, 2]) + third * x[k, 2]
    return px, py, pz, w


@njit(cache=True, error_model="numpy")
def _push_middle(fields, inverse_mass, x, v, sample, out, push):
    """Pushes a midpoint or centroid that is too near out, at least as fast as the surface moves.

    out: its distance [m], the way, a unit vector or 0, and the surface's speed that way [m/s].

    Its corners go by their lightness: shared out in any other way, what stops it may make them faster.
    """
    d, nx, ny, nz, speed = out
    i, k = sample[0], sample[2]
    w, count = (0.5, 2) if i == k else (1.0 / 3.0, 3)
    if nx * nx + ny * ny + nz * nz < 0.5:
        nx, ny, nz = _way_of_corners(fields, x, sample, count)
        if nx * nx + ny * ny + nz * nz < 0.5:
            return
    lightest = light = vn = 0.0
    for a in range(count):
        u = sample[a]
        lightest = max(lightest, inverse_mass[u])
        vn += w * (v[u, 0] * nx + v[u, 1] * ny + v[u, 2] * nz)
    if lightest == 0.0:
        return
    for a in range(count):  # a pinned one bears its part: the others would be thrown by a lever
        light += inverse_mass[sample[a]] if inverse_mass[sample[a]] > 0.0 else lightest
    way, gain = min(push.clearance - d, push.cap) / (w * light), max(speed - vn, 0.0) / (w * light)
    for a in range(count):
        u = sample[a]
        share, more = way * inverse_mass[u], gain * inverse_mass[u]
        x[u, 0] += share * nx
        x[u, 1] += share * ny
        x[u, 2] += share * nz
        v[u, 0] += more * nx
        v[u, 1] += more * ny
        v[u, 2] += more * nz


@njit(cache=True, error_model="numpy")
def _meet_middle(fields, inverse_mass, x, v, sample, push):
    """Pushes one midpoint (i, j, i) or centroid (i, j, k) out; returns how far outside it was [m]."""
    px, py, pz, _ = _middle(x, sample[0], sample[1], sample[2])
    d, (nx, ny, nz), _ = signed_distance(fields, px, py, pz)
    if d < push.clearance:
        _push_middle(fields, inverse_mass, x, v, sample, (d, nx, ny, nz, 0.0), push)
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
                    for c in range(3):
                        watch.stirred[samples[s, c]] = True
        if inside == 0:
            return


@njit(cache=True, error_model="numpy")
def collide_due_samples(packed, inverse_mass, x, v, watch, step, awake, push):
    """As `collide_samples`, for those who are due, or all that would be SOON where they are `awake`.

    Returns the furthest that one was pushed [m].
    """
    fields, samples, wake, stirred = fields_of(packed), watch.samples, watch.wake, watch.stirred
    (kind, data, grid, later, blend), latest, deepest = fields, step + SOON if awake else step, 0.0
    for s in range(len(samples)):
        if wake[s] > latest:
            continue
        i, j, k = samples[s, 0], samples[s, 1], samples[s, 2]
        px, py, pz, _ = _middle(x, i, j, k)
        d, nx, ny, nz, speed, drift = distance_at(kind, data, grid, later, blend, px, py, pz)
        if d < push.clearance:
            deepest = max(deepest, push.clearance - d)
            _push_middle(fields, inverse_mass, x, v, samples[s], (d, nx, ny, nz, speed), push)
            stirred[i], stirred[j], stirred[k] = True, True, True
        fast = v[i, 0] ** 2 + v[i, 1] ** 2 + v[i, 2] ** 2
        fast = max(fast, v[j, 0] ** 2 + v[j, 1] ** 2 + v[j, 2] ** 2)
        fast = max(fast, v[k, 0] ** 2 + v[k, 1] ** 2 + v[k, 2] ** 2)
        wake[s] = step + 1 + asleep(d - push.clearance, fast, drift, push.dt)
    return min(deepest, push.cap)


def contact_samples(edges: np.ndarray, faces: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Index triples of the vertices (V, 3) and of the edge midpoints and centroids (E + F, 3), int32."""
    vertices = np.repeat(np.arange(count, dtype=np.int32)[:, None], 3, axis=1)
    middles = np.concatenate([edges[:, [0, 1, 0]], faces]).astype(np.int32)
    return vertices, middles
