"""Points where angles are small: Delaunay refinement, whose sizes grow away from small features by themselves.

A triangle with a small angle gets a point in the middle of its circle, or nearer where the angle already comes out
right from there (off-centres, Üngör 2009). Where that point would lie in the circle over a step as diameter, or
beyond it, the step is divided instead (Ruppert 1995); steps that end in a sharp corner are divided at powers of two
from it, so that the points on both sides of the corner lie on the same circles around it (Shewchuk 2002). Those that
end in a narrow one stay when dividing them would only make the corner ask for more (`corners.py`).
"""

from heapq import heappop, heappush
from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.mesh.improvement.angles import edge_keys, sharp_corners
from sim_core.mesh.improvement.corners import flat_over, held
from sim_core.mesh.triangulation.flips import (
    AHEAD,
    KEPT,
    Flips,
    corner_of,
    enlarged,
    legal,
    longer,
    walk,
    with_point,
    with_point_on,
)
from sim_core.mesh.triangulation.incremental import joined_points

__all__ = ["Refined", "refined"]

WANTED = np.cos(np.radians(30.5))
OFF = 0.475 * np.sqrt((1 + WANTED) / (1 - WANTED))  # of the shortest side: height of an off-centre above it
FINER = 16.0  # times: from one round to the next sides get shorter
ROUNDS = 7  # the last goes down to 4e-9 of the edge: contours have no points nearer than 1e-7 of their extent
HOPELESS = 4  # times the points that may be put in: a round that seems to need so many is not begun
DOUBLING = 8  # points put in for each time that sides double away from a short one
ROOM = 4096  # points there is room for at first


class Refined(NamedTuple):
    """places: (V', 2), y up, those that were given first.  divided: (k, 3) int, steps from first to second point that
    were divided at the third, in order."""

    places: np.ndarray
    divided: np.ndarray


def refined(
    places: np.ndarray, steps: np.ndarray, kept: np.ndarray, edge: float, most: int
) -> Refined | None:
    """Put points in until no angle is below 30 degrees, but those that outline and inner lines have by themselves.

    places: (V, 2), y up, different.  steps: (m, 2) directed, the cloth on their left, inner lines both ways.
    kept: (m,) bool, steps that must not be divided.  edge: [m] wanted; triangles with a side below a 16th of it get
    no points in the first round; that falls to a 16th in each of seven.  most: points that may be put in; a round that
    takes more, as long slits do that are far narrower than the edge, is undone and the last.
    Returns None where the steps are no edges of a triangulation.
    """
    flips, lost = joined_points(places, steps, min(most, ROOM))
    if lost >= 0:
        return None
    count = len(places)
    _keep(flips, steps[kept])
    sharp = longer(sharp_corners(places, steps), len(flips.places), False)
    divided = np.zeros((len(flips.places) - count, 3), np.int64)
    made, end, least = 0, count + 4, edge
    for _ in range(ROUNDS):
        least /= FINER
        if _needed(flips, least) > HOPELESS * most:
            break
        more, closed = made, False
        while not closed and flips.count[0] < count + 4 + most:
            if flips.count[0] == len(flips.places):
                room = min(count + 4 + most, 2 * len(flips.places))
                flips = enlarged(flips, room)
                sharp = longer(sharp, room, False)
                divided = longer(divided, room - count, 0)
            more, closed = _refine(flips, sharp, divided, more, least)
        if not closed:
            break
        made, end = more, int(flips.count[0])
    number = np.arange(len(flips.places))
    number[count + 4 :] -= 4  # without the box
    new = flips.places[count + 4 : end]
    return Refined(np.concatenate([places, new]), number[divided[:made]])


def _keep(f: Flips, steps: np.ndarray) -> None:
    """Mark steps (m, 2) that must not be divided, on both sides."""
    made, count = int(f.count[1]), len(f.places)
    ends = np.stack([f.faces[:made], np.roll(f.faces[:made], -1, axis=1)], axis=2)
    f.slot[:made][np.isin(edge_keys(ends, count), edge_keys(steps, count))] = KEPT


