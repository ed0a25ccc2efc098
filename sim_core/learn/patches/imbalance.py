"""What is missing to balance: how a fine sheet that is led would still move if it stood as it is said to.

Both sheets feel the same gravity, wind and floor, so where the fine one is W X + r its difference r is accelerated by
what the sheets do themselves, and by what leads:

    q = a(W X + r) - W A(X) - k W P r,

a and A the accelerations by stretch and bending of the fine and the coarse sheet, k W P r the lead's. Whoever says r
can be told q, as an iteration of a solver is, and mends what it learned wrongly on a cloth that it has never seen.
Where the coarse sheet was pooled from the fine one nothing is led and nothing is known of what both sheets feel: the
vertices that were kept stand where they are, as pins do, and told is a(W X + r) of the others, of which gravity and
inertia are a part that the network has to know by itself (about 15 m/s2; a wrong place of a vertex is thousands).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from sim_core.cloth import Sheet
from sim_core.cloth.sheet.energies import edge_tensions, vertex_forces
from sim_core.learn.data import STIFFNESS, Pair
from sim_core.learn.topology import unsigned
from sim_core.learn.upsampling import weighted_sums

__all__ = ["Imbalance", "limited"]

SAG = 0.005  # [m] that means are told to be out of balance by, at most


@dataclass(frozen=True)
class Imbalance:
    """Of a pair of sheets. ease (V, 1) [s2]: of an acceleration to about the way that undoes it, 0 where pinned or
    kept; free (C, 1): 0 where the coarse sheet is pinned; led [1/s2]: how hard it leads."""

    pair: Pair
    ease: np.ndarray
    free: np.ndarray
    led: float

    @staticmethod
    def of(pair: Pair) -> Imbalance:
        """That of a pair."""
        stencil, count = pair.fine.stencil, len(pair.fine.rest)
        stiff = 4.0 * stencil.own * stencil.length2  # [N/m] of an edge along itself, at rest
        total = np.bincount(stencil.edges.ravel(), np.repeat(stiff, 2), count)
        led = 0.0 if pair.kept else STIFFNESS
        ease = 1.0 / (total / pair.fine.mass + led)
        free = np.ones((len(pair.coarse.rest), 1))
        for held, array in zip(pair.pins, (free, ease), strict=True):
            array[list(held)] = 0.0
        ease[list(pair.kept)] = 0.0
        return Imbalance(pair, ease[:, None], free, led)

    def shared(self, coarse: np.ndarray) -> np.ndarray:
        """W A(X) (V, 3) [m/s2] of a coarse sheet (C, 3) [m]; 0 where it was pooled."""
        if self.pair.kept:
            return np.zeros((len(self.ease), 3))
        return weighted_sums(self.pair.spread, self.free * accelerations(self.pair.coarse, coarse))

    def ways(self, fine: np.ndarray, coarse: np.ndarray, shared: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Ways [m] on which fine vertices (V, 3) want to go, each for itself, and the means (C, 3) about coarse ones.

        fine (V, 3), coarse (C, 3) [m]; shared: of `shared`.
        """
        pair = self.pair
        missing, ways = accelerations(pair.fine, fine), np.zeros((len(fine), 3))
        off = weighted_sums(pair.mean, fine - weighted_sums(pair.spread, coarse))
        _lacking(missing, shared, self.led * weighted_sums(pair.spread, off), self.ease, ways)
        return ways, limited(weighted_sums(pair.mean, missing) / STIFFNESS, SAG)


@njit(cache=True)
def _lacking(missing, shared, led, ease, ways):
    """Takes from accelerations (V, 3) what is shared and what leads, in place, but of those that are pinned all."""
    for i in range(len(missing)):
        for c in range(3):
            lacks = missing[i, c] - shared[i, c] - led[i, c]
            ways[i, c], missing[i, c] = ease[i, 0] * lacks, lacks if ease[i, 0] > 0.0 else 0.0


def limited(vectors: np.ndarray, most: float) -> np.ndarray:
    """Vectors (N, 3), the longer ones cut to a length; by length, since a cut axis by axis would know where up is."""
    out = np.array(vectors, float)
    _cut(out, most)
    return out


@njit(cache=True)
def _cut(vectors, most):
    for i in range(len(vectors)):
        size = math.sqrt(vectors[i, 0] ** 2 + vectors[i, 1] ** 2 + vectors[i, 2] ** 2)
        if size > most:
            for c in range(3):
                vectors[i, c] *= most / size


def accelerations(sheet: Sheet, positions: np.ndarray) -> np.ndarray:
    """By stretch and bending, (V, 3) [m/s2], at positions (V, 3) [m]."""
    stencil = sheet.stencil
    never_negative = {
        name: unsigned(getattr(stencil, name)) for name in ("edges", "around", "rows", "neighbour")
    }
    stencil = stencil._replace(**never_negative)
    return _accelerations(stencil, np.ascontiguousarray(positions, float), sheet.mass)


@njit(cache=True, error_model="numpy")
def _accelerations(stencil, x, mass):
    strain, tension = np.zeros(len(stencil.edges)), np.zeros(len(stencil.edges))
    force = np.zeros_like(x)
    edge_tensions(stencil, x, x, 0.0, strain, tension)
    vertex_forces(stencil, x, tension, force)
    for i in range(len(x)):
        for c in range(3):
            force[i, c] /= mass[i]
    return force
