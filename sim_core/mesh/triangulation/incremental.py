"""Constrained Delaunay triangulation point by point: what growth hands over when its searches become too long.

Points go in along a Hilbert curve, in rounds of doubled size drawn by lot (Amenta, Choi, Rote 2003), so that each
costs the logarithm of their number on average however they are spread; then the seeds that are missing (Sloan 1993),
with flips in between that make every other edge Delaunay. Ties are cut as they come, which depends on places alone.
"""

import numpy as np
from numba import njit

from sim_core.mesh.geometry.predicates import orient
from sim_core.mesh.triangulation.flips import (
    AHEAD,
    Flips,
    corner_of,
    fix,
    flip,
    legal,
    walk,
    with_point,
    with_point_on,
)

__all__ = ["hull_edges", "inner_faces", "joined_points"]

BITS = 31  # of each coordinate along the Hilbert curve
AWAY = 4.0  # extents: how far the corners of the box around the points are


def joined_points(places: np.ndarray, seeds: np.ndarray, room: int = 0) -> tuple[Flips, int]:
    """Triangulate different points (n, 2), y up, with the directed edges (m, 2) among them, which cross nowhere.

    Seeds have the cloth on their left and enclose it, which `inner` tells; the box's corners are vertices n to n + 3.
    room: further vertices that may be put in.  Returns the triangulation, and the first point of a seed that could
    not be made an edge (a point lies on it, or another seed crosses it), or -1.
    """
    count = len(places)
    low, high = places.min(axis=0), places.max(axis=0)
    reach = AWAY * float((high - low).max())
    (left, bottom), (right, top) = low - reach, high + reach
    box = np.array([[left, bottom], [right, bottom], [right, top], [left, top]])
    flips = _room(np.concatenate([places, box, np.zeros((room, 2))]), count + 4)
    _insert(flips, _order(places, low, float((high - low).max())))
    seeds = np.ascontiguousarray(seeds, dtype=np.int64)
    lots = np.random.default_rng(0).permutation(len(seeds))
    lost = int(_fix_seeds(flips, seeds[lots]))
    if lost < 0:
        _flood(flips, seeds)
    return flips, lost


def inner_faces(flips: Flips) -> np.ndarray:
    """The faces (F, 3) int32 that are cloth."""
    made = int(flips.count[1])
    return flips.faces[:made][flips.inner[:made]]


def hull_edges(places: np.ndarray) -> np.ndarray:
    """The steps (m, 2) int64 around the hull of points (n, 2), y up, counter-clockwise, with all points on it."""
    order = np.lexsort((places[:, 1], places[:, 0]))
    lower, upper = _chain(places, order), _chain(places, order[::-1])
    if len(lower) + len(upper) == 2 * len(places):
        return np.zeros((0, 2), np.int64)  # all on one line
    around = np.concatenate([lower[:-1], upper[:-1]])
    return np.column_stack([around, np.roll(around, -1)])


@njit(cache=True)
def _chain(places, order):
    kept, count = np.zeros(order.size, np.int64), 0
    for v in order:
        while count > 1:
            a, b = kept[count - 2], kept[count - 1]
            if (
                orient(places[a, 0], places[a, 1], places[b, 0], places[b, 1], places[v, 0], places[v, 1])
                >= 0
            ):
                break
            count -= 1
        kept[count] = v
        count += 1
    return kept[:count].copy()


def _room(places: np.ndarray, count: int) -> Flips:
    """The two faces of the box, the last four of `count` vertices, and room for all that come."""
    most = 2 * len(places) + 8
    faces, across = np.zeros((most, 3), np.int32), np.full((most, 3), -1, np.int32)
    n = count - 4
    faces[0], faces[1] = (n, n + 1, n + 2), (n, n + 2, n + 3)
    across[0, 2], across[1, 0] = 1, 0
    fixed, inner = np.zeros((most, 3), bool), np.zeros(most, bool)
    at = np.zeros(len(places), np.int32)
    slot, queue = np.full((most, 3), -1, np.int32), np.zeros((3 * most, 2), np.int32)
    stack = np.zeros(6 * most, np.int32)
    return Flips(places, faces, across, fixed, inner, at, slot, queue, np.array([count, 2]), stack)


