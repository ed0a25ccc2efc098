"""Lists of what may touch, renewed pair of patches by pair of patches where these have moved against each other.

A pair of a vertex and a face, or of two edges, stays in its list until the patches that they are of have moved against
each other by as much as the list looks further than the cloth touches. A sleeve that swings is not looked through anew
for that: its layers go together.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.cloth.contact.layers.foresight import (
    STRAIN,
    Course,
    course_of,
    on_course,
    set_out,
    strayed,
    twisted,
    unsure_pairs,
)
from sim_core.cloth.contact.layers.jerks import Jerks, jerks_of
from sim_core.cloth.contact.layers.pairs import edges_on_edges, fold_room, points_on_faces
from sim_core.cloth.contact.layers.patch_motion import apart, furthest, going_patches, move_patches
from sim_core.cloth.contact.layers.patch_places import between, flat_pair, place_now, place_parts
from sim_core.cloth.contact.layers.patches import WHOLE, grown

LATE = 0.6  # of what patches may move against each other, from where on their pairs are looked for anew
SOON = 0.5  # likewise for those that are looked for along with others
KEEP, DROP, LOOK = 0, 1, 2  # what a pair of patches holds stays, is nothing, or is to be looked for


class Near(NamedTuple):
    """What may touch. Of patches: p, q, and the ends in both lists of what they hold, from the end of those before."""

    points: np.ndarray  # (K, 3) int32 vertex, face, and the step until which the pair sleeps
    crossings: np.ndarray  # (K, 3) int32 edge, edge, step
    patches: (
        np.ndarray
    )  # (K, 5) int32; while they are renewed p, q, the place in the lists before or -1, 0, what to do
    gone: np.ndarray  # (K,) [m] how far the patches of each have moved since they were looked for
    lasts: np.ndarray  # (K,) [m] how far they may, until they are to be
    ways: np.ndarray  # (K, 2) how far they have by now [m], and how fast they may go on [m/s]
    count: np.ndarray  # (3,) int64 of pairs of patches, points, crossings
    mark: np.ndarray  # (V, 3) where the cloth was when `gone` was counted last
    least: np.ndarray  # (1,) [m] how far any pair may move from there


class NearPairs(NamedTuple):
    """The lists, those they are renewed from, and where the cloth was when pairs of patches were looked for."""

    now: Near
    spare: Near
    course: Course
    jerks: Jerks
    order: np.ndarray  # (K,) int32 working memory
    # (1 + K,) int32 how many pairs are close now, then which, as far as there is room: place k in now.points,
    # or -1 - k in now.crossings
    close: np.ndarray
    kept: np.ndarray  # (2,) [m] the skin that the lists are looked for with; 1 while they hold
    tally: (
        np.ndarray
    )  # (5,) int64 looks, renewals, those among other pairs, pairs of patches looked at anew, and through


def near_pairs_of(vertices: int, edges: int, patches: int) -> NearPairs:
    """Empty lists, long enough for most cloths of so many vertices, edges and patches."""

    def near() -> Near:
        many = 2 * vertices + 64
        return Near(
            points=np.zeros((many, 3), np.int32),
            crossings=np.zeros((many, 3), np.int32),
            patches=np.zeros((many, 5), np.int32),
            gone=np.zeros(many),
            lasts=np.zeros(many),
            ways=np.zeros((many, 2)),
            count=np.zeros(3, np.int64),
            mark=np.zeros((vertices, 3)),
            least=np.zeros(1),
        )

    none = np.zeros(0, np.int32)
    return NearPairs(
        near(),
        near(),
        course_of(vertices, edges, patches),
        jerks_of(vertices),
        none,
        np.zeros(1 + 4 * vertices, np.int32),
        np.zeros(2),
        np.zeros(5, np.int64),
    )


@njit(cache=True, error_model="numpy")
def _taken(source, first, last, into, count):
    """Copies source[first:last] behind the first `count` of `into`; returns it, longer where it was full."""
    into = grown(into, count + last - first)
    for k in range(first, last):
        into[count, 0], into[count, 1], into[count, 2] = source[k, 0], source[k, 1], source[k, 2]
        count += 1
    return into, count


@njit(cache=True, error_model="numpy")
def _by_first(near, start, order):
    """Puts the places of pairs (p, q) in near.patches in order of p: those of p are order[start[p]:start[p + 1]].

    order (K,) is written over and returned, a longer one where it was full.
    """
    count = near.count[0]
    if len(order) < count:
        order = np.zeros(2 * count, np.int32)
    start[:] = 0
    for k in range(count):
        start[near.patches[k, 0] + 2] += 1
    for p in range(2, len(start)):
        start[p] += start[p - 1]
    for k in range(count):
        p = near.patches[k, 0]
        order[start[p + 1]] = k
        start[p + 1] += 1
    return order


@njit(cache=True, error_model="numpy")
def _sifted(x, mesh, patches, shapes, how, near):
    """Looks at the pairs of patches that are due: how far they may move until they are due again, and what to do with
    what they hold, into near.patches[:, 4]. Returns how many were due, and how many of them are to be looked through.
    """
    pairs, gone, lasts, ways, skin = near.patches, near.gone, near.lasts, near.ways, how.reach - how.thickness
    placed, look, box = shapes.placed, shapes.look, shapes.box
    corners, start = patches.corners, patches.corner_start
    due, through, folded = 0, 0, fold_room(how)
    for k in range(near.count[0]):
        if gone[k] <= SOON * lasts[k]:
            pairs[k, 4] = KEEP
            continue
        p, q = pairs[k, 0], pairs[k, 1]
        for part in (p, q):
            if placed[part, 0] != look[0]:
                place_now(x, mesh, patches, shapes, part)
        due += 1
        pairs[k, 4], gone[k], ways[k, 0] = DROP, 0.0, 0.0
        lasts[k] = max(skin, between(x, corners, start, box, p, q) - how.thickness)
        if lasts[k] > skin:
            continue
        if flat_pair(x, mesh, patches, shapes, p, q, how.wide):
            lasts[k] = folded
        else:
            pairs[k, 4] = LOOK
            through += 1
    return due, through


@njit(cache=True, error_model="numpy")
def _rebuilt(x, mesh, patches, shapes, how, old, out):
    """The lists of the pairs of patches in `out`, which are sifted: what `old` holds of those that are kept, others
    looked for anew. All memory of `out` is written over.
    """
    pairs, total, points, crossings = out.patches, out.count[0], out.points, out.crossings
    ends, old_points, old_crossings = old.patches, old.points, old.crossings
    placed, look = shapes.placed, shapes.look
    first = second = 0
    for k in range(total):
        if pairs[k, 4] == KEEP:
            place = pairs[k, 2]
            begin, start = (ends[place - 1, 2], ends[place - 1, 3]) if place > 0 else (0, 0)
            if ends[place, 2] > begin:
                points, first = _taken(old_points, begin, ends[place, 2], points, first)
            if ends[place, 3] > start:
                crossings, second = _taken(old_crossings, start, ends[place, 3], crossings, second)
        elif pairs[k, 4] == LOOK:
            p, q = pairs[k, 0], pairs[k, 1]
            for part in (p, q):
                if placed[part, 1] != look[0]:
                    place_parts(x, mesh, patches, shapes, part, how.near > 0.0)
            for way in range(1 if p == q else 2):
                both = (q, p) if way else (p, q)
                points, first = points_on_faces(x, mesh, patches, shapes, how, both, (points, first))
            crossings, second = edges_on_edges(x, mesh, patches, shapes, how, (p, q), (crossings, second))
        pairs[k, 2], pairs[k, 3] = first, second
    out.count[1], out.count[2] = first, second
    out.mark[:] = x
    return Near(points, crossings, pairs, out.gone, out.lasts, out.ways, out.count, out.mark, out.least)


@njit(cache=True, error_model="numpy")
def likely_way(x, v, patches, shapes, seconds):
    """How far patches go against all of them as a whole in so many seconds [m], on average, if they go on so."""
    going_patches(x, v, patches, shapes)
    return seconds * furthest(shapes.moved, WHOLE)[1]


@njit(cache=True, error_model="numpy")
def _lengthened(near, pairs, count):
    """`Near` of `count` pairs of patches, with room for what is told of each."""
    gone, lasts, ways = near.gone, near.lasts, near.ways
    if len(gone) < count:
        gone, lasts, ways = np.zeros(2 * count), np.zeros(2 * count), np.zeros((2 * count, 2))
    near.count[0] = count
    return Near(near.points, near.crossings, pairs, gone, lasts, ways, near.count, near.mark, near.least)


@njit(cache=True, error_model="numpy")
def _in_order(pairs, count, start, order):
    """Puts pairs (p, q) in the order of p, then of q, so that it tells nothing of when they were looked for.

    order (K,) is written over and returned, a longer one where it was full.
    """
    if len(order) < 4 * count:
        order = np.zeros(8 * count, np.int32)
    for column in (1, 0):  # by the last first: each pass leaves equal ones in their order
        start[:] = 0
        for k in range(count):
            start[pairs[k, column] + 1] += 1
        for p in range(1, len(start)):
            start[p] += start[p - 1]
        for k in range(count):
            p = pairs[k, column]
            order[2 * start[p]], order[2 * start[p] + 1] = pairs[k, 0], pairs[k, 1]
            start[p] += 1
        for k in range(count):
            pairs[k, 0], pairs[k, 1] = order[2 * k], order[2 * k + 1]
    return order


@njit(cache=True, error_model="numpy")
def go_on(near, how):
    """Whether the lists of the frame before hold on and are as those that would be looked for so; nobody sleeps then.

    Only where edges are long: between short ones it depends on when they are looked at which pairs count as one sheet.
    """
    skin, (before, holds) = how.reach - how.thickness, near.kept
    near.course.plan[1] = 0.0
    if holds == 0.0 or how.near > 0.0 or not 0.5 * before <= skin <= 1.5 * before:
        return False
    near.now.points[: near.now.count[1], 2] = 0
    near.now.crossings[: near.now.count[2], 2] = 0
    return True


@njit(cache=True, error_model="numpy")
def no_pairs(near, how):
    """Empties the lists: the next look makes them anew."""
    near.now.count[:] = 0
    near.course.plan[1] = 0.0
    if how.near > 0.0:  # when these are looked at may tell nothing of the frames before
        near.course.bent[:] = 0.0
    near.kept[0], near.kept[1] = how.reach - how.thickness, 1.0 if how.near == 0.0 else 0.0


@njit(cache=True, error_model="numpy")
def begin_pairs(x, mesh, patches, shapes, how, near):
    """All lists anew at x (V, 3), where the cloth stands; none where x is not finite, which others tell."""
    no_pairs(near, how)
    near.course.begun[:], near.course.going[:], near.course.allowed[:] = x, 0.0, 0.0
    return _looked_through(x, near.course.going, mesh, patches, shapes, how, near, True)


@njit(cache=True, error_model="numpy")
def renew_pairs(x, v, mesh, patches, shapes, how, near, within):
    """Renews what has moved by x (V, 3); returns the lists, for how long [s] they hold while each vertex goes straight
    on at v (V, 3), and by how much [m] it may stray meanwhile: the more, the faster it is free to.

    within: free [m/s]; of a frame, now and what is left [s].
    """
    now, moved, course, (free, time, left) = near.now, shapes.moved, near.course, within
    near.tally[0] += 1
    sure = on_course(x, v, mesh.edges, course, time, free)
    if math.isnan(sure):
        now.count[:] = 0
        near.kept[1] = 0.0
        return near, 1.0, free
    fresh, ends = sure <= 0.0, course.plan[0] + course.plan[1] - time
    if now.count[0] == 0 and not fresh:
        return near, min(sure, ends), free * sure
    move_patches(x, v, now.mark, patches, shapes)
    late = _gone_on(now, moved, free)
    if fresh:
        gone = time - course.plan[0] if course.plan[1] > 0.0 else 0.0
        ends = set_out(x, v, mesh, patches, course, gone, left, how.edge)
        course.plan[0], course.plan[1], sure = time, ends, STRAIN * how.edge / (2.0 * free)
    if late or fresh:
        near = _looked_through(x, v, mesh, patches, shapes, how, near, fresh)
        if fresh:
            moved[:, :WHOLE] = 0.0
            _gone_on(near.now, moved, free)
    sure = max(0.0, min(_soonest(near.now), sure))
    return near, min(sure, ends), free * sure


@njit(cache=True, error_model="numpy")
def _margin(near):
    """How far the patches of any pair may move against each other now, into near.least."""
    gone, lasts, late = near.gone, near.lasts, np.inf
    for k in range(near.count[0]):
        late = min(late, lasts[k] - gone[k])
    near.least[0] = late


@njit(cache=True, error_model="numpy")
def listed_within(x, edges, near):
    """Up to which gap [m] beyond the thickness all pairs at x (V, 3) are in the lists; less than 0: nobody knows."""
    far, mark, (begin, lasts, now) = 0.0, near.now.mark, near.course.plan
    for i in range(len(x)):
        far = max(
            far, (x[i, 0] - mark[i, 0]) ** 2 + (x[i, 1] - mark[i, 1]) ** 2 + (x[i, 2] - mark[i, 2]) ** 2
        )
    going, gone = near.course.going, now - begin
    away, _, _, _ = strayed(x, going, near.course, gone)
    bent, _, _ = twisted(x, going, edges, near.course, gone)
    if near.kept[1] == 0.0 or not (away <= 1.0 and bent <= 1.0 and gone <= 1.000001 * lasts):
        return -1.0
    return min(near.now.least[0], near.kept[0]) - 2.0 * math.sqrt(far)


@njit(cache=True, error_model="numpy")
def _gone_on(near, moved, free):
    """How far the patches of each pair have moved against each other since the mark, and how fast they may go on, into
    near.ways; whether any have by LATE of what they may.
    """
    pairs, gone, lasts, ways, late = near.patches, near.gone, near.lasts, near.ways, False
    for k in range(near.count[0]):
        p, q = pairs[k, 0], pairs[k, 1]
        ways[k, 0] = gone[k] + apart(moved, p, q, 0)
        ways[k, 1] = apart(moved, p, q, WHOLE) + 2.0 * free
        late = late or not ways[k, 0] <= LATE * lasts[k]
    return late


@njit(cache=True, error_model="numpy")
def _soonest(near):
    """For how long [s] no patches move against each other by all of what they may."""
    lasts, ways, soonest = near.lasts, near.ways, 1.0
    for k in range(near.count[0]):
        soonest = min(soonest, (lasts[k] - ways[k, 0]) / ways[k, 1])
    return soonest


@njit(cache=True, error_model="numpy")
def _matched(now, pairs, count, start, order, out):
    """What `now` tells of pairs (K, 5) of patches, into `out`; what it does not hold is due."""
    order = _by_first(now, start, order)
    seconds, gone, lasts = now.patches, now.gone, now.lasts
    for k in range(count):
        p, q, place = pairs[k, 0], pairs[k, 1], -1
        for n in range(start[p], start[p + 1]):
            if seconds[order[n], 1] == q:
                place = order[n]
                break
        pairs[k, 2] = place
        out.gone[k], out.lasts[k] = (gone[place], lasts[place]) if place >= 0 else (np.inf, 1.0)
    return order


@njit(cache=True, error_model="numpy")
def _looked_through(x, v, mesh, patches, shapes, how, near, fresh):
    """The lists with what is SOON due looked for anew; fresh: among those that are unsure from now on."""
    now, order = near.now, near.order
    for k in range(now.count[0]):
        now.gone[k] = now.ways[k, 0]
    near.tally[1] += 1
    near.tally[2] += fresh
    if fresh:
        until = near.course.plan[1], near.course.allowed
        pairs, count = unsure_pairs(x, v, mesh, patches, shapes, how, until, near.spare.patches)
        if count < 0:
            now.count[:] = 0
            near.kept[1] = 0.0
            return near
        order = _in_order(pairs, count, shapes.start, order)
        spare = _lengthened(near.spare, pairs, count)
        order = _matched(now, pairs, count, shapes.start, order, spare)
        due, through = _sifted(x, mesh, patches, shapes, how, spare)
    else:
        shapes.look[0] += 1
        due, through = _sifted(x, mesh, patches, shapes, how, now)
        if through == 0 and now.count[1] + now.count[2] == 0:
            near.tally[3] += due
            now.mark[:] = x
            _margin(now)
            return near
        count = now.count[0]
        spare = _lengthened(near.spare, grown(near.spare.patches, count), count)
        pairs = spare.patches
        for k in range(count):
            pairs[k, 0], pairs[k, 1], pairs[k, 2] = now.patches[k, 0], now.patches[k, 1], k
            pairs[k, 4], spare.gone[k], spare.lasts[k] = now.patches[k, 4], now.gone[k], now.lasts[k]
            spare.ways[k, 0], spare.ways[k, 1] = now.ways[k, 0], now.ways[k, 1]
    near.tally[3] += due
    near.tally[4] += through
    spare = _rebuilt(x, mesh, patches, shapes, how, now, spare)
    _margin(spare)
    return NearPairs(spare, now, near.course, near.jerks, order, near.close, near.kept, near.tally)
