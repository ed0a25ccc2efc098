"""Which pairs of patches cannot touch for a while, as the cloth goes now, and how long that is to be relied on.

Every vertex is taken to go on as it goes, x + t v, and to stray from there by no more than is allowed, and edges' ends
against each other by less; whether they do is looked at as often as the cloth is. Patches that stay far from each other
so, and stretches that stay so flat that they cannot meet themselves, are no pairs at all until then: of a cloth that
hangs in soft folds that is everything.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.cloth.contact.layers.patch_motion import apart, going_patches
from sim_core.cloth.contact.layers.patch_places import are_beside, between, patch_pairs, place_now, sort_along
from sim_core.cloth.contact.layers.patches import WHOLE

STRAY, STRAIN = 0.3, 0.14  # of an edge's length, that vertices, and edges' ends, may stray at least
DOUBT = 2.0  # times as far as they did lately, that they may
USUAL = 1.2  # times the mean of what patches stray by, that most should be allowed
FADING = 0.7  # of what they strayed by before, that is not forgotten
SHORTEST = 2e-4  # [s] that pairs are foreseen for
LAST_OF = 1.4  # times so long, where the frame ends then
STALE = 0.85  # of what vertices may stray, from where on pairs are foreseen anew
LATEST = 0.999  # of the time that they are foreseen for: clocks are sums


class Course(NamedTuple):
    """How the cloth went when pairs were foreseen, and what it may stray from there."""

    begun: np.ndarray  # (V, 3) [m]
    going: np.ndarray  # (V, 3) [m/s]
    tight: np.ndarray  # (V,) [1/m2] of how far each vertex may stray, the inverse square
    taut: np.ndarray  # (E,) [1/m2] likewise, each edge's end against the other
    allowed: np.ndarray  # (P, 2) [m] how far vertices of each patch may, and edges' ends
    bent: np.ndarray  # (P, 2) [m/s2] at which those of each did so lately
    plan: np.ndarray  # (3,) [s] of a frame: when that was, how long it holds, and now


def course_of(vertices: int, edges: int, patches: int) -> Course:
    """Memory for V vertices, E edges and P patches."""
    begun, going = np.zeros((vertices, 3)), np.zeros((vertices, 3))
    allowed, bent = np.zeros((patches, 2)), np.zeros((patches, 2))
    return Course(begun, going, np.zeros(vertices), np.zeros(edges), allowed, bent, np.zeros(3))


@njit(cache=True, error_model="numpy")
def strayed(x, v, course, seconds):
    """By which share of what it may the vertex that does so most has strayed at x (V, 3) from where it was going for so
    long, the share [1/s] by which one strays further, the tightest limit [1/m], and a sum that is finite where all are.
    """
    begun, going, tight = course.begun, course.going, course.tight
    far = fast = tightest = total = 0.0
    for i in range(len(x)):
        dx, dy, dz = x[i, 0] - begun[i, 0], x[i, 1] - begun[i, 1], x[i, 2] - begun[i, 2]
        ux, uy, uz = going[i, 0], going[i, 1], going[i, 2]
        dx, dy, dz = dx - seconds * ux, dy - seconds * uy, dz - seconds * uz
        ux, uy, uz = v[i, 0] - ux, v[i, 1] - uy, v[i, 2] - uz
        way2, speed2 = dx * dx + dy * dy + dz * dz, ux * ux + uy * uy + uz * uz
        total += way2 + speed2  # NaN shows in a sum; max passes it over
        far, fast, tightest = max(far, way2 * tight[i]), max(fast, speed2 * tight[i]), max(tightest, tight[i])
    return math.sqrt(far), math.sqrt(fast), math.sqrt(tightest), total


@njit(error_model="numpy", inline="always")
def _between(x, i, j):
    return x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]


@njit(cache=True, error_model="numpy")
def twisted(x, v, edges, course, seconds):
    """Likewise of the edges' ends against each other; without the sum."""
    begun, going, taut = course.begun, course.going, course.taut
    far = fast = tautest = 0.0
    for e in range(len(edges)):
        i, j = edges[e, 0], edges[e, 1]
        (dx, dy, dz), (ux, uy, uz) = _between(x, i, j), _between(v, i, j)
        (bx, by, bz), (gx, gy, gz) = _between(begun, i, j), _between(going, i, j)
        dx, dy, dz = dx - bx - seconds * gx, dy - by - seconds * gy, dz - bz - seconds * gz
        ux, uy, uz = ux - gx, uy - gy, uz - gz
        way2, speed2 = dx * dx + dy * dy + dz * dz, ux * ux + uy * uy + uz * uz
        far, fast, tautest = max(far, way2 * taut[e]), max(fast, speed2 * taut[e]), max(tautest, taut[e])
    return math.sqrt(far), math.sqrt(fast), math.sqrt(tautest)


