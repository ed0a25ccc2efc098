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
from sim_core.cloth.contact.layers.patches import (
    apart,
    between,
    flat_pair,
    grown,
    move_patches,
    patch_pairs,
    place_patches,
)
from sim_core.cloth.contact.sleep import GAINED

LATE = 0.6  # of what patches may move against each other, from where on their pairs are looked for anew
SOON = 0.3  # likewise for those that are looked for along with others


class Near(NamedTuple):
    """What may touch. Of patches: p, q, and the ends in both lists of what they hold, from the end of those before."""

    points: np.ndarray  # (K, 3) int32 vertex, face, and the step until which the pair sleeps
    crossings: np.ndarray  # (K, 3) int32 edge, edge, step
    patches: np.ndarray  # (K, 4) int32
    gone: (
        np.ndarray
    )  # (K,) [m] how far the patches of each have moved against each other since they were looked for
    lasts: np.ndarray  # (K,) [m] how far they may, until they are to be
    count: np.ndarray  # (3,) int64 of pairs of patches, points, crossings
    mark: np.ndarray  # (V, 3) where the cloth was when `gone` was counted last


class NearPairs(NamedTuple):
    """The lists, those they are renewed from, and where the cloth was when pairs of patches were looked for."""

    now: Near
    spare: Near
    begun: np.ndarray  # (V, 3)
    order: np.ndarray  # (K,) int32 working memory
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
            patches=np.zeros((many, 4), np.int32),
            gone=np.zeros(many),
            lasts=np.zeros(many),
            count=np.zeros(3, np.int64),
            mark=np.zeros((vertices, 3)),
        )

    return NearPairs(near(), near(), np.zeros((vertices, 3)), np.zeros(0, np.int32), np.zeros(4, np.int64))


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
def _rebuilt(x, mesh, patches, shapes, how, old, listed, out):
    """The lists of patch pairs: what `old` holds of each, the others looked for anew.

    listed: pairs (K, 4) and how many of them; pairs[k, 2]: the place in old.patches, or -1. They are written over,
    as all memory of `out` is.
    """
    pairs, total = listed
    points, crossings, gone, lasts, skin = out.points, out.crossings, out.gone, out.lasts, how.reach - how.thickness
    first = second = 0
    if len(gone) < total:
        gone, lasts = np.zeros(2 * total), np.zeros(2 * total)
    for k in range(total):
        p, q, place = pairs[k, 0], pairs[k, 1], pairs[k, 2]
        if place >= 0:
            begin, start = (old.patches[place - 1, 2], old.patches[place - 1, 3]) if place > 0 else (0, 0)
            if old.patches[place, 2] > begin:
                points, first = _taken(old.points, begin, old.patches[place, 2], points, first)
            if old.patches[place, 3] > start:
                crossings, second = _taken(old.crossings, start, old.patches[place, 3], crossings, second)
            gone[k], lasts[k] = old.gone[place], old.lasts[place]
        else:
            gone[k], lasts[k] = 0.0, max(skin, between(x, patches, shapes.box, p, q) - how.thickness)
        if place < 0 and lasts[k] == skin and not flat_pair(patches, shapes.cone, p, q, how.wide):
            points, first = points_on_faces(x, mesh, patches, shapes, how, (p, q), (points, first))
            if p != q:
                points, first = points_on_faces(x, mesh, patches, shapes, how, (q, p), (points, first))
            crossings, second = edges_on_edges(x, mesh, patches, shapes, how, (p, q), (crossings, second))
        pairs[k, 2], pairs[k, 3] = first, second
    out.count[0], out.count[1], out.count[2] = total, first, second
    out.mark[:] = x
    return Near(points, crossings, pairs, gone, lasts, out.count, out.mark)


@njit(cache=True, error_model="numpy")
def likely_way(x, v, patches, shapes, seconds):
    """How far patches go against the mean of all in so many seconds [m], on average, if they go on so."""
    moved, many = shapes.moved, len(patches.face_start) - 1
    move_patches(x, v, x, patches, moved)
    mx = my = mz = total = 0.0
    for p in range(many):
        mx, my, mz = mx + moved[p, 4] / many, my + moved[p, 5] / many, mz + moved[p, 6] / many
    for p in range(many):
        dx, dy, dz = moved[p, 4] - mx, moved[p, 5] - my, moved[p, 6] - mz
        total += math.sqrt(dx * dx + dy * dy + dz * dz) + moved[p, 7]
    return seconds * total / many