@njit(cache=True, error_model="numpy")
def _refine(f, sharp, divided, made, least):
    """Put points in; returns how many steps are divided, and whether all was done in the room there is."""
    seen = np.full(f.faces.shape[0], -1, np.int64)
    waiting, cavity = [(0.0, 0, 0, 0, 0)], [0]
    waiting.clear()
    for t in range(f.count[1]):
        _note(f, t, least, waiting)
    done = 0
    while len(waiting) and f.count[0] < f.places.shape[0]:
        square, t, a, b, c = heappop(waiting)  # the shortest side first: that makes the fewest points
        done += 1
        if f.faces[t, 0] != a or f.faces[t, 1] != b or f.faces[t, 2] != c:
            continue
        x, y = _off_centre(f, t)
        u, k, there = walk(f, t, x, y, True)
        if there and k >= 0 and f.fixed[u, k]:
            there = False
        if there:
            u2, k2 = _encroached(f, u, x, y, sharp, square, seen, done, cavity)
            if u2 >= 0:
                u, k, there = u2, k2, False
        v = f.count[0]
        if there:
            f.places[v, 0], f.places[v, 1] = x, y
            f.count[0] += 1
            top = with_point(f, u, v) if k < 0 else with_point_on(f, u, k, v)
        else:
            if k < 0 or not f.fixed[u, k] or f.slot[u, k] == KEPT:
                continue
            p, q = f.faces[u, k], f.faces[u, AHEAD[k]]
            if held(f, u, k, sharp, square) or not _divide(f, u, k, v, sharp, least):
                continue
            divided[made, 0], divided[made, 1], divided[made, 2] = p, q, v
            made += 1
            f.count[0] += 1
            top = with_point_on(f, u, k, v)
            heappush(waiting, (square, t, a, b, c))  # looked at again, if it is still there
        legal(f, top)
        _note_around(f, v, least, waiting)
    return made, len(waiting) == 0


@njit(cache=True, error_model="numpy")
def _needed(f, least):
    """About how many points the small angles need."""
    waiting, total = [(0.0, 0, 0, 0, 0)], 0.0
    for t in range(f.count[1]):
        waiting.clear()
        _note(f, t, least, waiting)
        if len(waiting):
            total += _needed_along(f, t)
    return total


@njit(cache=True, error_model="numpy")
def _needed_along(f, t):
    """What a face with a short side needs: a few points for each time that sides double away from it, and where a
    long side is a step, so that the face is a piece of a slit, one for each width that the slit is long there."""
    k, square, _, both = _shortest(f, t)
    short, long_ = np.sqrt(square), np.sqrt(both / 2)
    total = DOUBLING * np.log2(max(long_ / short, 2.0))
    i, j = AHEAD[k], AHEAD[AHEAD[k]]
    if f.fixed[t, i] != f.fixed[t, j]:
        # the slit is as wide at the far end as the next face's side from the apex to the other wall
        over = j if f.fixed[t, i] else i
        u, apex = f.across[t, over], f.faces[t, j]
        far = f.faces[u, AHEAD[AHEAD[corner_of(f.faces, u, f.faces[t, AHEAD[over]])]]]
        wide = np.hypot(f.places[far, 0] - f.places[apex, 0], f.places[far, 1] - f.places[apex, 1])
        ratio = wide / short
        total += long_ / short * (np.log(ratio) / (ratio - 1) if abs(ratio - 1) > 1e-6 else 1.0)
    return total


@njit(cache=True, error_model="numpy")
def _note_around(f, v, least, waiting):
    """Note the faces around a vertex that have a small angle."""
    first = f.at[v]
    t = first
    while True:
        _note(f, t, least, waiting)
        t = f.across[t, AHEAD[AHEAD[corner_of(f.faces, t, v)]]]
        if t == first or t < 0:
            return


@njit(cache=True, error_model="numpy")
def _shortest(f, t):
    """The corner where the shortest side of face t begins, and the squares of that side and the two others."""
    best, least, product, total = 0, np.inf, 1.0, 0.0
    for k in range(3):
        a, b = f.faces[t, k], f.faces[t, AHEAD[k]]
        square = (f.places[a, 0] - f.places[b, 0]) ** 2 + (f.places[a, 1] - f.places[b, 1]) ** 2
        total += square
        product *= square
        if square < least:
            best, least = k, square
    return best, least, product / least, total - least


