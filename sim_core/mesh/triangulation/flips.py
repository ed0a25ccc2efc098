"""A triangulation that changes: who is across each edge, flips, splits, and the walk to a place.

What growth cannot do in bounded time (`incremental.py`) and what puts points in where angles are small
(`refinement.py`) both work on it. All decisions are signs of `orient` and `incircle`, so they are exact.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.mesh.geometry.predicates import incircle, orient

__all__ = [
    "KEPT",
    "Flips",
    "corner_of",
    "enlarged",
    "fix",
    "flip",
    "legal",
    "longer",
    "walk",
    "with_point",
    "with_point_on",
]

AHEAD = (1, 2, 0)
LONGEST = 1_000_000  # faces that a walk may pass
KEPT = -2
OF_FACES = ("faces", "across", "fixed", "inner", "slot")


class Flips(NamedTuple):
    """places: (n, 2), y up.  faces: (m, 3) int32, counter-clockwise.  across: (m, 3) int32, the face over the edge
    from corner k to the next, or -1.  fixed: (m, 3) bool, edges that stay.  inner: (m,) bool, faces that are cloth.
    at: (n,) int32, some face of each vertex.  slot: (m, 3) int32, place of an edge in a queue that flips must keep
    true; -1 for others, KEPT where it must not be divided.  queue: (q, 2) int32, face and corner.
    count: (2,) int64, vertices and faces there are.  stack: (s,) int32, room for `legal`."""

    places: np.ndarray
    faces: np.ndarray
    across: np.ndarray
    fixed: np.ndarray
    inner: np.ndarray
    at: np.ndarray
    slot: np.ndarray
    queue: np.ndarray
    count: np.ndarray
    stack: np.ndarray


def longer(array: np.ndarray, length: int, filled) -> np.ndarray:
    """An array of this length that begins with another one."""
    found = np.full((length, *array.shape[1:]), filled, array.dtype)
    found[: len(array)] = array
    return found


def enlarged(f: Flips, vertices: int) -> Flips:
    """The same triangulation with room for so many vertices. The queue must be empty: it gets more room too."""
    faces = len(f.faces) + 2 * (vertices - len(f.places))
    filled = {"across": -1, "slot": -1}
    found = {name: longer(getattr(f, name), faces, filled.get(name, 0)) for name in OF_FACES}
    found |= {"places": longer(f.places, vertices, 0), "at": longer(f.at, vertices, 0)}
    queue, stack = np.zeros((3 * faces, 2), np.int32), np.zeros(6 * faces, np.int32)
    return Flips(**found, queue=queue, count=f.count, stack=stack)


@njit(cache=True, error_model="numpy")
def corner_of(faces, t, v):
    """Which corner of face t is vertex v."""
    return 0 if faces[t, 0] == v else (1 if faces[t, 1] == v else 2)


@njit(cache=True, error_model="numpy")
def _put(f, t, k, other, fixed, slot):
    """Set what lies over edge k of face t, on both sides; `slot` travels with the edge."""
    f.across[t, k], f.fixed[t, k], f.slot[t, k] = other, fixed, slot
    if other >= 0:
        f.across[other, corner_of(f.faces, other, f.faces[t, AHEAD[k]])] = t
    if slot >= 0:
        f.queue[slot, 0], f.queue[slot, 1] = t, k


@njit(cache=True, error_model="numpy")
def flip(f, t, k):
    """Join the corners opposite to edge k of face t instead of its ends.

    Faces a b c and b a d become a d c (t, its new edge at corner 1) and d b c (the other, its new edge at corner 2).
    """
    faces = f.faces
    i, j = AHEAD[k], AHEAD[AHEAD[k]]
    a, b, c = faces[t, k], faces[t, i], faces[t, j]
    u = f.across[t, k]
    m = corner_of(faces, u, b)
    n, p = AHEAD[m], AHEAD[AHEAD[m]]
    d = faces[u, p]
    ad, ad_fixed, ad_slot = f.across[u, n], f.fixed[u, n], f.slot[u, n]
    db, db_fixed, db_slot = f.across[u, p], f.fixed[u, p], f.slot[u, p]
    bc, bc_fixed, bc_slot = f.across[t, i], f.fixed[t, i], f.slot[t, i]
    ca, ca_fixed, ca_slot = f.across[t, j], f.fixed[t, j], f.slot[t, j]
    faces[t, 0], faces[t, 1], faces[t, 2] = a, d, c
    faces[u, 0], faces[u, 1], faces[u, 2] = d, b, c
    _put(f, t, 0, ad, ad_fixed, ad_slot)
    _put(f, t, 2, ca, ca_fixed, ca_slot)
    _put(f, u, 0, db, db_fixed, db_slot)
    _put(f, u, 1, bc, bc_fixed, bc_slot)
    f.across[t, 1], f.across[u, 2] = u, t
    f.fixed[t, 1] = f.fixed[u, 2] = False
    f.slot[t, 1] = f.slot[u, 2] = -1
    f.at[a], f.at[d], f.at[c], f.at[b] = t, t, t, u


@njit(cache=True, error_model="numpy")
def legal(f, top):
    """Flip until every edge of the `top` faces on the stack, and all that changes, is locally Delaunay."""
    while top > 0:
        top -= 1
        t = f.stack[top]
        for k in range(3):
            u = f.across[t, k]
            if u < 0 or f.fixed[t, k]:
                continue
            a, b, c = f.faces[t, k], f.faces[t, AHEAD[k]], f.faces[t, AHEAD[AHEAD[k]]]
            d = f.faces[u, AHEAD[AHEAD[corner_of(f.faces, u, b)]]]
            x = f.places
            if incircle(x[a, 0], x[a, 1], x[b, 0], x[b, 1], x[c, 0], x[c, 1], x[d, 0], x[d, 1]) > 0:
                flip(f, t, k)
                if top + 2 <= f.stack.size:
                    f.stack[top], f.stack[top + 1] = t, u
                    top += 2
                break


@njit(cache=True, error_model="numpy")
def walk(f, t, x, y, inside):
    """Go from face t to the face that holds (x, y): (face, edge it lies on or -1, whether it got there).

    inside: stop at fixed edges; the face and edge where it stopped are told then.
    """
    came = -1
    for turn in range(LONGEST):
        on, ahead = -1, -1
        for m in range(3):
            k = (m + turn) % 3  # begins elsewhere each time, so that it does not go round in circles
            a, b = f.faces[t, k], f.faces[t, AHEAD[k]]
            u = f.across[t, k]
            if u == came and came >= 0:
                continue
            side = orient(f.places[a, 0], f.places[a, 1], f.places[b, 0], f.places[b, 1], x, y)
            if side < 0:
                ahead = k
                break
            if side == 0:
                on = k
        if ahead < 0:
            return t, on, True
        if inside and f.fixed[t, ahead] or f.across[t, ahead] < 0:
            return t, ahead, False
        came, t = t, f.across[t, ahead]
    return t, -1, False


@njit(cache=True, error_model="numpy")
def with_point(f, t, v):
    """Put vertex v, which lies in face t, into it: three faces."""
    a, b, c = f.faces[t, 0], f.faces[t, 1], f.faces[t, 2]
    u, w = f.count[1], f.count[1] + 1
    f.count[1] += 2
    bc, bc_fixed, bc_slot = f.across[t, 1], f.fixed[t, 1], f.slot[t, 1]
    ca, ca_fixed, ca_slot = f.across[t, 2], f.fixed[t, 2], f.slot[t, 2]
    f.faces[t, 2] = v
    f.faces[u, 0], f.faces[u, 1], f.faces[u, 2] = b, c, v
    f.faces[w, 0], f.faces[w, 1], f.faces[w, 2] = c, a, v
    f.inner[u] = f.inner[w] = f.inner[t]
    _put(f, u, 0, bc, bc_fixed, bc_slot)
    _put(f, w, 0, ca, ca_fixed, ca_slot)
    _put(f, t, 1, u, False, -1)
    _put(f, u, 1, w, False, -1)
    _put(f, w, 1, t, False, -1)
    f.fixed[t, 2], f.slot[t, 2] = False, -1
    f.at[v], f.at[a], f.at[b], f.at[c] = t, t, t, u
    f.stack[0], f.stack[1], f.stack[2] = t, u, w
    return 3


@njit(cache=True, error_model="numpy")
def with_point_on(f, t, k, v):
    """Put vertex v, which lies on edge k of face t, into it: four faces; a fixed edge stays fixed in both halves."""
    a, b = f.faces[t, k], f.faces[t, AHEAD[k]]
    over, fixed = f.across[t, k], f.fixed[t, k]
    cloth = f.inner[over]
    top = with_point(f, t, v)
    # the flat face a b v is one of the three; flipping its edge a b leaves four good ones
    for m in range(top):
        s = f.stack[m]
        for n in range(3):
            if f.faces[s, n] == a and f.faces[s, AHEAD[n]] == b:
                flip(f, s, n)  # s: a d v, over: d b v
                f.inner[s] = f.inner[over] = cloth
                if fixed:
                    fix(f, s, 2)
                    fix(f, over, 1)
                f.stack[top] = over
                return top + 1
    return top


@njit(cache=True, error_model="numpy")
def fix(f, t, k):
    """Mark an edge as fixed from both sides."""
    f.fixed[t, k] = True
    u = f.across[t, k]
    if u >= 0:
        f.fixed[u, corner_of(f.faces, u, f.faces[t, AHEAD[k]])] = True
