"""Steps of all particles of a yarn at once: its bending and tension are solved for, contact counts on the diagonal.

A step in which each particle answers only for itself moves the long waves of a yarn by next to nothing: bending resists
them (wave length)^-4. So forces are divided by the yarn's own stiffness, a cyclic matrix of five diagonals
    EI/l^3 (.., 1, -4, 6, -4, 1, ..) + T/l (.., -1, 2, -1, ..) + contact of each particle,
factored as L D L^T with the last two particles as a border, which closes the ring.
"""

import numpy as np
from numba import njit

__all__ = ["advance", "factored", "power"]

FARTHEST_MOVE = 0.05  # of D, in a step


@njit(cache=True, error_model="numpy")
def factored(weight, bend, pull, made):
    """Factor the stiffness of every yarn. weight: (yarns, n) contact [EI/D^3]; bend: EI/l^3; pull: T/l.

    made: (yarns, n, 5), written: 1/D, the two entries of L before the diagonal, those in the last two rows.
    """
    yarns, n = weight.shape
    side, far, middle = -4.0 * bend - pull, bend, 6.0 * bend + 2.0 * pull
    m = n - 2
    for yarn in range(yarns):
        a, w = made[yarn], weight[yarn]
        d1, d2 = 0.0, 0.0  # D of the last two
        last, end, both = middle + w[m], middle + w[m + 1], side
        p1, p2, q1, q2 = 0.0, 0.0, 0.0, 0.0
        before = 0.0  # first entry of L of the last one
        for k in range(m):
            two = far / d2 if k > 1 else 0.0
            one = (side - two * d2 * before) / d1 if k > 0 else 0.0
            d = middle + w[k] - one * one * d1 - two * two * d2
            p = far if k == 0 or k == m - 2 else side if k == m - 1 else 0.0
            q = side if k == 0 else far if k == 1 or k == m - 1 else 0.0
            p = (p - p1 * d1 * one - p2 * d2 * two) / d
            q = (q - q1 * d1 * one - q2 * d2 * two) / d
            last -= p * p * d
            end -= q * q * d
            both -= p * q * d
            a[k, 0], a[k, 1], a[k, 2], a[k, 3], a[k, 4] = 1.0 / d, one, two, p, q
            d2, d1, before, p2, p1, q2, q1 = d1, d, one, p1, p, q1, q
        both /= last
        end -= both * both * last
        a[m, 0], a[m, 1], a[m, 2], a[m, 3], a[m, 4] = 1.0 / last, 0.0, 0.0, 0.0, 0.0
        a[m + 1, 0], a[m + 1, 1], a[m + 1, 2], a[m + 1, 3], a[m + 1, 4] = 1.0 / end, both, 0.0, 0.0, 0.0


@njit(cache=True, error_model="numpy")
def _solved(a, b, g, h, x, y):
    """Stiffness a^-1 g and b^-1 h of one yarn, into x and y, in one pass, since each waits on itself."""
    m = len(g) - 2
    x1, x2, y1, y2 = 0.0, 0.0, 0.0, 0.0
    xp, xq, yp, yq = g[m], g[m + 1], h[m], h[m + 1]
    for k in range(m):
        xk = (g[k] - a[k, 2] * x2) - a[k, 1] * x1
        yk = (h[k] - b[k, 2] * y2) - b[k, 1] * y1
        xp -= a[k, 3] * xk
        xq -= a[k, 4] * xk
        yp -= b[k, 3] * yk
        yq -= b[k, 4] * yk
        x[k], y[k] = xk, yk
        x2, x1, y2, y1 = x1, xk, y1, yk
    xq = (xq - a[m + 1, 1] * xp) * a[m + 1, 0]
    yq = (yq - b[m + 1, 1] * yp) * b[m + 1, 0]
    xp = xp * a[m, 0] - a[m + 1, 1] * xq
    yp = yp * b[m, 0] - b[m + 1, 1] * yq
    x[m], x[m + 1], y[m], y[m + 1] = xp, xq, yp, yq
    x1, x2, y1, y2 = 0.0, 0.0, 0.0, 0.0  # rows m and m + 1 have no part in L before the diagonal
    ax1, ax2, by1, by2 = 0.0, 0.0, 0.0, 0.0
    for k in range(m - 1, -1, -1):
        xk = ((x[k] * a[k, 0] - a[k, 3] * xp - a[k, 4] * xq) - ax2 * x2) - ax1 * x1
        yk = ((y[k] * b[k, 0] - b[k, 3] * yp - b[k, 4] * yq) - by2 * y2) - by1 * y1
        x[k], y[k] = xk, yk
        x2, x1, y2, y1 = x1, xk, y1, yk
        # entries of L in column k - 1: first of row k, second of row k + 1
        ax1, by1 = a[k, 1], b[k, 1]
        ax2, by2 = (a[k + 1, 2], b[k + 1, 2]) if k < m - 1 else (0.0, 0.0)


@njit(cache=True, error_model="numpy")
def power(vu, vz, gu, gz, way):
    """Power of each yarn into way[:, 0]. Returns the largest force."""
    worst = 0.0
    for y in range(vu.shape[0]):
        one, two = 0.0, 0.0
        for k in range(vu.shape[1]):
            worst = max(worst, max(abs(gu[y, k]), abs(gz[y, k])))
            one += gu[y, k] * vu[y, k]
            two += gz[y, k] * vz[y, k]
        way[y, 0] = one + two
    return worst


@njit(cache=True, error_model="numpy")
def advance(u, z, vu, vz, gu, gz, au, az, way, length):
    """One step of Nesterov's method for each yarn by itself: one that turns back does not stop the others.

    Its look ahead calms stiff contacts at once and leaves slow slides their momentum.
    au, az: factored stiffness of either direction.  way: (yarns, 2) power, steps since the yarn turned back.
    """
    n = u.shape[1]
    x, y = np.zeros(n), np.zeros(n)
    for yarn in range(u.shape[0]):
        way[yarn, 1] = way[yarn, 1] + 1 if way[yarn, 0] > 0 else 0
        keep = way[yarn, 1] / (way[yarn, 1] + 3.0)
        ahead = (way[yarn, 1] + 1) / (way[yarn, 1] + 4.0)
        _solved(au[yarn], az[yarn], gu[yarn], gz[yarn], x, y)
        for p, v, d in ((u[yarn], vu[yarn], x), (z[yarn], vz[yarn], y)):
            for k in range(n):
                push = length * d[k]
                v[k] = keep * v[k] + push
                p[k] += min(max(push + ahead * v[k], -FARTHEST_MOVE), FARTHEST_MOVE)
