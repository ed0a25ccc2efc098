"""Forces and energies of the edge-tension form as the book has them; `banded.py` is the same, run by run.

Edge e with d = x_i - x_j has eps = |d|^2 - L^2 and tension T = 2 sum K eps; vertex i feels -T d. This is the
exact force of a St. Venant-Kirchhoff membrane of linear triangles (Delingette 2008), pairwise and central.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from sim_core.cloth.sheet.sheet import Stencil


@njit(cache=True, error_model="numpy")
def edge_tensions(stencil, x, v, beta, strain, tension):
    """Fills tension (E,) [N/m] for positions x and velocities v (V, 3); beta [s] is stiffness damping."""
    edges = stencil.edges
    for e in range(len(edges)):
        i, j = edges[e, 0], edges[e, 1]
        a, b, c = x[i, 0] - x[j, 0], x[i, 1] - x[j, 1], x[i, 2] - x[j, 2]
        rate = a * (v[i, 0] - v[j, 0]) + b * (v[i, 1] - v[j, 1]) + c * (v[i, 2] - v[j, 2])
        strain[e] = a * a + b * b + c * c - stencil.length2[e] + 2.0 * beta * rate
    for e in range(len(edges)):
        total = stencil.own[e] * strain[e]
        for k in range(4):
            total += stencil.coupling[e, k] * strain[stencil.around[e, k]]
        tension[e] = 2.0 * total


@njit(cache=True, error_model="numpy")
def vertex_forces(stencil, x, tension, force):
    """Fills force (V, 3) [N]: membrane plus bending, without gravity."""
    for i in range(len(x)):
        fx = fy = fz = 0.0
        for k in range(stencil.rows[i], stencil.rows[i + 1]):
            j, e = stencil.neighbour[k], stencil.edge_of[k]
            weight = -stencil.bend[k]
            if e >= 0:
                weight += tension[e]
            fx += weight * (x[j, 0] - x[i, 0])
            fy += weight * (x[j, 1] - x[i, 1])
            fz += weight * (x[j, 2] - x[i, 2])
        force[i, 0], force[i, 1], force[i, 2] = fx, fy, fz


@njit(cache=True, error_model="numpy")
def _energies(stencil, x, v):
    strain, tension = np.zeros(len(stencil.edges)), np.zeros(len(stencil.edges))
    edge_tensions(stencil, x, v, 0.0, strain, tension)
    stretch = 0.25 * (tension * strain).sum()
    bend = kinetic = 0.0
    for i in range(len(x)):
        if stencil.inverse_mass[i] > 0.0:
            kinetic += 0.5 * (v[i, 0] ** 2 + v[i, 1] ** 2 + v[i, 2] ** 2) / stencil.inverse_mass[i]
        for k in range(stencil.rows[i], stencil.rows[i + 1]):
            j = stencil.neighbour[k]
            gap = (x[j, 0] - x[i, 0]) ** 2 + (x[j, 1] - x[i, 1]) ** 2 + (x[j, 2] - x[i, 2]) ** 2
            bend -= 0.25 * stencil.bend[k] * gap
    return stretch, bend, kinetic


def energies(stencil: Stencil, x: np.ndarray, v: np.ndarray) -> tuple[float, float, float]:
    """Membrane, bending and kinetic energy [J] of positions x and velocities v, each (V, 3)."""
    stretch, bend, kinetic = _energies(stencil, x, v)
    return float(stretch), float(bend), float(kinetic)
