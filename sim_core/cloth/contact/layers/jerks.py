"""Which vertices go otherwise than they did when somebody last relied on how they go.

Pairs that sleep reckon with velocities of before, and lists that are foreseen with straight ways. Whatever changes
these, a blow of another layer, of a solid, of a pin, shows here in every substep, and wakes who relied on them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

SWAY = 0.1  # [m/s] by which a vertex may go otherwise at least, before pairs that sleep are woken


class Jerks(NamedTuple):
    """What is relied on, and who has left it."""

    last: np.ndarray  # (2, 3, V) [m] where vertices were when layers were asked the last two times
    leapt: np.ndarray  # (3, V) [m] where they were after the leap of this substep, if any gap is narrow
    going: np.ndarray  # (3, V) [m/s] what sleeping pairs reckon with
    sway2: np.ndarray  # (V,) [m2/s2] and the square of how much otherwise they allow for
    seen: np.ndarray  # (3, V) [m] where vertices were when the cloth was last looked at
    bound: np.ndarray  # (3, V) [m/s] how they went then
    jerked: np.ndarray  # (V,) bool, in this substep
    some: np.ndarray  # (1,) bool, whether any is
    turn: np.ndarray  # (1,) int64 which of `last` was written last
    back: np.ndarray  # (2,) bool, whether a push through a layer was taken back, and whether one had no end
    restless: np.ndarray  # (V,) bool, who in this frame was once too fast, or pushed too far


def jerks_of(vertices: int) -> Jerks:
    """Memory for V vertices."""
    leapt, going, seen, bound = (np.zeros((3, vertices)) for _ in range(4))
    last, sway2, turn = np.zeros((2, 3, vertices)), np.zeros(vertices), np.zeros(1, np.int64)
    jerked, restless = (np.zeros(vertices, np.bool_) for _ in range(2))
    some, back = np.zeros(1, np.bool_), np.zeros(2, np.bool_)
    return Jerks(last, leapt, going, sway2, seen, bound, jerked, some, turn, back, restless)


@njit(cache=True, error_model="numpy")
def look_from(x, v, jerks):
    """Straight ways are told from here on: from x at v (3, V)."""
    jerks.seen[:], jerks.bound[:] = x, v


@njit(cache=True, error_model="numpy")
def stand_by(x, v, jerks):
    """Begins at x and v (3, V): nobody is jerked, and nobody may sleep yet."""
    jerks.last[0], jerks.turn[0] = x, 0
    jerks.going[:], jerks.sway2[:] = v, SWAY * SWAY
    look_from(x, v, jerks)
    jerks.jerked[:] = jerks.restless[:] = False
    jerks.some[:] = jerks.back[:] = False


@njit(cache=True, error_model="numpy")
def feel(x, v, jerks, dt, straight):
    """Who is jerked at x and v (3, V), a substep of dt [s] after the last call; whether lists may not be relied on.

    Asked are the velocity and the way that was gone, of which pushes of solids are part and the velocity knows nothing:
    what lies on a body is pushed in every substep, which is allowed for from the first on.
    straight: how long ago the cloth was looked at [s], and how far a vertex may be from where it was bound for then
    [m], now and, as it goes now, a step later.
    """
    jerked, sway2, per, some, astray, before = jerks.jerked, jerks.sway2, 1.0 / dt, 0, 0, jerks.turn[0]
    gone, far2 = straight[0], straight[1] ** 2
    (x0, x1, x2), (v0, v1, v2) = (x[0], x[1], x[2]), (v[0], v[1], v[2])
    last, now = jerks.last[before], jerks.last[1 - before]
    a0, a1, a2, n0, n1, n2 = last[0], last[1], last[2], now[0], now[1], now[2]
    g0, g1, g2 = jerks.going[0], jerks.going[1], jerks.going[2]
    s0, s1, s2 = jerks.seen[0], jerks.seen[1], jerks.seen[2]
    b0, b1, b2 = jerks.bound[0], jerks.bound[1], jerks.bound[2]
    for i in range(len(jerked)):  # sums of what is true, so that lanes do it side by side
        ux, uy, uz = per * (x0[i] - a0[i]), per * (x1[i] - a1[i]), per * (x2[i] - a2[i])
        by_speed = (v0[i] - g0[i]) ** 2 + (v1[i] - g1[i]) ** 2 + (v2[i] - g2[i]) ** 2
        by_way = (ux - g0[i]) ** 2 + (uy - g1[i]) ** 2 + (uz - g2[i]) ** 2
        off = (by_speed > sway2[i]) | (by_way > sway2[i])
        jerked[i] = off
        some += off
        dx, dy, dz = x0[i] - s0[i] - gone * b0[i], x1[i] - s1[i] - gone * b1[i], x2[i] - s2[i] - gone * b2[i]
        ex, ey, ez = dx + dt * (v0[i] - b0[i]), dy + dt * (v1[i] - b1[i]), dz + dt * (v2[i] - b2[i])
        astray += (dx * dx + dy * dy + dz * dz > far2) | (ex * ex + ey * ey + ez * ez > far2)
        n0[i], n1[i], n2[i] = x0[i], x1[i], x2[i]
    if some > 0:
        for i in range(len(jerked)):
            if jerked[i]:
                g0[i], g1[i], g2[i] = v0[i], v1[i], v2[i]
                px, py, pz = (
                    per * (n0[i] - a0[i]) - v0[i],
                    per * (n1[i] - a1[i]) - v1[i],
                    per * (n2[i] - a2[i]) - v2[i],
                )
                sway2[i] = (SWAY + math.sqrt(px * px + py * py + pz * pz)) ** 2
    jerks.some[0], jerks.turn[0] = some > 0, 1 - before
    return astray > 0