@njit(cache=True, error_model="numpy")
def begin_pairs(x, mesh, patches, shapes, how, near):
    """All lists anew at x (V, 3); none where x is not finite: whoever checks the frame tells."""
    finite, along = place_patches(x, mesh, patches, shapes)
    near.now.count[:] = 0
    near.begun[:] = x
    if not finite:
        return near
    pairs, count = patch_pairs(patches, shapes, along, how.reach + how.ahead, near.now.patches)
    pairs[:count, 2] = -1
    now = _rebuilt(x, mesh, patches, shapes, how, near.spare, (pairs, count), near.now)
    return NearPairs(now, near.spare, near.begun, near.order, near.tally)


@njit(cache=True, error_model="numpy")
def renew_pairs(x, v, mesh, patches, shapes, how, near, pushed):
    """Renews what has moved by x (V, 3); returns the lists, and for how long [s] they hold at velocities v (V, 3).

    pushed [m/s]: at most, by solids, beside the velocities.
    """
    now, moved = near.now, shapes.moved
    near.tally[0] += 1
    move_patches(x, v, near.begun, patches, moved)
    mx = my = mz = 0.0
    many = len(patches.face_start) - 1
    for p in range(many):
        mx, my, mz = mx + moved[p, 0] / many, my + moved[p, 1] / many, mz + moved[p, 2] / many
    far = fast = 0.0
    for p in range(many):
        dx, dy, dz = moved[p, 0] - mx, moved[p, 1] - my, moved[p, 2] - mz
        far = max(far, math.sqrt(dx * dx + dy * dy + dz * dz) + moved[p, 3])
        fast = max(fast, math.sqrt(moved[p, 4] ** 2 + moved[p, 5] ** 2 + moved[p, 6] ** 2) + moved[p, 7])
    away = 2.0 * far > LATE * how.ahead
    move_patches(x, v, now.mark, patches, moved)
    late, worst = _soonest(now, moved, pushed)
    if late or away:
        near = _looked_through(x, mesh, patches, shapes, how, near, away)
        far = 0.0 if away else far
    return near, max(0.0, min(worst, (0.5 * how.ahead - far) / (2.0 * (fast + pushed) + GAINED)))


@njit(cache=True, error_model="numpy")
def _soonest(near, moved, pushed):
    """Whether patches of any pair have moved against each other by LATE of what they may, and for how long [s] none
    moves by all of it, those left out that are looked for anew if any is.
    """
    late, soonest, lasting = False, 1.0, 1.0
    for k in range(near.count[0]):
        p, q = near.patches[k, 0], near.patches[k, 1]
        gone, fast = near.gone[k] + apart(moved, p, q, 0), 2.0 * (apart(moved, p, q, 4) + pushed) + GAINED
        most = near.lasts[k]
        late = late or not gone <= LATE * most
        soonest = min(soonest, (most - gone) / fast)
        lasting = min(lasting, (most - (gone if gone <= SOON * most else 0.0)) / fast)
    return late, lasting if late else soonest


@njit(cache=True, error_model="numpy")
def _looked_through(x, mesh, patches, shapes, how, near, away):
    """The lists with what is SOON due looked for anew, among other pairs of patches where these have gone too far."""
    now, moved = near.now, shapes.moved
    for k in range(now.count[0]):
        now.gone[k] += apart(moved, now.patches[k, 0], now.patches[k, 1], 0)
    finite, along = place_patches(x, mesh, patches, shapes)
    if not finite:
        now.count[:] = 0
        return near
    pairs, order, count = near.spare.patches, near.order, now.count[0]
    if away:
        near.begun[:] = x
        pairs, count = patch_pairs(patches, shapes, along, how.reach + how.ahead, pairs)
        order = _by_first(now, shapes.start, order)
        for k in range(count):
            pairs[k, 2] = -1
            for n in range(shapes.start[pairs[k, 0]], shapes.start[pairs[k, 0] + 1]):
                if now.patches[order[n], 1] == pairs[k, 1]:
                    pairs[k, 2] = order[n]
    else:
        pairs = grown(pairs, count)
        for k in range(count):
            pairs[k, 0], pairs[k, 1], pairs[k, 2] = now.patches[k, 0], now.patches[k, 1], k
    for k in range(count):
        place = pairs[k, 2]
        if place >= 0 and now.gone[place] > SOON * now.lasts[place]:
            pairs[k, 2] = -1
        near.tally[3] += pairs[k, 2] < 0
    near.tally[1] += 1
    near.tally[2] += away
    spare = _rebuilt(x, mesh, patches, shapes, how, now, (pairs, count), near.spare)
    return NearPairs(spare, now, near.begun, order, near.tally)
