"""Which vertices go otherwise than they did when somebody last relied on how they go.

Pairs that sleep, and lists that are foreseen, reckon with velocities of before. Whatever changes these, a blow of
another layer, of a solid, of a pin, shows here in every substep, and wakes who relied on them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

SWAY = 0.1  # [m/s] by which a vertex may go otherwise, before pairs that sleep are woken
SHAKEN = 0.35  # [m/s] likewise, before the cloth is looked at again


class Jerks(NamedTuple):
    """What is relied on, and who has left it."""

    last: np.ndarray  # (3, V) [m] where vertices were when layers were last asked
    leapt: np.ndarray  # (3, V) [m] where they were after the leap of this substep, if any gap is narrow
    going: np.ndarray  # (3, V) [m/s] what sleeping pairs reckon with
    looked: np.ndarray  # (3, V) [m/s] what lists reckon with
    jerked: np.ndarray  # (V,) bool, in this substep
    some: np.ndarray  # (1,) bool, whether any is
    back: np.ndarray  # (2,) bool, whether a push through a layer was taken back, and whether one had no end
    restless: np.ndarray  # (V,) bool, who in this frame was once too fast, or pushed too far


def jerks_of(vertices: int) -> Jerks:
    """Memory for V vertices."""
    last, leapt, going, looked = (np.zeros((3, vertices)) for _ in range(4))
    jerked, restless = (np.zeros(vertices, np.bool_) for _ in range(2))
    some, back = np.zeros(1, np.bool_), np.zeros(2, np.bool_)
    return Jerks(last, leapt, going, looked, jerked, some, back, restless)


@njit(cache=True, error_model="numpy")
def stand_by(x, v, jerks):
    """Begins at x and v (3, V): nobody is jerked, and nobody may sleep yet."""
    jerks.last[:], jerks.going[:], jerks.looked[:] = x, v, v
    jerks.jerked[:] = jerks.restless[:] = False
    jerks.some[:] = jerks.back[:] = False


@njit(cache=True, error_model="numpy")
def feel(x, v, jerks, dt):
    """Who is jerked at x and v (3, V), a substep of dt [s] after the last call; whether lists may not be relied on.

    Asked are the velocity and the way that was gone, of which pushes of solids are part and the velocity knows nothing.
    """
    jerked, per, some, shaken = jerks.jerked, 1.0 / dt, 0, 0
    (x0, x1, x2), (v0, v1, v2) = (x[0], x[1], x[2]), (v[0], v[1], v[2])
    a0, a1, a2 = jerks.last[0], jerks.last[1], jerks.last[2]
    g0, g1, g2 = jerks.going[0], jerks.going[1], jerks.going[2]
    l0, l1, l2 = jerks.looked[0], jerks.looked[1], jerks.looked[2]
    for i in range(len(jerked)):  # sums of what is true, so that lanes do it side by side
        ux, uy, uz = per * (x0[i] - a0[i]), per * (x1[i] - a1[i]), per * (x2[i] - a2[i])
        by_speed = (v0[i] - g0[i]) ** 2 + (v1[i] - g1[i]) ** 2 + (v2[i] - g2[i]) ** 2
        by_way = (ux - g0[i]) ** 2 + (uy - g1[i]) ** 2 + (uz - g2[i]) ** 2
        off = (by_speed > SWAY * SWAY) | (by_way > SWAY * SWAY)
        jerked[i] = off
        some += off
        by_speed = (v0[i] - l0[i]) ** 2 + (v1[i] - l1[i]) ** 2 + (v2[i] - l2[i]) ** 2
        by_way = (ux - l0[i]) ** 2 + (uy - l1[i]) ** 2 + (uz - l2[i]) ** 2
        shaken += (by_speed > SHAKEN * SHAKEN) | (by_way > SHAKEN * SHAKEN)
        a0[i], a1[i], a2[i] = x0[i], x1[i], x2[i]
    if some > 0:
        for i in range(len(jerked)):
            if jerked[i]:
                g0[i], g1[i], g2[i] = v0[i], v1[i], v2[i]
    jerks.some[0] = some > 0
    return shaken > 0
