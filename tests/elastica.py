"""Closed references for plain weave of equal round yarns of diameter 1: the elastica, and Peirce's arcs near jam."""

from math import acos, cos, sin, sqrt

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve

__all__ = ["elastica_crimp", "peirce_crimp"]


def elastica_crimp(spacing: float) -> float:
    """Crimp of a yarn that touches the other in one point at each crest, by the elastica.

    spacing: p/d. The yarn may be drawn in freely (no tension), so its Hamiltonian k^2/2 + F.t vanishes; it runs from
    (0, 0) to (p, d), level at both ends. Solved by shooting on the equations of Euler's elastica.
    """

    def miss(unknown):
        length, bend, fx, fy = unknown
        path = solve_ivp(
            lambda s, y: [y[1], fx * np.sin(y[0]) - fy * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])],
            (0, length), [0.0, bend, 0.0, 0.0], rtol=1e-10, atol=1e-13,
        ).y[:, -1]  # fmt: skip
        return [path[0], path[2] - spacing, path[3] - 1.0, bend**2 / 2 + fx]

    start = [sqrt(spacing**2 + 1.2), 6 / spacing**2, 0.0, 12 / spacing**3]
    length = fsolve(miss, start, xtol=1e-12)[0]
    return float(length / spacing - 1)


def peirce_crimp(spacing: float) -> float:
    """Crimp of Peirce's flexible yarns: straight pieces and arcs of diameter D = 2d about the crossing yarn.

    spacing: p/d, from the jam at sqrt(3) on.
    p = (l - D a) cos a + D sin a and d = (l - D a) sin a + D (1 - cos a), l the length, a the steepest angle.
    """

    def rest(a: float) -> float:
        straight = (1.0 - 2.0 * (1 - cos(a))) / sin(a)
        return straight * cos(a) + 2.0 * sin(a) - spacing

    angle = float(np.asarray(brentq(rest, 1e-3, acos(0.5))))
    straight = (1.0 - 2.0 * (1 - cos(angle))) / sin(angle)
    return (straight + 2.0 * angle) / spacing - 1