def _order(places: np.ndarray, low: np.ndarray, extent: float) -> np.ndarray:
    """The order in which points go in. (n,) int64"""
    count = len(places)
    cell = np.minimum((places - low) * (2.0**BITS / extent), 2.0**BITS - 1).astype(np.int64)
    key = _hilbert(cell)
    lots = np.random.default_rng(0).random(count)
    doubled = np.floor(-np.log2(np.maximum(lots, 1e-12))).astype(
        np.int64
    )  # half the points have 0, a quarter 1, …
    return np.lexsort(
        (places[:, 0], places[:, 1], key, -np.minimum(doubled, max(int(np.log2(count)) - 6, 0)))
    )


@njit(cache=True)
def _hilbert(cell):
    """How far along the Hilbert curve cells (n, 2) of a grid of 2^31 x 2^31 are."""
    found = np.zeros(cell.shape[0], np.int64)
    for m in range(cell.shape[0]):
        x, y, total = cell[m, 0], cell[m, 1], 0
        s = 1 << (BITS - 1)
        while s > 0:
            right, up = int((x & s) > 0), int((y & s) > 0)
            total += s * s * ((3 * right) ^ up)
            x, y = x & (s - 1), y & (s - 1)
            if up == 0:
                if right == 1:
                    x, y = s - 1 - x, s - 1 - y
                x, y = y, x
            s >>= 1
        found[m] = total
    return found


@njit(cache=True, error_model="numpy")
def _insert(f, order):
    t = 0
    for m in range(order.size):
        v = order[m]
        t, on, there = walk(f, t, f.places[v, 0], f.places[v, 1], False)
        top = with_point(f, t, v) if on < 0 else with_point_on(f, t, on, v)
        legal(f, top)
        t = f.at[v]


@njit(cache=True, error_model="numpy")
def _fix_seeds(f, seeds):
    """Make every seed an edge that stays; returns the first point of one that cannot be, or -1."""
    for m in range(seeds.shape[0]):
        if not _fix_seed(f, seeds[m, 0], seeds[m, 1]):
            return seeds[m, 0]
    return -1


@njit(cache=True, error_model="numpy")
def _toward(f, a, b):
    """The face at a that the segment a b enters, and a's corner in it; (t, -2 - corner) where a b is an edge of t from
    that corner, (-1, 0) where a point lies on the way."""
    places, faces = f.places, f.faces
    bx, by = places[b, 0], places[b, 1]
    t = f.at[a]
    for _ in range(f.faces.shape[0]):
        k = corner_of(faces, t, a)
        p, q = faces[t, AHEAD[k]], faces[t, AHEAD[AHEAD[k]]]
        if p == b:
            return t, -2 - k
        right = orient(places[a, 0], places[a, 1], places[p, 0], places[p, 1], bx, by)
        left = orient(places[a, 0], places[a, 1], places[q, 0], places[q, 1], bx, by)
        if right >= 0 and left <= 0 and q != b:
            if right == 0 or left == 0:
                # on the line through a and p or q: ahead of a, since b lies in this face's angle
                return -1, 0
            return t, k
        t = f.across[t, AHEAD[AHEAD[k]]]  # counter-clockwise around a
        if t < 0:
            break
    return -1, 0


@njit(cache=True, error_model="numpy")
def _fix_seed(f, a, b):
    t, k = _toward(f, a, b)
    if t < 0:
        return False
    if k <= -2:
        fix(f, t, -2 - k)
        return True
    waiting = _crossed(f, a, b, t, AHEAD[k])
    if waiting < 0:
        return False
    top = _flip_across(f, a, b, waiting)
    t, k = _toward(f, a, b)
    if t < 0 or k > -2:
        return False
    fix(f, t, -2 - k)
    legal(f, top)
    return True


