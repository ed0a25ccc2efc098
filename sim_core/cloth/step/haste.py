"""How long a step may be for layers that fly at each other."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

HASTE = 0.5  # of the shell's thickness, that a vertex may go in a step
SHORTEST = 4e-6  # [s], to which haste alone shortens a step
LATE = 2.0  # times that step, beyond which a frame whose layers became faster is done again


@njit(cache=True, error_model="numpy")
def passing_step(thickness, v, solids):
    """Largest step [s] in which no two layers can pass through the shell they keep, at velocities v (3, V) [m/s].

    The fastest vertex, seen from the cloth's mean, moves by at most HASTE of the thickness [m]; 0: no shell. Among
    solids, which may stop one layer before another, it is seen from where they stand.
    """
    if thickness == 0.0:
        return np.inf
    count, fastest = v.shape[1], 0.0
    mx, my, mz = v[0].sum() / count, v[1].sum() / count, v[2].sum() / count
    if solids:
        mx = my = mz = 0.0
    for i in range(count):
        fastest = max(fastest, (v[0, i] - mx) ** 2 + (v[1, i] - my) ** 2 + (v[2, i] - mz) ** 2)
    return max(SHORTEST, HASTE * thickness / max(math.sqrt(fastest), 1e-9))
