"""Candidates for self-contact: vertex-triangle and edge-edge pairs nearer than a reach, of two patches; a hash grid."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.cloth.contact.closest_points import at, segment_parameters, triangle_weights
from sim_core.cloth.contact.layers.patches import CONE, grown

CELLS = 8  # of the hash grid, at most, for each thing that is looked for
FAR = 1e6  # [m] beyond it, or not a number, nothing is looked for


class Mesh(NamedTuple):
    """What contact has to know of a cloth. V vertices, E edges, F faces."""

    inverse_mass: np.ndarray  # (V,) [1/kg], 0: held
    rest: np.ndarray  # (V, 2) [m] where vertices lie in the pattern
    edges: np.ndarray  # (E, 2) int32
    faces: np.ndarray  # (F, 3) int32
    length2: np.ndarray  # (E,) [m2] squared length at rest
    same: np.ndarray  # (V,) int32, one number for vertices that count as one: both ends of what is sewn


class Finder(NamedTuple):
    """Working memory of a search, made once a run: V vertices, E edges, F faces, N the most of them."""

    balls: np.ndarray  # (E, 7)
    by_cell: np.ndarray  # (N, 7) what is looked for, sorted
    key: np.ndarray  # (N,) cell of each
    order: np.ndarray  # (N,)
    start: np.ndarray  # (cells + 1,)
    fill: np.ndarray  # (cells + 1,)


def finder_of(vertices: int, edges: int, faces: int) -> Finder:
    """Memory for a sheet of so many vertices, edges and faces."""
    most = max(vertices, edges, faces)
    cells = CELLS * most + 65
    return Finder(
        balls=np.zeros((edges, 7)),
        by_cell=np.zeros((most, 7)),
        key=np.zeros(most, np.int32),
        order=np.zeros(most, np.int32),
        start=np.zeros(cells, np.int32),
        fill=np.zeros(cells, np.int32),
    )


@njit(cache=True, error_model="numpy")
def hash_points(points, cell, finder):
    """Sorts points (N, 3 or more) into cells of `cell` [m] or, where they lie far apart, larger ones.

    finder.order and finder.start are where each cell's points are; returns the cells each way, low corner and cell.
    """
    lx = ly = lz = np.inf
    hx = hy = hz = -np.inf
    total = 0.0
    for i in range(len(points)):
        total += points[i, 0] + points[i, 1] + points[i, 2]  # NaN shows in a sum; min and max pass it over
        lx, hx = min(lx, points[i, 0]), max(hx, points[i, 0])
        ly, hy = min(ly, points[i, 1]), max(hy, points[i, 1])
        lz, hz = min(lz, points[i, 2]), max(hz, points[i, 2])
    if np.isnan(total) or not (hx - lx < FAR and hy - ly < FAR and hz - lz < FAR):
        return (0, 0, 0), (0.0, 0.0, 0.0), cell  # what blew up is told by whoever checks the frame
    most = len(finder.start) - 1
    while ((hx - lx) / cell + 1.0) * ((hy - ly) / cell + 1.0) * ((hz - lz) / cell + 1.0) > most:
        cell *= 1.25
    nx, ny, nz = int((hx - lx) / cell) + 1, int((hy - ly) / cell) + 1, int((hz - lz) / cell) + 1
    start, fill, key, order = finder.start, finder.fill, finder.key, finder.order
    start[: nx * ny * nz + 1] = 0
    for i in range(len(points)):
        k = int((points[i, 0] - lx) / cell) * ny + int((points[i, 1] - ly) / cell)
        key[i] = k * nz + int((points[i, 2] - lz) / cell)
        start[key[i] + 1] += 1
    for k in range(nx * ny * nz):
        start[k + 1] += start[k]
        fill[k] = start[k]
    for i in range(len(points)):
        order[fill[key[i]]] = i
        fill[key[i]] += 1
    return (nx, ny, nz), (lx, ly, lz), cell


@njit(error_model="numpy", inline="always")
def _one_sheet(x, rest, i, j, near2, alike):
    """Neighbours on a stretch that is neither folded nor crushed: close at rest, still at least half as far apart as
    there, normals within 60 degrees, alike being their cosine. (The outer layers of a Z-fold have equal normals.)
    """
    if not alike > 0.5:
        return False
    flat2 = (rest[i, 0] - rest[j, 0]) ** 2 + (rest[i, 1] - rest[j, 1]) ** 2
    if flat2 > near2:
        return False
    return (x[i, 0] - x[j, 0]) ** 2 + (x[i, 1] - x[j, 1]) ** 2 + (x[i, 2] - x[j, 2]) ** 2 >= 0.25 * flat2


@njit(cache=True, error_model="numpy")
def _folded(rest, first, second, thickness):
    """The gap [m] below which two neighbours are near by a fold: the thickness, but a third to a half of what the
    nearest of their corners `first` and `second` are apart at rest. On one sheet they are further apart, however it
    is curved.
    """
    least = np.inf
    for i in first:
        for j in second:
            least = min(least, (rest[i, 0] - rest[j, 0]) ** 2 + (rest[i, 1] - rest[j, 1]) ** 2)
    apart = math.sqrt(least)
    return min(max(thickness, apart / 3.0), apart / 2.0)


@njit(cache=True, error_model="numpy")
def _vertex_near_face(x, i, a, b, c, reach):
    u, v, w = triangle_weights(at(x, i), at(x, a), at(x, b), at(x, c))
    gap = 0.0
    for k in range(3):
        gap += (x[i, k] - u * x[a, k] - v * x[b, k] - w * x[c, k]) ** 2
    return gap < reach * reach


@njit(cache=True, error_model="numpy")
def _edges_near(x, a, b, c, d, reach):
    s, t = segment_parameters(at(x, a), at(x, b), at(x, c), at(x, d))
    gap = 0.0
    for k in range(3):
        gap += (x[a, k] + s * (x[b, k] - x[a, k]) - x[c, k] - t * (x[d, k] - x[c, k])) ** 2
    return gap < reach * reach


NEARER = 0.5  # of the skin, by which sides of a fold may come nearer at least before they are looked at again


class Search(NamedTuple):
    """What pairs are looked for.

    thickness [m]: below it they touch; reach [m]: up to where they are pairs; near [m]: pairs closer than this at rest
    count as one sheet while their normals agree, and are left out until they are so near that only a fold brings them
    there: did a pair that touches come and go with the angle of its fold, the fold would never rest.
    """

    thickness: float
    reach: float
    near: float
    edge: float  # [m] length of the edges at rest, on average
    wide: float = CONE  # cosine of the angle that normals may be apart in a stretch that cannot meet itself


@njit(cache=True, error_model="numpy")
def fold_room(how):
    """How far [m] sides of the narrowest fold that counts as flat may come nearer before they touch, the skin at most.

    Cloth that cannot meet itself is looked at again after so much: a fold is as wide as that an edge's height from its
    crease.
    """
    skin, opening = how.reach - how.thickness, math.pi - math.acos(how.wide)
    room = math.sqrt(3.0) * how.edge * math.sin(0.5 * opening) - how.thickness
    return min(skin, max(NEARER * skin, room))


@njit(cache=True, error_model="numpy")
def within_box(parts, first, last, box, p, reach, out):
    """Which of the balls parts[first:last] come within `reach` of box[p], into out; how many."""
    count = 0
    lx, ly, lz = box[p, 0] - reach, box[p, 1] - reach, box[p, 2] - reach
    hx, hy, hz = box[p, 3] + reach, box[p, 4] + reach, box[p, 5] + reach
    for n in range(first, last):
        px, py, pz, r = parts[n, 0], parts[n, 1], parts[n, 2], parts[n, 3]
        if px > lx - r and px < hx + r and py > ly - r and py < hy + r and pz > lz - r and pz < hz + r:
            out[count] = n
            count += 1
    return count


@njit(cache=True, error_model="numpy")
def near_balls(first, these, second, those, one, other, reach, out):
    """Pairs (n, m) whose balls one[n] and other[m] come within reach, of n in first[:these] and m in second[:those],
    into out (K, 2); how many.
    """
    count = 0
    for a in range(these):
        n = first[a]
        px, py, pz, half = one[n, 0], one[n, 1], one[n, 2], one[n, 3] + reach
        for b in range(those):
            m = second[b]
            dx, dy, dz, span = other[m, 0] - px, other[m, 1] - py, other[m, 2] - pz, half + other[m, 3]
            if dx * dx + dy * dy + dz * dz <= span * span:
                out[count, 0], out[count, 1] = n, m
                count += 1
    return count


@njit(error_model="numpy", inline="always")
def _slab(x, patches, box, p, q):
    """The way from the middle of patch p to that of q, its length, and how far q begins and p ends along it."""
    corners, start = patches.corners, patches.corner_start
    dx, dy, dz = (
        box[q, 0] + box[q, 3] - box[p, 0] - box[p, 3],
        box[q, 1] + box[q, 4] - box[p, 1] - box[p, 4],
        box[q, 2] + box[q, 5] - box[p, 2] - box[p, 5],
    )
    high, low = -np.inf, np.inf
    for n in range(start[p], start[p + 1]):
        i = corners[n]
        high = max(high, dx * x[i, 0] + dy * x[i, 1] + dz * x[i, 2])
    for n in range(start[q], start[q + 1]):
        i = corners[n]
        low = min(low, dx * x[i, 0] + dy * x[i, 1] + dz * x[i, 2])
    return (dx, dy, dz), math.sqrt(dx * dx + dy * dy + dz * dz), low, high


@njit(cache=True, error_model="numpy")
def _segments_beyond(edge, these, count, way, least):
    """Which of the edges in these[:count] come beyond `least` along a way; how many, first in the list."""
    kept, (dx, dy, dz) = 0, way
    for a in range(count):
        n = these[a]
        along = dx * edge[n, 0] + dy * edge[n, 1] + dz * edge[n, 2]
        along += abs(dx * edge[n, 7] + dy * edge[n, 8] + dz * edge[n, 9])
        if along >= least:
            these[kept] = n
            kept += 1
    return kept


@njit(cache=True, error_model="numpy")
def near_segments(first, these, second, those, edge, reach, own, out):
    """Likewise of edges (E, 10) of which no plane across the way from middle to middle shows that they do not.

    own: both are of one patch, and each pair is wanted once.
    """
    count, reach2 = 0, reach * reach
    for a in range(these):
        n = first[a]
        px, py, pz, half = edge[n, 0], edge[n, 1], edge[n, 2], edge[n, 3] + reach
        ux, uy, uz = edge[n, 7], edge[n, 8], edge[n, 9]
        for b in range(a + 1 if own else 0, those):
            m = second[b]
            dx, dy, dz, span = edge[m, 0] - px, edge[m, 1] - py, edge[m, 2] - pz, half + edge[m, 3]
            way2 = dx * dx + dy * dy + dz * dz
            if way2 > span * span:
                continue
            left = way2 - abs(dx * ux + dy * uy + dz * uz)
            left -= abs(dx * edge[m, 7] + dy * edge[m, 8] + dz * edge[m, 9])
            if left > 0.0 and left * left > reach2 * way2:
                continue
            out[count, 0], out[count, 1] = n, m
            count += 1
    return count


@njit(error_model="numpy", inline="always")
def _square(a, n, b, m):
    return (a[n, 0] - b[m, 0]) ** 2 + (a[n, 1] - b[m, 1]) ** 2 + (a[n, 2] - b[m, 2]) ** 2


@njit(error_model="numpy", inline="always")
def _alike(a, n, b, m):
    """The cosine between the normals of two parts."""
    return a[n, 4] * b[m, 4] + a[n, 5] * b[m, 5] + a[n, 6] * b[m, 6]


@njit(error_model="numpy", inline="always")  # calls would count references to every array of the records
def points_on_faces(x, mesh, patches, shapes, how, parts, found):
    """Adds the (vertex, face) pairs of the vertices of patch p and the faces of patch q, parts = (p, q), to a list
    (K, 3) that holds some; returns it, a longer one where it was full, and how many there are.
    """
    (p, q), (pairs, count) = parts, found
    rest, faces, same, near2, reach = mesh.rest, mesh.faces, mesh.same, how.near**2, how.reach
    vertex, face, box, out = shapes.vertex, shapes.face, shapes.box, shapes.close
    mine, yours = shapes.some[0], shapes.some[1]
    these = within_box(vertex, patches.vertex_start[p], patches.vertex_start[p + 1], box, q, reach, mine)
    those = within_box(face, patches.face_start[q], patches.face_start[q + 1], box, p, reach, yours)
    own, of, sheets = patches.vertices, patches.faces, near2 > 0.0
    for b in range(near_balls(mine, these, yours, those, vertex, face, reach, out)):
        n, m = out[b, 0], out[b, 1]
        i, f, far = own[n], of[m], reach
        j, k, h = faces[f, 0], faces[f, 1], faces[f, 2]
        if same[i] == same[j] or same[i] == same[k] or same[i] == same[h]:
            continue
        if sheets and _one_sheet(x, rest, i, j, near2, _alike(vertex, n, face, m)):
            far = min(reach, _folded(rest, (i,), (j, k, h), how.thickness))
            if _square(vertex, n, face, m) > (face[m, 3] + far) ** 2:
                continue
        if _vertex_near_face(x, i, j, k, h, far):
            pairs = grown(pairs, count)
            pairs[count, 0], pairs[count, 1], pairs[count, 2] = i, f, 0
            count += 1
    return pairs, count


@njit(error_model="numpy", inline="always")
def edges_on_edges(x, mesh, patches, shapes, how, parts, found):
    """Likewise the (edge, edge) pairs of two patches, which may be one."""
    (p, q), (pairs, count) = parts, found
    rest, edges, same, near2, reach = mesh.rest, mesh.edges, mesh.same, how.near**2, how.reach
    edge, box, out, mine, yours = shapes.edge, shapes.box, shapes.close, shapes.some[0], shapes.some[1]
    these = within_box(edge, patches.edge_start[p], patches.edge_start[p + 1], box, q, reach, mine)
    those = within_box(edge, patches.edge_start[q], patches.edge_start[q + 1], box, p, reach, yours)
    if p != q:
        (dx, dy, dz), size, low, high = _slab(x, patches, box, p, q)
        margin = 1.000001 * reach * size
        these = _segments_beyond(edge, mine, these, (dx, dy, dz), low - margin)
        those = _segments_beyond(edge, yours, those, (-dx, -dy, -dz), -high - margin)
    of, sheets = patches.edges, near2 > 0.0
    for b in range(near_segments(mine, these, yours, those, edge, reach, p == q, out)):
        n, m = out[b, 0], out[b, 1]
        e, g, far = of[n], of[m], reach
        i, j, u, v = edges[e, 0], edges[e, 1], edges[g, 0], edges[g, 1]
        if same[i] == same[u] or same[i] == same[v] or same[j] == same[u] or same[j] == same[v]:
            continue
        if sheets and _one_sheet(x, rest, i, u, near2, _alike(edge, n, edge, m)):
            far = min(reach, _folded(rest, (i, j), (u, v), how.thickness))
            if _square(edge, n, edge, m) > (edge[n, 3] + edge[m, 3] + far) ** 2:
                continue
        if _edges_near(x, i, j, u, v, far):
            pairs = grown(pairs, count)
            pairs[count, 0], pairs[count, 1], pairs[count, 2] = e, g, 0
            count += 1
    return pairs, count
