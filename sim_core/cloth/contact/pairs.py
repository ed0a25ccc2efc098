"""Candidates for self-contact: vertex-triangle and edge-edge pairs nearer than a reach, found on a hash grid."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

CELLS = 8  # of the hash grid, at most, for each thing that is looked for
FAR = 1e6  # [m] beyond it, or not a number, nothing is looked for


@njit(cache=True, error_model="numpy")
def segment_parameters(p1, q1, p2, q2):
    """Closest parameters (s, t) of the segments p1 q1 and p2 q2 (Ericson 2005, 5.1.9)."""
    d1x, d1y, d1z = q1[0] - p1[0], q1[1] - p1[1], q1[2] - p1[2]
    d2x, d2y, d2z = q2[0] - p2[0], q2[1] - p2[1], q2[2] - p2[2]
    rx, ry, rz = p1[0] - p2[0], p1[1] - p2[1], p1[2] - p2[2]
    a, e = d1x * d1x + d1y * d1y + d1z * d1z, d2x * d2x + d2y * d2y + d2z * d2z
    b, c = d1x * d2x + d1y * d2y + d1z * d2z, d1x * rx + d1y * ry + d1z * rz
    f = d2x * rx + d2y * ry + d2z * rz
    denominator = a * e - b * b
    s = 0.5
    if denominator > 1e-12 * a * e:
        s = min(1.0, max(0.0, (b * f - c * e) / denominator))
    t = (b * s + f) / e
    if t < 0.0:
        t, s = 0.0, min(1.0, max(0.0, -c / a))
    elif t > 1.0:
        t, s = 1.0, min(1.0, max(0.0, (b - c) / a))
    return s, t


@njit(cache=True, error_model="numpy")
def triangle_weights(p, a, b, c):
    """Barycentric weights of the point of triangle a b c closest to p (Ericson 2005, 5.1.5)."""
    abx, aby, abz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    acx, acy, acz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    x, y, z = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    d1, d2 = abx * x + aby * y + abz * z, acx * x + acy * y + acz * z
    if d1 <= 0.0 and d2 <= 0.0:
        return 1.0, 0.0, 0.0
    x, y, z = p[0] - b[0], p[1] - b[1], p[2] - b[2]
    d3, d4 = abx * x + aby * y + abz * z, acx * x + acy * y + acz * z
    if d3 >= 0.0 and d4 <= d3:
        return 0.0, 1.0, 0.0
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        v = d1 / (d1 - d3)
        return 1.0 - v, v, 0.0
    x, y, z = p[0] - c[0], p[1] - c[1], p[2] - c[2]
    d5, d6 = abx * x + aby * y + abz * z, acx * x + acy * y + acz * z
    if d6 >= 0.0 and d5 <= d6:
        return 0.0, 0.0, 1.0
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        w = d2 / (d2 - d6)
        return 1.0 - w, 0.0, w
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return 0.0, 1.0 - w, w
    v, w = vb / (va + vb + vc), vc / (va + vb + vc)
    return 1.0 - v - w, v, w


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

    face_normal: np.ndarray  # (F, 3)
    vertex_normal: np.ndarray  # (V, 3)
    centre: np.ndarray  # (F, 3)
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
        face_normal=np.zeros((faces, 3)),
        vertex_normal=np.zeros((vertices, 3)),
        centre=np.zeros((faces, 3)),
        balls=np.zeros((edges, 7)),
        by_cell=np.zeros((most, 7)),
        key=np.zeros(most, np.int32),
        order=np.zeros(most, np.int32),
        start=np.zeros(cells, np.int32),
        fill=np.zeros(cells, np.int32),
    )


def pairs_of(vertices: int) -> np.ndarray:
    """An empty list of pairs (K, 2) int32, long enough for most cloths of so many vertices."""
    return np.zeros((4 * vertices + 64, 2), np.int32)


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


@njit(cache=True, error_model="numpy")
def _grown(pairs, count):
    if count < len(pairs):
        return pairs
    wider = np.zeros((2 * len(pairs), 2), np.int32)
    wider[:count] = pairs
    return wider


@njit(cache=True, error_model="numpy")
def normals_of(x, faces, face, vertex):
    """Unit normals of faces (F, 3) and vertices (V, 3), into `face` and `vertex`."""
    vertex[:] = 0.0
    for f in range(len(faces)):
        i, j, k = faces[f]
        ax, ay, az = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
        bx, by, bz = x[k, 0] - x[i, 0], x[k, 1] - x[i, 1], x[k, 2] - x[i, 2]
        nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        for c in (i, j, k):
            vertex[c, 0] += nx
            vertex[c, 1] += ny
            vertex[c, 2] += nz
        size = math.sqrt(nx * nx + ny * ny + nz * nz) + 1e-30
        face[f, 0], face[f, 1], face[f, 2] = nx / size, ny / size, nz / size
    for i in range(len(x)):
        size = math.sqrt(vertex[i, 0] ** 2 + vertex[i, 1] ** 2 + vertex[i, 2] ** 2) + 1e-30
        for axis in range(3):
            vertex[i, axis] /= size


@njit(cache=True, error_model="numpy")
def _one_sheet(x, rest, i, j, near2, n, m):
    """Neighbours on a stretch that is neither folded nor crushed: close at rest, still at least half as far apart as
    there, normals within 60 degrees. (The outer layers of a Z-fold have equal normals.)
    """
    flat2 = (rest[i, 0] - rest[j, 0]) ** 2 + (rest[i, 1] - rest[j, 1]) ** 2
    if flat2 > near2:
        return False
    if (x[i, 0] - x[j, 0]) ** 2 + (x[i, 1] - x[j, 1]) ** 2 + (x[i, 2] - x[j, 2]) ** 2 < 0.25 * flat2:
        return False
    return n[0] * m[0] + n[1] * m[1] + n[2] * m[2] > 0.5


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
def _vertex_near_face(x, i, face, same, reach):
    a, b, c = face
    if same[i] == same[a] or same[i] == same[b] or same[i] == same[c]:
        return False
    u, v, w = triangle_weights(x[i], x[a], x[b], x[c])
    gap = 0.0
    for k in range(3):
        gap += (x[i, k] - u * x[a, k] - v * x[b, k] - w * x[c, k]) ** 2
    return gap < reach * reach


@njit(cache=True, error_model="numpy")
def vertex_face_pairs(x, mesh, thickness, reach, near, finder, pairs):
    """(vertex, face) pairs nearer than `reach`, without the faces around the vertex, into pairs (K, 2) int32.

    thickness [m]: below it they touch; near [m]: pairs closer than this at rest count as one sheet while their normals
    agree, and are left out until they are so near that only a fold brings them there: did a pair that touches come and
    go with the angle of its fold, the fold would never rest. Returns the list, a longer one where it was full, and how
    many there are.
    """
    rest, faces, same = mesh.rest, mesh.faces, mesh.same
    centre, sorted_x = finder.centre, finder.by_cell
    normals_of(x, faces, finder.face_normal, finder.vertex_normal)
    size2 = 0.0
    for f in range(len(faces)):
        a, b, c = faces[f]
        for axis in range(3):
            centre[f, axis] = (x[a, axis] + x[b, axis] + x[c, axis]) / 3.0
        for k in range(3):
            j = faces[f, k]
            gap = (
                (x[j, 0] - centre[f, 0]) ** 2 + (x[j, 1] - centre[f, 1]) ** 2 + (x[j, 2] - centre[f, 2]) ** 2
            )
            size2 = max(size2, gap)
    span = math.sqrt(size2) + reach
    dims, low, cell = hash_points(x, span, finder)
    order, start = finder.order, finder.start
    for q in range(len(x)):
        for axis in range(3):
            sorted_x[q, axis] = x[order[q], axis]
    count = 0
    for f in range(len(faces)):
        px, py, pz = centre[f, 0], centre[f, 1], centre[f, 2]
        ax, ay, az = int((px - low[0]) / cell), int((py - low[1]) / cell), int((pz - low[2]) / cell)
        for cx in range(max(ax - 1, 0), min(ax + 2, dims[0])):
            for cy in range(max(ay - 1, 0), min(ay + 2, dims[1])):
                row = (cx * dims[1] + cy) * dims[2]
                for q in range(start[row + max(az - 1, 0)], start[row + min(az + 2, dims[2])]):
                    gap = (sorted_x[q, 0] - px) ** 2 + (sorted_x[q, 1] - py) ** 2 + (sorted_x[q, 2] - pz) ** 2
                    i = order[q]
                    if gap > span * span:
                        continue
                    n, m, far = finder.vertex_normal[i], finder.face_normal[f], reach
                    if _one_sheet(x, rest, i, faces[f, 0], near * near, n, m):
                        corners = faces[f, 0], faces[f, 1], faces[f, 2]
                        far = min(reach, _folded(rest, (i,), corners, thickness))
                        if gap > (span - reach + far) ** 2:
                            continue
                    if _vertex_near_face(x, i, faces[f], same, far):
                        pairs = _grown(pairs, count)
                        pairs[count, 0], pairs[count, 1] = i, f
                        count += 1
    return pairs, count


@njit(cache=True, error_model="numpy")
def _edges_near(x, first, second, same, reach):
    a, b = first
    c, d = second
    if same[a] == same[c] or same[a] == same[d] or same[b] == same[c] or same[b] == same[d]:
        return False
    s, t = segment_parameters(x[a], x[b], x[c], x[d])
    gap = 0.0
    for k in range(3):
        gap += (x[a, k] + s * (x[b, k] - x[a, k]) - x[c, k] - t * (x[d, k] - x[c, k])) ** 2
    return gap < reach * reach


@njit(cache=True, error_model="numpy")
def _balls(x, faces, edges, finder):
    """Midpoint, half length and mean normal of every edge in columns, into finder.balls; returns the largest half."""
    face, normal, out = finder.face_normal, finder.vertex_normal, finder.balls
    normals_of(x, faces, face, normal)
    most = 0.0
    for e in range(len(edges)):
        i, j = edges[e]
        length2 = 0.0
        for c in range(3):
            out[e, c] = 0.5 * (x[i, c] + x[j, c])
            out[e, 4 + c] = 0.5 * (normal[i, c] + normal[j, c])
            length2 += (x[i, c] - x[j, c]) ** 2
        out[e, 3] = 0.5 * math.sqrt(length2)
        most = max(most, out[e, 3])
    return most


@njit(cache=True, error_model="numpy")
def edge_edge_pairs(x, mesh, thickness, reach, near, finder, pairs):
    """(edge, edge) pairs nearer than `reach` that share no vertex, into pairs (K, 2) int32.

    All else as for vertices and faces.
    """
    rest, edges, same = mesh.rest, mesh.edges, mesh.same
    cell = 2.0 * _balls(x, mesh.faces, edges, finder) + reach
    dims, low, cell = hash_points(finder.balls, cell, finder)
    order, start, balls = finder.order, finder.start, finder.by_cell
    for s in range(len(edges)):
        for c in range(7):
            balls[s, c] = finder.balls[order[s], c]
    count = 0
    for s in range(len(edges)):
        px, py, pz, half = balls[s, 0], balls[s, 1], balls[s, 2], balls[s, 3] + reach
        ax, ay, az = int((px - low[0]) / cell), int((py - low[1]) / cell), int((pz - low[2]) / cell)
        e = order[s]
        for cx in range(ax, min(ax + 2, dims[0])):
            for cy in range(max(ay - 1, 0), min(ay + 2, dims[1])):
                row = (cx * dims[1] + cy) * dims[2]
                # Only what comes later in the order, so that every pair is met once.
                for q in range(max(start[row + max(az - 1, 0)], s + 1), start[row + min(az + 2, dims[2])]):
                    gap = (balls[q, 0] - px) ** 2 + (balls[q, 1] - py) ** 2 + (balls[q, 2] - pz) ** 2
                    span = half + balls[q, 3]
                    if gap > span * span:
                        continue
                    g, far = order[q], reach
                    (a, b), (c, d) = edges[e], edges[g]
                    if _one_sheet(x, rest, a, c, near * near, balls[s, 4:], balls[q, 4:]):
                        far = min(reach, _folded(rest, (a, b), (c, d), thickness))
                        if gap > (span - reach + far) ** 2:
                            continue
                    if _edges_near(x, edges[e], edges[g], same, far):
                        pairs = _grown(pairs, count)
                        pairs[count, 0], pairs[count, 1] = e, g
                        count += 1
    return pairs, count
