"""Where a cloth passes through itself: pairs of edge and face, found all over it or told to be none by its lists."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from sim_core.cloth.contact.layers.near_pairs import listed_within
from sim_core.cloth.contact.layers.pairs import hash_points, near_balls, within_box
from sim_core.cloth.contact.layers.patch_places import flat_pair, patch_pairs, place_parts, place_patches
from sim_core.cloth.contact.layers.patches import CONE

FRESH = 0.8  # of the skin, that lists which have just been begun are sure of
WITHIN = 0.02  # least barycentric coordinate of a foot that counts as on the face

Lists = tuple[np.ndarray, np.ndarray]


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
    (pairs, place), count, placed, look = lists, 0, shapes.placed, shapes.look
    finite, along = place_patches(x, mesh, patches, shapes)
    if finite:
        near, total = patch_pairs(shapes.box, shapes.order, along, 0.0, near)
        for k in range(total):
            p, q = near[k, 0], near[k, 1]
            if flat_pair(x, mesh, patches, shapes, p, q, CONE):
                continue
            for part in (p, q):
                if placed[part, 1] != look[0]:
                    place_parts(x, mesh, patches, shapes, part, False)
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
    asked, sure = _widest(x, mesh.faces) - thickness, listed_within(x, mesh.edges, near)
    if not asked <= sure:
        if asked <= FRESH * near.kept[0]:
            near.kept[1] = 0.0
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


def changed_sides(before: np.ndarray, after: np.ndarray, points: np.ndarray, faces: np.ndarray) -> int:
    """How many pairs of a vertex and a face (K, 2), with feet on the face both times, have changed sides.

    Layers that changed places as a whole leave no crossing that tells of it. before, after: (V, 3) [m]; faces (F, 3).
    A vertex that slid off its face meanwhile tells nothing.
    """
    (inside, height), (still, now) = (_foot(x, points, faces) for x in (before, after))
    return int((inside & still & (height * now < 0.0)).sum())


def _foot(x: np.ndarray, points: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Whether the foot of each vertex lies on its face, and the height above (K,)."""
    a, b, c = (x[faces[points[:, 1], k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    square = np.maximum((normal**2).sum(1), 1e-300)
    way = x[points[:, 0]] - a
    v = (np.cross(way, c - a) * normal).sum(1) / square
    w = (np.cross(b - a, way) * normal).sum(1) / square
    return np.minimum(np.minimum(v, w), 1.0 - v - w) > WITHIN, (way * normal).sum(1) / np.sqrt(square)
