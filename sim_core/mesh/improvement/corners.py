"""Steps that end in a narrow corner: when they stay as they are, so that a corner is not divided for ever.

Steps that leave one point less than 60 degrees apart, each from the next, are a cluster. They are divided at powers of
two from that point, so that they end on one circle around it, and what lies across the corner is a short side: were it,
or what grows away from it, a reason to divide them again, there would be no end. So one of a cluster is divided where

- another one of it is shorter,
- the side that asks is no longer than the least one across would be then (Shewchuk 2002, the Terminator), or
- a point there is lies so near to it, seen at more than 120 degrees, that the corner is not the reason.

Else it stays. Points are put beside it as near as 120 degrees allow, where the circle over it would keep them away
(Chew 1993: lenses), and sides grow around its far end from what is across the corner to its own length.
"""

import numpy as np
from numba import njit

from sim_core.mesh.triangulation.flips import AHEAD, corner_of

__all__ = ["flat_over", "held"]

WIDE = 0.25  # sin**2 of half of 60 degrees: steps further apart are no cluster
SAME = 1e-5  # lengths and angles that differ by less than this share are one


@njit(cache=True, error_model="numpy")
def held(f, t, k, sharp, square):
    """Whether the step at edge k of face t stays, though a face asks for it whose shortest side is sqrt(square) long.

    f: `Flips`.  sharp: (n,) bool, points where steps meet at a sharp angle; a step between two of them never stays.
    """
    a, b = f.faces[t, k], f.faces[t, AHEAD[k]]
    if sharp[a] == sharp[b]:
        return False
    v, p = a, b
    if sharp[b]:
        v, p = b, a
        t = f.across[t, k]
    own, least = _square(f, v, p), _narrowest(f, t, v)
    if least >= WIDE or square <= least * own or _crowded(f, t, v) or _crowded(f, _right(f, t, v), p):
        return False
    # a cluster goes with the shortest of its steps and of those of clusters, at the same point, that are as narrow
    first = t
    while True:
        c = corner_of(f.faces, t, v)
        if f.fixed[t, c] and _square(f, v, f.faces[t, AHEAD[c]]) * (1 + SAME) < own:
            if _narrowest(f, t, v) <= least * (1 + SAME):
                return False
        t = f.across[t, AHEAD[AHEAD[c]]]
        if t == first:
            return True


@njit(cache=True, error_model="numpy")
def flat_over(f, a, b, x, y):
    """Whether the edge a b is seen at more than 120 degrees from (x, y)."""
    px, py, qx, qy = f.places[a, 0] - x, f.places[a, 1] - y, f.places[b, 0] - x, f.places[b, 1] - y
    return px * qx + py * qy < -0.5 * np.sqrt((px * px + py * py) * (qx * qx + qy * qy))


@njit(cache=True, error_model="numpy")
def _crowded(f, t, a):
    """Whether face t is cloth and its third corner flat over the edge that runs from a with t on its left."""
    c = corner_of(f.faces, t, a)
    q = f.faces[t, AHEAD[AHEAD[c]]]
    return f.inner[t] and flat_over(f, a, f.faces[t, AHEAD[c]], f.places[q, 0], f.places[q, 1])


@njit(cache=True, error_model="numpy")
def _right(f, t, v):
    """The face on the right of the edge that runs from v with face t on its left."""
    return f.across[t, corner_of(f.faces, t, v)]


@njit(cache=True, error_model="numpy")
def _square(f, a, b):
    return (f.places[a, 0] - f.places[b, 0]) ** 2 + (f.places[a, 1] - f.places[b, 1]) ** 2


@njit(cache=True, error_model="numpy")
def _narrowest(f, t, v):
    """The least angle of the cluster of the step from v that has face t on its left, as sin**2 of half of it; `WIDE`
    where the step is in none."""
    p = f.faces[t, AHEAD[corner_of(f.faces, t, v)]]
    return min(_narrowest_beyond(f, t, v, p, True), _narrowest_beyond(f, _right(f, t, v), v, p, False))


@njit(cache=True, error_model="numpy")
def _narrowest_beyond(f, t, v, p, left):
    """`_narrowest` on one side of the step v p: from face t beside it around v, as far as the cluster goes."""
    x, y = f.places[v, 0], f.places[v, 1]
    lx, ly = f.places[p, 0] - x, f.places[p, 1] - y
    least = WIDE
    while f.inner[t]:
        c = corner_of(f.faces, t, v)
        k = AHEAD[AHEAD[c]] if left else c  # the edge at v on the far side
        if f.fixed[t, k]:
            q = f.faces[t, k] if left else f.faces[t, AHEAD[k]]
            wx, wy = f.places[q, 0] - x, f.places[q, 1] - y
            product = np.sqrt((lx * lx + ly * ly) * (wx * wx + wy * wy))
            cosine, sine = (lx * wx + ly * wy) / product, (lx * wy - ly * wx) / product
            if cosine < 0.5 or (sine < 0.0) == left:
                break
            least = min(least, sine * sine / (2 * (1 + cosine)))
            if q == p:
                break
            lx, ly = wx, wy
        t = f.across[t, k]
    return least
