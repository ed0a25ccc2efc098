"""Impact zones: what would pass through each other within a step goes along together instead.

After Provot (1997) and Harmon et al. (2008), with translations alone: the vertices of all crossing pairs that share
one move by their common mean, weighted by mass. Nothing within a zone moves against the rest of it, so it cannot
cross; what a zone then runs into joins it. In the end the whole cloth is one zone, and stands still or flies.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

SAME = 1e-12  # [m] two led vertices that move alike to within this are one body


def zones_of(stencils: np.ndarray, count: int) -> np.ndarray:
    """The zone (count,) each vertex belongs to, -1: none. stencils (K, 4): the vertices of pairs that would cross."""
    first = np.repeat(stencils[:, 0], stencils.shape[1])
    links = coo_array((np.ones(stencils.size), (first, stencils.ravel())), shape=(count, count))
    _, zone = connected_components(links, directed=False)
    inside = np.zeros(count, bool)
    inside[stencils.ravel()] = True
    zone[~inside] = -1
    _, renumbered = np.unique(zone[inside], return_inverse=True)
    zone[inside] = renumbered
    return zone


def moved_together(
    zone: np.ndarray, way: np.ndarray, v: np.ndarray, inverse_mass: np.ndarray
) -> tuple[np.ndarray, np.ndarray, int]:
    """Ways (V, 3) [m] and velocities (V, 3) [m/s] once every zone moves as one, and how many zones cannot.

    inverse_mass (V,) [1/kg]: 0 for what is held or led, whose way the zone then takes; a zone with two of different
    ways is left alone.
    """
    way, v, stuck = way.copy(), v.copy(), 0
    for number in range(int(zone.max(initial=-1)) + 1):
        member = np.flatnonzero(zone == number)
        held = member[inverse_mass[member] == 0.0]
        if len(held):
            if np.ptp(way[held], axis=0).max() > SAME:
                stuck += 1
                continue
            way[member], v[member] = way[held[0]], v[held[0]]
        else:
            weight = 1.0 / inverse_mass[member]
            weight /= weight.sum()
            way[member] = (weight[:, None] * way[member]).sum(0)
            v[member] = (weight[:, None] * v[member]).sum(0)
    return way, v, stuck