@njit(cache=True, error_model="numpy")
def on_course(x, v, edges, course, time, free):
    """For how long [s] the cloth at x and v (V, 3) keeps to its course while each vertex goes straight on, but for
    `free` [m/s]; 0 where it does not or the course ends, NaN where x is not finite.
    """
    begun, lasts = course.plan[0], course.plan[1]
    gone = time - begun if lasts > 0.0 else 0.0
    far, fast, tightest, total = strayed(x, v, course, gone)
    if not math.isfinite(total):
        return math.nan
    if far > STALE or gone >= LATEST * lasts:
        return 0.0
    long = (1.0 - far) / (fast + free * tightest + 1e-30)
    far, fast, tautest = twisted(x, v, edges, course, gone)
    if far > STALE:
        return 0.0
    return max(1e-9, min(long, (1.0 - far) / (fast + 2.0 * free * tautest + 1e-30)))


@njit(cache=True, error_model="numpy")
def _learn(x, mesh, patches, course, seconds):
    """At what rates vertices of each patch, and edges' ends, strayed from the course in so many seconds."""
    begun, going, bent, ways = course.begun, course.going, course.bent, course.allowed
    corners, start, edges, sides = patches.corners, patches.corner_start, mesh.edges, patches.sides
    ways[:] = 0.0
    for p in range(len(bent)):
        for n in range(start[p], start[p + 1]):
            i, way2 = corners[n], 0.0
            for c in range(3):
                way2 += (x[i, c] - begun[i, c] - seconds * going[i, c]) ** 2
            ways[p, 0] = max(ways[p, 0], way2)
    for e in range(len(edges)):
        i, j, p, q = edges[e, 0], edges[e, 1], sides[e, 0], sides[e, 1]
        (dx, dy, dz), (bx, by, bz), (gx, gy, gz) = (
            _between(x, i, j),
            _between(begun, i, j),
            _between(going, i, j),
        )
        way2 = (dx - bx - seconds * gx) ** 2 + (dy - by - seconds * gy) ** 2 + (dz - bz - seconds * gz) ** 2
        ways[p, 1], ways[q, 1] = max(ways[p, 1], way2), max(ways[q, 1], way2)
    for p in range(len(bent)):
        for n in range(2):
            bent[p, n] = max(FADING * bent[p, n], 2.0 * math.sqrt(ways[p, n]) / (seconds * seconds))


@njit(cache=True, error_model="numpy")
def set_out(x, v, mesh, patches, course, seconds, most, side):
    """Begins a course at x and v (V, 3), after `seconds` of the one before (0: there was none): what each patch may
    stray, by what it did, and for how long that should do, `most` [s] at most. side [m]: the edges' mean length.
    """
    corners, start, edges, sides = patches.corners, patches.corner_start, mesh.edges, patches.sides
    allowed, bent, tight, taut, until = course.allowed, course.bent, course.tight, course.taut, most
    count, least = len(bent), (STRAY * side, STRAIN * side)
    if seconds > 0.0:
        _learn(x, mesh, patches, course, seconds)
    for n in range(2):
        mean = 0.0
        for p in range(count):
            mean += bent[p, n] / count
        if mean > 0.0:
            until = min(until, max(math.sqrt(2.0 * least[n] / (DOUBT * USUAL * mean)), SHORTEST))
    if most < LAST_OF * until:
        until = most
    tight[:] = 0.0
    for p in range(count):
        for n in range(2):
            allowed[p, n] = max(least[n], 0.5 * DOUBT * bent[p, n] * until * until)
        inverse = 1.0 / (allowed[p, 0] * allowed[p, 0])
        for n in range(start[p], start[p + 1]):
            tight[corners[n]] = max(tight[corners[n]], inverse)
    for e in range(len(edges)):
        far = min(allowed[sides[e, 0], 1], allowed[sides[e, 1], 1])
        taut[e] = 1.0 / (far * far)
    course.begun[:], course.going[:] = x, v
    return until


