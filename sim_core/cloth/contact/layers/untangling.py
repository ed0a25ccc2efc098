"""Takes a cloth out of itself: the lines along which it passes through itself are shortened until there are none.

Repulsion keeps layers on the sides they are on, and where a fold is pressed between solids one may slip through; from
then on repulsion would hold it there. After Volino & Magnenat-Thalmann (2006), derived anew: the end Q of a piece of
such a line, where an edge along E passes through a face with normal N, moves by

    dQ = de + E (N . (df - de)) / (N . E)

when edge and face move by de and df there. The pieces start from Q along R (unit, one for each face at the edge), so
that the line's length changes by -sum(R) . dQ, and is shortened fastest by moving edge against face along

    G = sum(R) - 2 (sum(R) . E) / (N . E) N.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.cloth.contact.constraints import Holds, bound, mirror
from sim_core.cloth.contact.layers.crossings import (
    Lists,
    crossings_by_patches,
    crossings_of,
    near_crossings,
)
from sim_core.cloth.contact.layers.pairs import Finder, Mesh
from sim_core.cloth.contact.layers.patches import Patches, Shapes
from sim_core.metrics import components

SHY = 0.5  # |G| at which half the full way is gone: where the line runs straight on there is nothing to gain
NEAR = 3.0  # of the longest edge: what is further from a crossing cannot be met on the way
PATIENCE = 8  # steps without fewer crossings after which it is left to the next frame


class Memory(NamedTuple):
    """Working memory of a search for crossings."""

    finder: Finder
    lists: Lists
    patches: Patches
    shapes: Shapes
    near: np.ndarray  # (K, 4) int32


class Untangling(NamedTuple):
    """How far it may go: in rounds of so many steps [m], and whether fewer crossings are taken, too."""

    step: float
    rounds: int
    partly: bool = False


@njit(cache=True, error_model="numpy")
def _cross(a, b):
    return np.array((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))


@njit(cache=True, error_model="numpy")
def _shortening(x, i, j, third, a, b, c):
    """G (3,) for the edge i j, whose faces' third vertices are given, through the face a b c."""
    along = x[j] - x[i]
    along /= math.sqrt((along**2).sum()) + 1e-30
    normal = _cross(x[b] - x[a], x[c] - x[a])
    normal /= math.sqrt((normal**2).sum()) + 1e-30
    into = np.zeros(3)
    for k in range(2):
        if third[k] < 0:
            continue
        side = x[third[k]] - x[i]
        line = _cross(normal, _cross(along, side))
        size = math.sqrt((line**2).sum())
        if size < 1e-12:
            continue
        inward = side - (side * along).sum() * along
        into += line * (math.copysign(1.0, (line * inward).sum()) / size)
    slope = (normal * along).sum()
    slope = math.copysign(max(abs(slope), 0.1), slope)
    return into - 2.0 * (into * along).sum() / slope * normal


@njit(cache=True, error_model="numpy")
def _shorten(x, mesh, third, lists, count, step):
    """One step of at most `step` [m] of every edge against its face; the sums are taken where all stood before."""
    (pairs, place), inverse_mass, edges, faces = lists, mesh.inverse_mass, mesh.edges, mesh.faces
    move, weight = np.zeros_like(x), np.zeros(len(x))
    for k in range(count):
        i, j = edges[pairs[k, 0]]
        a, b, c = faces[pairs[k, 1]]
        way = _shortening(x, i, j, third[pairs[k, 0]], a, b, c)
        size = math.sqrt((way**2).sum())
        way *= step / math.sqrt(size * size + SHY * SHY)
        index = (i, j, a, b, c)
        share = (1.0 - place[k, 0], place[k, 0], -place[k, 1], -place[k, 2], -place[k, 3])
        total = 0.0
        for n in range(5):
            total += share[n] * share[n] * inverse_mass[index[n]]
        if total == 0.0:
            continue
        for n in range(5):
            part = share[n] * inverse_mass[index[n]] / total
            for axis in range(3):
                move[index[n], axis] += part * way[axis]
            weight[index[n]] += 1.0
    for i in range(len(x)):
        if weight[i] > 0.0:
            # Pairs along one line ask for the same way: taken once, not as often as there are pairs.
            gain = 1.0 / math.sqrt(weight[i])
            for axis in range(3):
                x[i, axis] += gain * move[i, axis]


