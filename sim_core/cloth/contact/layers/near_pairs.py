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

from sim_core.cloth.contact.layers.pairs import edges_on_edges, points_on_faces
from sim_core.cloth.contact.layers.patch_motion import apart, furthest, move_patches
from sim_core.cloth.contact.layers.patch_places import (
    between,
    flat_pair,
    patch_pairs,
    place_patch,
    place_patches,
    turn_parts,
)
from sim_core.cloth.contact.layers.patches import WHOLE, grown
from sim_core.cloth.contact.sleep import GAINED

LATE = 0.6  # of what patches may move against each other, from where on their pairs are looked for anew
SOON = 0.3  # likewise for those that are looked for along with others
KEEP, DROP, LOOK = 0, 1, 2  # what a pair of patches holds stays, is nothing, or is to be looked for


class Near(NamedTuple):
    """What may touch. Of patches: p, q, and the ends in both lists of what they hold, from the end of those before."""

    points: np.ndarray  # (K, 3) int32 vertex, face, and the step until which the pair sleeps
    crossings: np.ndarray  # (K, 3) int32 edge, edge, step
    patches: (
        np.ndarray
    )  # (K, 5) int32; while they are renewed p, q, the place in the lists before or -1, 0, what to do
    gone: (
        np.ndarray
    )  # (K,) [m] how far the patches of each have moved against each other since they were looked for
    lasts: np.ndarray  # (K,) [m] how far they may, until they are to be
    count: np.ndarray  # (3,) int64 of pairs of patches, points, crossings
    mark: np.ndarray  # (V, 3) where the cloth was when `gone` was counted last
    least: np.ndarray  # (2,) [m] how far any pair may move from there until it is due, and until it is late


class NearPairs(NamedTuple):
    """The lists, those they are renewed from, and where the cloth was when pairs of patches were looked for."""

    now: Near
    spare: Near
    begun: np.ndarray  # (V, 3)
    order: np.ndarray  # (K,) int32 working memory
    kept: (
        np.ndarray
    )  # (3,) [m] the skin and the way ahead that the lists are looked for with; 1 while they hold
    tally: (
        np.ndarray
    )  # (4,) int64 looks, renewals, those of them among other pairs of patches, pairs looked for anew


def near_pairs_of(vertices: int) -> NearPairs:
    """Empty lists, long enough for most cloths of so many vertices."""

    def near() -> Near:
        many = 2 * vertices + 64
        return Near(
            points=np.zeros((many, 3), np.int32),
            crossings=np.zeros((many, 3), np.int32),
            patches=np.zeros((many, 5), np.int32),
            gone=np.zeros(many),
            lasts=np.zeros(many),
            count=np.zeros(3, np.int64),
            mark=np.zeros((vertices, 3)),
            least=np.zeros(2),
        )

    none = np.zeros(0, np.int32)
    return NearPairs(near(), near(), np.zeros((vertices, 3)), none, np.zeros(3), np.zeros(5, np.int64))


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
    pairs, gone, lasts, skin = near.patches, near.gone, near.lasts, how.reach - how.thickness
    placed, look, box = shapes.placed, shapes.look, shapes.box
    corners, start = patches.corners, patches.corner_start
    due = through = 0
    for k in range(near.count[0]):
        if gone[k] <= SOON * lasts[k]:
            pairs[k, 4] = KEEP
            continue
        p, q = pairs[k, 0], pairs[k, 1]
        if placed[p, 0] != look[0]:
            place_patch(x, mesh, patches, shapes, p)
        if placed[q, 0] != look[0]:
            place_patch(x, mesh, patches, shapes, q)
        due += 1
        pairs[k, 4], gone[k] = DROP, 0.0
        lasts[k] = max(skin, between(x, corners, start, box, p, q) - how.thickness)
        if lasts[k] == skin and not flat_pair(x, mesh, patches, shapes, p, q, how.wide):
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
            turn_parts(x, mesh, patches, shapes, p)
            turn_parts(x, mesh, patches, shapes, q)
            points, first = points_on_faces(x, mesh, patches, shapes, how, (p, q), (points, first))
            if p != q:
                points, first = points_on_faces(x, mesh, patches, shapes, how, (q, p), (points, first))
            crossings, second = edges_on_edges(x, mesh, patches, shapes, how, (p, q), (crossings, second))
        pairs[k, 2], pairs[k, 3] = first, second
    out.count[1], out.count[2] = first, second
    out.mark[:] = x
    return Near(points, crossings, pairs, out.gone, out.lasts, out.count, out.mark, out.least)