@njit(cache=True, error_model="numpy")
def _crossed(f, a, b, t, k):
    """Queue the edges that a b crosses, the first of them edge k of face t; their number, or -1 where one is fixed or
    a point lies on a b."""
    places, faces = f.places, f.faces
    ax, ay, bx, by = places[a, 0], places[a, 1], places[b, 0], places[b, 1]
    waiting = 0
    while True:
        if f.fixed[t, k] or waiting >= f.queue.shape[0]:
            _forget(f, waiting)
            return -1
        f.queue[waiting, 0], f.queue[waiting, 1] = t, k
        f.slot[t, k] = waiting
        u = f.across[t, k]
        m = corner_of(faces, u, faces[t, AHEAD[k]])
        f.slot[u, m] = waiting
        waiting += 1
        over = faces[u, AHEAD[AHEAD[m]]]
        if over == b:
            return waiting
        side = orient(ax, ay, bx, by, places[over, 0], places[over, 1])
        if side == 0:
            _forget(f, waiting)
            return -1
        # edge m of u runs from left of a b to its right: leave by the edge whose ends lie on both sides
        t, k = u, AHEAD[m] if side > 0 else AHEAD[AHEAD[m]]


@njit(cache=True, error_model="numpy")
def _forget(f, waiting):
    for m in range(waiting):
        t, k = f.queue[m, 0], f.queue[m, 1]
        f.slot[t, k] = -1
        u = f.across[t, k]
        f.slot[u, corner_of(f.faces, u, f.faces[t, AHEAD[k]])] = -1


@njit(cache=True, error_model="numpy")
def _flip_across(f, a, b, waiting):
    """Flip the queued edges until none crosses a b (Sloan 1993); returns how many faces on the stack are to be made
    Delaunay again."""
    places, faces = f.places, f.faces
    ax, ay, bx, by = places[a, 0], places[a, 1], places[b, 0], places[b, 1]
    room, head, top = f.queue.shape[0], 0, 0
    tail = waiting
    while waiting > 0:
        t, k = f.queue[head, 0], f.queue[head, 1]
        head = (head + 1) % room
        p, q, c = faces[t, k], faces[t, AHEAD[k]], faces[t, AHEAD[AHEAD[k]]]
        u = f.across[t, k]
        m = corner_of(faces, u, q)
        d = faces[u, AHEAD[AHEAD[m]]]
        dx, dy, cx, cy = places[d, 0], places[d, 1], places[c, 0], places[c, 1]
        bent = orient(places[p, 0], places[p, 1], dx, dy, cx, cy) <= 0
        bent = bent or orient(dx, dy, places[q, 0], places[q, 1], cx, cy) <= 0
        if not bent:
            flip(f, t, k)
            k, m = 1, 2
            over = orient(ax, ay, bx, by, cx, cy), orient(ax, ay, bx, by, dx, dy)
            if not (over[0] > 0 and over[1] < 0 or over[0] < 0 and over[1] > 0):
                f.stack[top], f.stack[top + 1] = t, u
                top += 2
                waiting -= 1
                continue
        f.queue[tail, 0], f.queue[tail, 1] = t, k
        f.slot[t, k] = f.slot[u, m] = tail
        tail = (tail + 1) % room
    return top


@njit(cache=True, error_model="numpy")
def _flood(f, seeds):
    """Mark what lies left of the seeds, up to the edges that stay."""
    top = 0
    for m in range(seeds.shape[0]):
        t, k = _toward(f, seeds[m, 0], seeds[m, 1])
        if t >= 0 and k <= -2 and not f.inner[t]:
            f.inner[t] = True
            f.stack[top] = t
            top += 1
            while top > 0:
                top -= 1
                t = f.stack[top]
                for k in range(3):
                    u = f.across[t, k]
                    if u >= 0 and not f.fixed[t, k] and not f.inner[u]:
                        f.inner[u] = True
                        f.stack[top] = u
                        top += 1