def _stop_going_back(way: np.ndarray, v: np.ndarray) -> None:
    """Takes from v (V, 3) what goes against the way (V, 3) that a vertex was moved."""
    size = np.sqrt((way * way).sum(1))
    moved = size > 0.0
    along = way[moved] / size[moved, None]
    v[moved] -= np.minimum((along * v[moved]).sum(1), 0.0)[:, None] * along


def _together_with(left: np.ndarray, pairs: np.ndarray, edges: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Which vertices (V,) hang together with those of crossings that are left (L, 5).

    What hangs together are moved vertices (V,) at one edge (E, 2) and the five of each crossing (K, 5), then and now.
    """
    both = edges[moved[edges].all(1)]
    first = np.concatenate([both[:, 0], np.repeat(pairs[:, 0], 4)])
    second = np.concatenate([both[:, 1], pairs[:, 1:].ravel()])
    tangle = components(len(moved), first, second)
    return np.isin(tangle, tangle[left.ravel()])


def untangle(
    x: np.ndarray, v: np.ndarray, mesh: Mesh, third: np.ndarray, holds: Holds, memory: Memory, how: Untangling
) -> tuple[int, int, Lists]:
    """Moves x (V, 3) [m] in place until no edge passes through a face, as far as it is allowed to.

    Tangles stand for themselves: one that does not come free is not moved, for what springs back frame by frame would
    never come to rest.
    v (V, 3) [m/s] loses what leads back. third (E, 2): see `faces_at_edges`. Returns how many crossings there were
    before, and are now, and the lists, longer ones where they were full.
    """
    finder, patches, shapes = memory.finder, memory.patches, memory.shapes
    lists, _, count = crossings_by_patches(x, mesh, patches, shapes, memory.near, memory.lists)
    if not count:
        return 0, 0, lists
    lists, count = crossings_of(x, mesh, finder, lists)  # by the count that the end is judged by
    first = least = count
    edges, faces = mesh.edges, mesh.faces
    start, best, late = x.copy(), x.copy(), 0
    reach = NEAR * float(np.sqrt(((x[edges[:, 0]] - x[edges[:, 1]]) ** 2).sum(1).max()))
    tangled = lists[0][:count].copy()
    near_edges, near_faces = (
        near_crossings(x, shape, edges[tangled[:, 0]], reach) for shape in (edges, faces)
    )
    near, third = mesh._replace(edges=edges[near_edges], faces=faces[near_faces]), third[near_edges]
    for _ in range(how.rounds):
        lists, count = crossings_of(x, near, finder, lists)
        if count < least:
            best[:], least, late = x, count, 0
        if not count or late > PATIENCE:
            break
        late += 1
        _shorten(x, near, third, lists, count, how.step)
        bound(holds, x, v)
        mirror(holds, x, v)
    x[:] = best
    if least and not how.partly:
        (pairs, place), count = crossings_of(best, near, finder, lists)
        left = np.concatenate([near.edges[pairs[:count, 0]], near.faces[pairs[:count, 1]]], axis=1)
        begun = np.concatenate([edges[tangled[:, 0]], faces[tangled[:, 1]]], axis=1)
        back = _together_with(left, np.concatenate([begun, left]), near.edges, (x != start).any(1))
        x[back] = start[back]
        lists, least = crossings_of(x, mesh, finder, (pairs, place))
        if least >= first:
            x[:], least = start, first
    _stop_going_back(x - start, v)
    return first, least, lists