@njit(cache=True, error_model="numpy")
def likely_way(x, v, patches, shapes, seconds):
    """How far patches go against all of them as a whole in so many seconds [m], on average, if they go on so."""
    move_patches(x, v, x, patches, shapes.moved)
    return seconds * furthest(shapes.moved, WHOLE)[1]


@njit(cache=True, error_model="numpy")
def _lengthened(near, pairs, count):
    """`Near` of `count` pairs of patches, with room for what is told of each."""
    gone, lasts = near.gone, near.lasts
    if len(gone) < count:
        gone, lasts = np.zeros(2 * count), np.zeros(2 * count)
    near.count[0] = count
    return Near(near.points, near.crossings, pairs, gone, lasts, near.count, near.mark, near.least)


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
    skin, (before, ahead, holds) = how.reach - how.thickness, near.kept
    like = 0.5 * before <= skin <= 1.5 * before and 0.5 * ahead <= how.ahead <= 1.25 * ahead
    if holds == 0.0 or how.near > 0.0 or not like:
        return False
    near.now.points[: near.now.count[1], 2] = 0
    near.now.crossings[: near.now.count[2], 2] = 0
    return True


@njit(cache=True, error_model="numpy")
def begin_pairs(x, mesh, patches, shapes, how, near):
    """All lists anew at x (V, 3); none where x is not finite: whoever checks the frame tells."""
    finite, along = place_patches(x, mesh, patches, shapes)
    near.now.count[:] = 0
    near.begun[:] = x
    near.kept[0], near.kept[1], near.kept[2] = how.reach - how.thickness, how.ahead, 0.0
    if not finite:
        return near
    pairs, count = patch_pairs(patches, shapes, along, how.reach + how.ahead, near.now.patches)
    order = _in_order(pairs, count, shapes.start, near.order)
    now = _lengthened(near.now, pairs, count)
    now.gone[:count] = np.inf
    _sifted(x, mesh, patches, shapes, how, now)
    now = _rebuilt(x, mesh, patches, shapes, how, near.spare, now)
    _margins(now)
    near.kept[2] = 1.0 if how.near == 0.0 else 0.0
    return NearPairs(now, near.spare, near.begun, order, near.kept, near.tally)


@njit(cache=True, error_model="numpy")
def renew_pairs(x, v, mesh, patches, shapes, how, near, within):
    """Renews what has moved by x (V, 3); returns the lists, and for how long [s] they hold at velocities v (V, 3).

    within: the speed [m/s] at which solids push at most, beside the velocities, and for how long [s] it is enough that
    they hold: what a quick look is sure of for so long is not looked at thoroughly.
    """
    now, moved, (pushed, enough) = near.now, shapes.moved, within
    near.tally[0] += 1
    calm = _calm_for(x, v, near.begun, now.mark, now.least, how.ahead, pushed)
    if calm >= enough:  # without a look at any patch
        return near, calm
    move_patches(x, v, near.begun, patches, moved)
    (far, total), (fast, _) = furthest(moved, 0), furthest(moved, WHOLE)
    if not math.isfinite(total):
        now.count[:] = 0
        near.kept[2] = 0.0
        return near, 1.0
    away = 2.0 * far > LATE * how.ahead
    move_patches(x, v, now.mark, patches, moved)
    late, worst = _soonest(now, moved, pushed)
    if late or away:
        near = _looked_through(x, mesh, patches, shapes, how, near, away)
        moved[:, :WHOLE] = 0.0
        _, worst = _soonest(near.now, moved, pushed)
        _margins(near.now)
        far = 0.0 if away else far
    return near, max(0.0, min(worst, (0.5 * how.ahead - far) / (2.0 * (fast + pushed) + GAINED)))


@njit(cache=True, error_model="numpy")
def _margins(near):
    """How far the patches of any pair may move against each other now, into near.least."""
    gone, lasts, due, late = near.gone, near.lasts, np.inf, np.inf
    for k in range(near.count[0]):
        due, late = min(due, LATE * lasts[k] - gone[k]), min(late, lasts[k] - gone[k])
    near.least[0], near.least[1] = due, late