@njit(cache=True, error_model="numpy")
def _shear(x, v, mesh, patches, shapes):
    """How fast ends of edges of each patch go apart beside its rotation, into shapes.sheared."""
    edges, sides, moved, sheared = mesh.edges, patches.sides, shapes.moved, shapes.sheared
    sheared[:] = 0.0
    for e in range(len(edges)):
        i, j = edges[e, 0], edges[e, 1]
        (dx, dy, dz), (ux, uy, uz) = _between(x, i, j), _between(v, i, j)
        for n in range(1 if sides[e, 0] == sides[e, 1] else 2):
            p = sides[e, n]
            wx, wy, wz = moved[p, WHOLE + 3], moved[p, WHOLE + 4], moved[p, WHOLE + 5]
            gx, gy, gz = ux - (wy * dz - wz * dy), uy - (wz * dx - wx * dz), uz - (wx * dy - wy * dx)
            sheared[p] = max(sheared[p], gx * gx + gy * gy + gz * gz)
    for p in range(len(sheared)):
        sheared[p] = math.sqrt(sheared[p])


@njit(cache=True, error_model="numpy")
def _open_cones(patches, shapes, allowed, seconds):
    """How wide cones of patches open in so many seconds, half of it [rad], and how they turn, into shapes.opened.

    A face whose edges' ends go apart by d at most, beside a rotation, has tangents that change by less than g = d / h
    of their length, h its least height, and so turns by less than asin g, which is below g + 0.571 g³. Straight ways
    along a rotation w widen what lies across it, by less than w² / 2. Bays and what may be crushed are never flat.
    """
    cone, moved, sheared, opened = shapes.cone, shapes.moved, shapes.sheared, shapes.opened
    for p in range(len(opened)):
        turn2 = 0.0
        for c in range(3):
            opened[p, 1 + c], opened[p, 4 + c] = cone[p, c], seconds * moved[p, WHOLE + 3 + c]
            turn2 += opened[p, 4 + c] ** 2
        own = seconds * sheared[p] + allowed[p, 1]
        g = own / cone[p, 6] + 0.5 * turn2
        flat = g < 1.0 and own < cone[p, 7] and not patches.bay[p]
        opened[p, 0] = cone[p, 5] + g + 0.571 * g * g * g if flat else np.inf


@njit(error_model="numpy", inline="always")
def _stays_flat(opened, p, q, widest):
    """Whether no two normals of two patches, or one, get further apart than `widest` [rad]: their cones, the angle
    between these and how they turn against each other. 2 asin(c / 2) is below c + 0.143 c³.
    """
    wide = opened[p, 0] + opened[q, 0]
    if not wide < widest:
        return False
    if p == q:
        return True
    apart2 = turn2 = 0.0
    for c in range(1, 4):
        apart2 += (opened[p, c] - opened[q, c]) ** 2
        turn2 += (opened[p, 3 + c] - opened[q, 3 + c]) ** 2
    return wide + math.sqrt(apart2) * (1.0 + 0.143 * apart2) + math.sqrt(turn2) < widest


@njit(cache=True, error_model="numpy")
def _joined_by_third(start, beside, opened, p, q, widest):
    """Whether two patches that stay flat together stay so with a third that both share a vertex with."""
    for k in range(start[p], start[p + 1]):
        r = beside[k]
        if (
            are_beside(start, beside, q, r)
            and _stays_flat(opened, p, r, widest)
            and _stays_flat(opened, q, r, widest)
        ):
            return True
    return False


