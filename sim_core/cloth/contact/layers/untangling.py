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
from sim_core.cloth.contact.layers.near_pairs import listed_within
from sim_core.cloth.contact.layers.pairs import Finder, Mesh, hash_points, near_balls, within_box
from sim_core.cloth.contact.layers.patch_places import flat_pair, patch_pairs, place_patches
from sim_core.cloth.contact.layers.patches import CONE, Patches, Shapes
from sim_core.metrics import components

SHY = 0.5  # |G| at which half the full way is gone: where the line runs straight on there is nothing to gain
NEAR = 3.0  # of the longest edge: what is further from a crossing cannot be met on the way
FRESH = 0.8  # of the skin, that lists which have just been begun are sure of
PATIENCE = 8  # steps without fewer crossings after which it is left to the next frame


Lists = tuple[np.ndarray, np.ndarray]


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


def no_crossings() -> Lists:
    """Lists for some crossings: pairs (K, 2) int32 and places (K, 4)."""
    return np.zeros((64, 2), np.int32), np.zeros((64, 4))


def faces_at_edges(edges: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """The third vertices (E, 2) int32 of the faces (F, 3) at each edge (E, 2); -1 where there is but one face."""
    count = int(faces.max()) + 1
    key = np.sort(edges, axis=1).astype(np.int64) @ [count, 1]
    order = np.argsort(key)
    third = np.full((len(edges), 2), -1, np.int32)
    sides = np.concatenate([np.roll(faces, -corner, axis=1) for corner in range(3)]).astype(np.int64)
    low, high = sides[:, :2].min(1), sides[:, :2].max(1)
    edge = order[np.searchsorted(key[order], low * count + high)]
    by_edge = np.argsort(edge, kind="stable")
    edge, corner = edge[by_edge], sides[by_edge, 2]
    again = np.concatenate(
        [[False], edge[1:] == edge[:-1]]
    )  # the second face there; a third is told elsewhere
    third[edge[~again], 0], third[edge[again], 1] = corner[~again], corner[again]
    return third


@njit(cache=True, error_model="numpy")
def _reach(x, edges, faces):
    """Half the longest edge, and the largest distance of a face's corner from its centre [m]."""
    half = wide = 0.0
    for e in range(len(edges)):
        i, j = edges[e]
        half = max(half, (x[i, 0] - x[j, 0]) ** 2 + (x[i, 1] - x[j, 1]) ** 2 + (x[i, 2] - x[j, 2]) ** 2)
    for f in range(len(faces)):
        a, b, c = faces[f]
        for k in (a, b, c):
            gap = 0.0
            for axis in range(3):
                gap += (x[k, axis] - (x[a, axis] + x[b, axis] + x[c, axis]) / 3.0) ** 2
            wide = max(wide, gap)
    return 0.5 * math.sqrt(half), math.sqrt(wide)


@njit(cache=True, error_model="numpy")
def _through(x, p, q, a, b, c):
    """Where the segment p q passes through the face a b c: share of the way along it (-1: nowhere), weights of b, c."""
    ux, uy, uz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
    wx, wy, wz = x[c, 0] - x[a, 0], x[c, 1] - x[a, 1], x[c, 2] - x[a, 2]
    nx, ny, nz = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
    dp = (x[p, 0] - x[a, 0]) * nx + (x[p, 1] - x[a, 1]) * ny + (x[p, 2] - x[a, 2]) * nz
    dq = (x[q, 0] - x[a, 0]) * nx + (x[q, 1] - x[a, 1]) * ny + (x[q, 2] - x[a, 2]) * nz
    if dp * dq >= 0.0:
        return -1.0, 0.0, 0.0
    t = dp / (dp - dq)
    mx = x[p, 0] + t * (x[q, 0] - x[p, 0]) - x[a, 0]
    my = x[p, 1] + t * (x[q, 1] - x[p, 1]) - x[a, 1]
    mz = x[p, 2] + t * (x[q, 2] - x[p, 2]) - x[a, 2]
    size = nx * nx + ny * ny + nz * nz
    v = ((my * wz - mz * wy) * nx + (mz * wx - mx * wz) * ny + (mx * wy - my * wx) * nz) / size
    w = ((uy * mz - uz * my) * nx + (uz * mx - ux * mz) * ny + (ux * my - uy * mx) * nz) / size
    if v < 0.0 or w < 0.0 or v + w > 1.0:
        return -1.0, 0.0, 0.0
    return t, v, w


@njit(cache=True, error_model="numpy")
def crossings_of(x, mesh, finder, lists):
    """Finds the pairs of an edge and a face that pass through each other and share no vertex; x (V, 3) [m].

    lists, written over: pairs (K, 2) int32 and where, place (K, 4), the share of the way along the edge and the
    weights of the face's corners. Returns both, longer where they were full, and how many there are.
    """
    (pairs, place), edges, faces, same = lists, mesh.edges, mesh.faces, mesh.same
    half, wide = _reach(x, edges, faces)
    reach, middle = half + wide, finder.by_cell
    balls = finder.balls[: len(edges)]
    for e in range(len(edges)):
        i, j = edges[e]
        length2 = 0.0
        for axis in range(3):
            balls[e, axis] = 0.5 * (x[i, axis] + x[j, axis])
            length2 += (x[i, axis] - x[j, axis]) ** 2
        balls[e, 3] = 0.5 * math.sqrt(length2)
    dims, low, cell = hash_points(balls, reach, finder)
    order, start = finder.order, finder.start
    for s in range(len(edges)):
        for c in range(4):
            middle[s, c] = balls[order[s], c]
    count = 0
    for f in range(len(faces)):
        a, b, c = faces[f]
        px = (x[a, 0] + x[b, 0] + x[c, 0]) / 3.0
        py = (x[a, 1] + x[b, 1] + x[c, 1]) / 3.0
        pz = (x[a, 2] + x[b, 2] + x[c, 2]) / 3.0
        ax, ay, az = int((px - low[0]) / cell), int((py - low[1]) / cell), int((pz - low[2]) / cell)
        for cx in range(max(ax - 1, 0), min(ax + 2, dims[0])):
            for cy in range(max(ay - 1, 0), min(ay + 2, dims[1])):
                row = (cx * dims[1] + cy) * dims[2]
                for s in range(start[row + max(az - 1, 0)], start[row + min(az + 2, dims[2])]):
                    span = wide + middle[s, 3]
                    mx, my, mz = middle[s, 0] - px, middle[s, 1] - py, middle[s, 2] - pz
                    if mx * mx + my * my + mz * mz > span * span:
                        continue
                    e = order[s]
                    i, j = edges[e]
                    si, sj, sa, sb, sc = same[i], same[j], same[a], same[b], same[c]
                    if si == sa or si == sb or si == sc or sj == sa or sj == sb or sj == sc:
                        continue
                    t, v, w = _through(x, i, j, a, b, c)
                    if t < 0.0:
                        continue
                    if count == len(pairs):
                        pairs, place = np.concatenate((pairs, pairs)), np.concatenate((place, place))
                    pairs[count, 0], pairs[count, 1] = e, f
                    place[count, 0], place[count, 1], place[count, 2], place[count, 3] = t, 1.0 - v - w, v, w
                    count += 1
    return (pairs, place), count


@njit(cache=True, error_model="numpy")
def _patch_crossings(x, mesh, patches, shapes, parts, found):
    """Adds the crossings of the edges of patch p with the faces of patch q, parts = (p, q), to lists that hold some."""
    (p, q), (pairs, place, count) = parts, found
    edges, faces, same = mesh.edges, mesh.faces, mesh.same
    edge, face, box, mine, yours = shapes.edge, shapes.face, shapes.box, shapes.some[0], shapes.some[1]
    these = within_box(edge, patches.edge_start[p], patches.edge_start[p + 1], box, q, 0.0, mine)
    those = within_box(face, patches.face_start[q], patches.face_start[q + 1], box, p, 0.0, yours)
    for k in range(near_balls(mine, these, yours, those, edge, face, 0.0, shapes.close)):
        e, f = patches.edges[shapes.close[k, 0]], patches.faces[shapes.close[k, 1]]
        i, j, a, b, c = edges[e, 0], edges[e, 1], faces[f, 0], faces[f, 1], faces[f, 2]
        si, sj, sa, sb, sc = same[i], same[j], same[a], same[b], same[c]
        if si == sa or si == sb or si == sc or sj == sa or sj == sb or sj == sc:
            continue
        t, v, w = _through(x, i, j, a, b, c)
        if t < 0.0:
            continue
        if count == len(pairs):
            pairs, place = np.concatenate((pairs, pairs)), np.concatenate((place, place))
        pairs[count, 0], pairs[count, 1] = e, f
        place[count, 0], place[count, 1], place[count, 2], place[count, 3] = t, 1.0 - v - w, v, w
        count += 1
    return pairs, place, count


@njit(cache=True, error_model="numpy")
def crossings_by_patches(x, mesh, patches, shapes, near, lists):
    """`crossings_of` a whole cloth: stretches that are flat cannot cross themselves. near (K, 4): working memory."""
    (pairs, place), count = lists, 0
    finite, along = place_patches(x, mesh, patches, shapes)
    if finite:
        near, total = patch_pairs(patches, shapes, along, 0.0, near)
        for k in range(total):
            p, q = near[k, 0], near[k, 1]
            if flat_pair(x, mesh, patches, shapes, p, q, CONE):
                continue
            found = pairs, place, count
            pairs, place, count = _patch_crossings(x, mesh, patches, shapes, (p, q), found)
            if p != q:
                found = pairs, place, count
                pairs, place, count = _patch_crossings(x, mesh, patches, shapes, (q, p), found)
    return (pairs, place), near, count


@njit(cache=True, error_model="numpy")
def _widest(x, faces):
    """The largest radius [m] of a circle within a face: twice its area over its girth."""
    widest = 0.0
    for f in range(len(faces)):
        i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
        ux, uy, uz = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
        wx, wy, wz = x[k, 0] - x[i, 0], x[k, 1] - x[i, 1], x[k, 2] - x[i, 2]
        nx, ny, nz = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
        sx, sy, sz = wx - ux, wy - uy, wz - uz
        girth = math.sqrt(ux * ux + uy * uy + uz * uz) + math.sqrt(wx * wx + wy * wy + wz * wz)
        girth += math.sqrt(sx * sx + sy * sy + sz * sz)
        widest = max(widest, math.sqrt(nx * nx + ny * ny + nz * nz) / girth)
    return widest


@njit(cache=True, error_model="numpy")
def none_crosses(x, mesh, third, near, thickness):
    """Whether lists of near pairs (`NearPairs`) show that no edge passes through a face at x (V, 3).

    Where an edge does, one of the face's own is no further from it than the circle within the face is wide, and so is
    in the list, if that goes so far. third (E, 2): see `faces_at_edges`. False: nobody knows; lists that have aged are
    begun anew in the next frame then.
    """
    edges, same, pairs = mesh.edges, mesh.same, near.now.crossings
    asked, sure = _widest(x, mesh.faces) - thickness, listed_within(x, near)
    if not asked <= sure:
        if asked <= FRESH * near.kept[0]:
            near.kept[2] = 0.0
        return False
    for k in range(near.now.count[2]):
        for n in range(2):
            e, g = pairs[k, n], pairs[k, 1 - n]
            i, j, a, b = edges[e, 0], edges[e, 1], edges[g, 0], edges[g, 1]
            for side in range(2):
                c = third[g, side]
                if (
                    c >= 0
                    and same[c] != same[i]
                    and same[c] != same[j]
                    and _through(x, i, j, a, b, c)[0] >= 0.0
                ):
                    return False
    return True


@njit(cache=True, error_model="numpy")
def near_crossings(x, shapes, crossed, reach):
    """Which of the edges or faces (N, 2 or 3) begin within `reach` [m] of an edge that is crossed, (K, 2); N bools."""
    near = np.zeros(len(shapes), np.bool_)
    for n in range(len(shapes)):
        i = shapes[n, 0]
        for k in range(len(crossed)):
            j = crossed[k, 0]
            gap2 = (x[i, 0] - x[j, 0]) ** 2 + (x[i, 1] - x[j, 1]) ** 2 + (x[i, 2] - x[j, 2]) ** 2
            if gap2 < reach * reach:
                near[n] = True
                break
    return near


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