@njit(cache=True, error_model="numpy")
def listed_within(x, near):
    """Up to which gap [m] beyond the thickness all pairs at x (V, 3) are in the lists; less than 0: nobody knows."""
    far = away = 0.0
    mark, begun = near.now.mark, near.begun
    for i in range(len(x)):
        far = max(
            far, (x[i, 0] - mark[i, 0]) ** 2 + (x[i, 1] - mark[i, 1]) ** 2 + (x[i, 2] - mark[i, 2]) ** 2
        )
        away = max(
            away, (x[i, 0] - begun[i, 0]) ** 2 + (x[i, 1] - begun[i, 1]) ** 2 + (x[i, 2] - begun[i, 2]) ** 2
        )
    if near.kept[2] == 0.0 or not 2.0 * math.sqrt(away) <= near.kept[1]:
        return -1.0
    return min(near.now.least[1], near.kept[0]) - 2.0 * math.sqrt(far)


@njit(cache=True, error_model="numpy")
def _calm_for(x, v, begun, mark, least, ahead, pushed):
    """For how long [s] the lists hold by what the furthest and the fastest vertex say; 0 where they cannot tell."""
    far = away = fast = 0.0
    for i in range(len(x)):
        far = max(
            far, (x[i, 0] - mark[i, 0]) ** 2 + (x[i, 1] - mark[i, 1]) ** 2 + (x[i, 2] - mark[i, 2]) ** 2
        )
        away = max(
            away, (x[i, 0] - begun[i, 0]) ** 2 + (x[i, 1] - begun[i, 1]) ** 2 + (x[i, 2] - begun[i, 2]) ** 2
        )
        fast = max(fast, v[i, 0] ** 2 + v[i, 1] ** 2 + v[i, 2] ** 2)
    far, away, fast = math.sqrt(far), math.sqrt(away), math.sqrt(fast)
    if not (2.0 * far <= least[0] and 2.0 * away <= LATE * ahead and math.isfinite(fast)):
        return 0.0
    speed = 2.0 * (2.0 * fast + pushed) + GAINED
    return max(0.0, min((least[1] - 2.0 * far) / speed, (0.5 * ahead - away) / speed))


@njit(cache=True, error_model="numpy")
def _soonest(near, moved, pushed):
    """Whether patches of any pair have moved against each other by LATE of what they may, and for how long [s] none
    moves by all of it.
    """
    pairs, gone, lasts, late, soonest = near.patches, near.gone, near.lasts, False, 1.0
    for k in range(near.count[0]):
        p, q = pairs[k, 0], pairs[k, 1]
        way, fast = gone[k] + apart(moved, p, q, 0), 2.0 * (apart(moved, p, q, WHOLE) + pushed) + GAINED
        late = late or not way <= LATE * lasts[k]
        soonest = min(soonest, (lasts[k] - way) / fast)
    return late, soonest


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
def _looked_through(x, mesh, patches, shapes, how, near, away):
    """The lists with what is SOON due looked for anew, among other pairs of patches where these have gone too far."""
    now, moved, order, pairs = near.now, shapes.moved, near.order, near.now.patches
    for k in range(now.count[0]):
        now.gone[k] += apart(moved, pairs[k, 0], pairs[k, 1], 0)
    near.tally[1] += 1
    near.tally[2] += away
    if away:
        near.begun[:] = x
        _, along = place_patches(x, mesh, patches, shapes)
        pairs, count = patch_pairs(patches, shapes, along, how.reach + how.ahead, near.spare.patches)
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
            return near
        count = now.count[0]
        spare = _lengthened(near.spare, grown(near.spare.patches, count), count)
        pairs = spare.patches
        for k in range(count):
            pairs[k, 0], pairs[k, 1], pairs[k, 2] = now.patches[k, 0], now.patches[k, 1], k
            pairs[k, 4], spare.gone[k], spare.lasts[k] = now.patches[k, 4], now.gone[k], now.lasts[k]
    near.tally[3] += due
    near.tally[4] += through
    spare = _rebuilt(x, mesh, patches, shapes, how, now, spare)
    return NearPairs(spare, now, near.begun, order, near.kept, near.tally)
