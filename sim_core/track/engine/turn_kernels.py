"""The rotations of `rotations.py` and the bones' own as loops for numba."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

__all__ = ["between", "carried", "rotated", "rotation"]


@njit(cache=True)
def rotation(covariance):
    """As `kabsch`."""
    u, _, vh = np.linalg.svd(covariance)
    turn = np.zeros((3, 3))
    for attempt in range(2):
        for i in range(3):
            for j in range(3):
                turn[i, j] = vh[0, i] * u[j, 0] + vh[1, i] * u[j, 1] + vh[2, i] * u[j, 2]
        det = turn[0, 0] * (turn[1, 1] * turn[2, 2] - turn[1, 2] * turn[2, 1])
        det -= turn[0, 1] * (turn[1, 0] * turn[2, 2] - turn[1, 2] * turn[2, 0])
        det += turn[0, 2] * (turn[1, 0] * turn[2, 1] - turn[1, 1] * turn[2, 0])
        if det >= 0.0 or attempt:
            break
        for k in range(3):
            vh[2, k] = -vh[2, k]
    return turn


@njit(cache=True)
def between(now, before):
    """The rotation (3, 3) from one to the other."""
    out = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            for k in range(3):
                out[i, j] += now[i, k] * before[j, k]
    return out


@njit(cache=True)
def times(a, b, out):
    """The product of two quaternions (4,)."""
    w = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3]
    x = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2]
    y = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1]
    z = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]
    out[0], out[1], out[2], out[3] = w, x, y, z


@njit(cache=True)
def carried(q, v, out):
    """A vector (3,) turned by a quaternion (4,)."""
    p = 2.0 * (q[2] * v[2] - q[3] * v[1])
    r = 2.0 * (q[3] * v[0] - q[1] * v[2])
    s = 2.0 * (q[1] * v[1] - q[2] * v[0])
    out[0] = v[0] + q[0] * p + q[2] * s - q[3] * r
    out[1] = v[1] + q[0] * r + q[3] * p - q[1] * s
    out[2] = v[2] + q[0] * s + q[1] * r - q[2] * p


@njit(cache=True)
def unit(q):
    """A quaternion (4,) made as long as 1, in place."""
    size = math.sqrt(q[0] ** 2 + q[1] ** 2 + q[2] ** 2 + q[3] ** 2)
    for k in range(4):
        q[k] /= size


@njit(cache=True)
def arc(a, b, out):
    """As `arcs`, of one pair; 1 + cos of the angle."""
    near = 1.0 + a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    out[0] = near
    out[1], out[2], out[3] = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    if near < 1e-8:
        out[0] = 0.0
        if abs(a[0]) < 0.7:
            out[1], out[2], out[3] = 0.0, a[2], -a[1]
        else:
            out[1], out[2], out[3] = -a[2], 0.0, a[0]
    unit(out)
    return near


@njit(cache=True)
def quaternion(turn):
    """As `quaternion_of`, (4,)."""
    trace = turn[0, 0] + turn[1, 1] + turn[2, 2]
    out = np.zeros(4)
    i = 0
    for k in range(1, 3):
        if turn[k, k] > turn[i, i]:
            i = k
    if trace < 0.0 or trace < turn[i, i]:
        j, k = (i + 1) % 3, (i + 2) % 3
        out[0] = turn[k, j] - turn[j, k]
        out[i + 1] = 1.0 + turn[i, i] - turn[j, j] - turn[k, k]
        out[j + 1], out[k + 1] = turn[i, j] + turn[j, i], turn[i, k] + turn[k, i]
    else:
        out[0] = 1.0 + trace
        out[1], out[2], out[3] = turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]
    unit(out)
    return out


@njit(cache=True)
def rotated(body, state, rules, along, trunk, step):
    """As `turn_step`."""
    count = len(along)
    turns = np.zeros((count, 4))
    now, moved = quaternion(trunk), quaternion(between(trunk, state.trunk))
    before, swing, home, pointing = np.zeros(4), np.zeros(4), np.zeros(4), np.zeros(3)
    back = 1.0 - math.exp(-step / rules.untwist)
    for b in range(count):
        times(moved, state.turns[b], before)
        carried(before, body.directions[b], pointing)
        arc(pointing, along[b], swing)
        times(swing, before, turns[b])
        carried(now, body.directions[b], pointing)
        near = arc(pointing, along[b], swing)
        times(swing, now, home)
        same = home[0] * turns[b, 0] + home[1] * turns[b, 1] + home[2] * turns[b, 2] + home[3] * turns[b, 3]
        share = back * 0.5 * near * (-1.0 if same < 0.0 else 1.0)
        for k in range(4):
            turns[b, k] += share * home[k]
        unit(turns[b])
    return turns