@njit(error_model="numpy", inline="always")
def _boxes_apart(box, p, q):
    """How far the boxes of two patches are apart along the axis where they are furthest [m]."""
    return max(
        max(box[p, 0] - box[q, 3], box[q, 0] - box[p, 3]),
        max(box[p, 1] - box[q, 4], box[q, 1] - box[p, 4]),
        max(box[p, 2] - box[q, 5], box[q, 2] - box[p, 5]),
    )


@njit(cache=True, error_model="numpy")
def _place_ahead(x, mesh, patches, shapes, seconds, allowed):
    """Where all patches are at x (V, 3), and the boxes of where they are until then, seen from what all go along with;
    sorted by these. False where x is not finite, and the axis they are sorted along.
    """
    shapes.look[0] += 1
    moved, box, ahead, low, high = shapes.moved, shapes.box, shapes.ahead, shapes.ends[0], shapes.ends[1]
    count, total, along = len(moved), 0.0, 0
    share, (mx, my, mz) = 1.0 / max(count, 1), (0.0, 0.0, 0.0)
    for p in range(count):
        mx, my, mz = (
            mx + share * moved[p, WHOLE],
            my + share * moved[p, WHOLE + 1],
            mz + share * moved[p, WHOLE + 2],
        )
    mean = (mx, my, mz)
    low[:], high[:] = np.inf, -np.inf
    for p in range(count):
        total += place_now(x, mesh, patches, shapes, p)
        turn2 = moved[p, WHOLE + 3] ** 2 + moved[p, WHOLE + 4] ** 2 + moved[p, WHOLE + 5] ** 2
        most = seconds * (moved[p, WHOLE + 6] + math.sqrt(turn2) * moved[p, WHOLE + 7]) + allowed[p, 0]
        for c in range(3):
            way = seconds * (moved[p, WHOLE + c] - mean[c])
            ahead[p, c], ahead[p, 3 + c] = (
                box[p, c] + min(0.0, way) - most,
                box[p, 3 + c] + max(0.0, way) + most,
            )
            low[c], high[c] = min(low[c], ahead[p, c]), max(high[c], ahead[p, 3 + c])
    for c in range(1, 3):
        if high[c] - low[c] > high[along] - low[along]:
            along = c
    sort_along(ahead, along, shapes.order)
    return math.isfinite(total), along


@njit(cache=True, error_model="numpy")
def unsure_pairs(x, v, mesh, patches, shapes, how, until, pairs):
    """Pairs (K, 5) of patches p <= q, or of one with itself, that may come within reach as they go from x at v (V, 3),
    or get less flat than `how` asks, until = (seconds, allowed): while nobody strays by more than allowed (P, 2) [m].

    Returns the list, a longer one where it was full, and how many there are; -1 where x is not finite.
    """
    (seconds, allowed), widest = until, math.acos(how.wide)
    going_patches(x, v, patches, shapes)
    _shear(x, v, mesh, patches, shapes)
    finite, along = _place_ahead(x, mesh, patches, shapes, seconds, allowed)
    if not finite:
        return pairs, -1
    _open_cones(patches, shapes, allowed, seconds)
    pairs, count = patch_pairs(shapes.ahead, shapes.order, along, how.reach, pairs)
    box, moved, opened, busy, kept = shapes.box, shapes.moved, shapes.opened, shapes.busy, 0
    start, beside, corners, corner_start = (
        patches.beside_start,
        patches.beside,
        patches.corners,
        patches.corner_start,
    )
    busy[:] = False
    for k in range(count):
        p, q = pairs[k, 0], pairs[k, 1]
        flat = _stays_flat(opened, p, q, widest)
        if flat and (p == q or are_beside(start, beside, p, q)):
            continue
        far = how.reach + allowed[p, 0] + allowed[q, 0] + seconds * apart(moved, p, q, WHOLE)
        if p != q and _boxes_apart(box, p, q) > far:
            continue
        if flat and _joined_by_third(start, beside, opened, p, q, widest):
            continue
        if p != q and between(x, corners, corner_start, box, p, q) > far:
            continue
        pairs[kept, 0], pairs[kept, 1] = p, q
        busy[p] = busy[q] = True
        kept += 1
    return pairs, kept