@njit(cache=True, error_model="numpy")
def _note(f, t, least, waiting):
    """Put a face on the list if its smallest angle is too small and none of the outline's own."""
    if not f.inner[t]:
        return
    k, square, others, both = _shortest(f, t)
    # the smallest angle lies opposite the shortest side
    if both - square <= 2 * WANTED * np.sqrt(others) or square < least * least:
        return
    if f.fixed[t, AHEAD[k]] and f.fixed[t, AHEAD[AHEAD[k]]]:
        # the corner's own angle; the next larger one, between the shortest and the longest side, is not
        longest = 0.5 * (both + np.sqrt(max(both * both - 4 * others, 0.0)))
        middle = both - longest
        if longest + square - middle <= 2 * WANTED * np.sqrt(longest * square):
            return
    a, b, c = np.int64(f.faces[t, 0]), np.int64(f.faces[t, 1]), np.int64(f.faces[t, 2])
    heappush(waiting, (square, np.int64(t), a, b, c))


@njit(cache=True, error_model="numpy")
def _off_centre(f, t):
    """Where a point opens the smallest angle of face t: the middle of its circle, or nearer to its shortest side."""
    k = _shortest(f, t)[0]
    a, b, c = f.faces[t, k], f.faces[t, AHEAD[k]], f.faces[t, AHEAD[AHEAD[k]]]
    ax, ay = f.places[a, 0], f.places[a, 1]
    ux, uy, wx, wy = f.places[b, 0] - ax, f.places[b, 1] - ay, f.places[c, 0] - ax, f.places[c, 1] - ay
    us, ws, area = ux * ux + uy * uy, wx * wx + wy * wy, ux * wy - uy * wx
    x, y = (wy * us - uy * ws) / (2 * area), (ux * ws - wx * us) / (2 * area)
    near_x, near_y = 0.5 * ux - OFF * uy, 0.5 * uy + OFF * ux
    if near_x * near_x + near_y * near_y < x * x + y * y:
        x, y = near_x, near_y
    return ax + x, ay + y


@njit(cache=True, error_model="numpy")
def _encroached(f, t, x, y, sharp, square, seen, stamp, cavity):
    """A fixed edge whose diametral circle holds (x, y), among those around the faces whose circles do: (face, edge),
    (-1, -1) where there is none, (face, -1) where one is too near that stays (`corners.py`). square: of the side that
    asks.  seen: (m,) marks of faces; stamp: of this search."""
    cavity.clear()
    cavity.append(t)
    seen[t] = stamp
    while len(cavity):
        t = cavity.pop()
        for k in range(3):
            a, b = f.faces[t, k], f.faces[t, AHEAD[k]]
            px, py, qx, qy = f.places[a, 0] - x, f.places[a, 1] - y, f.places[b, 0] - x, f.places[b, 1] - y
            u = f.across[t, k]
            if f.fixed[t, k]:
                if px * qx + py * qy < 0.0:
                    stays = held(f, t, k, sharp, square)
                    if not stays or flat_over(f, a, b, x, y):
                        return t, -1 if stays else k
                continue
            if u < 0 or seen[u] == stamp:
                continue
            c = f.faces[u, AHEAD[AHEAD[corner_of(f.faces, u, b)]]]
            rx, ry = f.places[c, 0] - x, f.places[c, 1] - y
            ps, qs, rs = px * px + py * py, qx * qx + qy * qy, rx * rx + ry * ry
            # b a c runs counter-clockwise
            if qs * (px * ry - py * rx) + ps * (rx * qy - ry * qx) + rs * (qx * py - qy * px) > 0.0:
                seen[u] = stamp
                cavity.append(u)
    return -1, -1


@njit(cache=True, error_model="numpy")
def _divide(f, t, k, v, sharp, least):
    """Where to divide edge k of face t goes to vertex v; False where the halves would be too short."""
    a, b = f.faces[t, k], f.faces[t, AHEAD[k]]
    ux, uy = f.places[b, 0] - f.places[a, 0], f.places[b, 1] - f.places[a, 1]
    length = np.hypot(ux, uy)
    if length < 2 * least:
        return False
    part = 0.5
    if sharp[a] != sharp[b]:
        part = 2.0 ** np.floor(np.log2(length * 2 / 3)) / length
        if sharp[b]:
            part = 1 - part
    f.places[v, 0], f.places[v, 1] = f.places[a, 0] + part * ux, f.places[a, 1] + part * uy
    return True
