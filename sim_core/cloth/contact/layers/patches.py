"""Patches: a cloth cut into small connected groups of faces, and which of them may touch.

A patch whose normals lie in a narrow cone, and whose edges are not crushed, is a graph over a plane and cannot meet
itself, nor a neighbour with which it shares the cone (Volino & Magnenat-Thalmann 1994; Provot 1997). Of cloth that
hangs in folds nearly all is such; what is left are pairs of patches whose boxes overlap: layers, and sharp folds.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.cloth.sheet.sheet import face_edge_table

FACES = 16  # of a patch; larger ones are flat less often, smaller ones are more to look at
CONE = math.cos(math.radians(60.0))  # of the widest angle between two normals of what cannot pass through itself
CRUSHED = 0.5  # of its squared length at rest, below which an edge may lie in a fold that normals do not show


class Patches(NamedTuple):
    """P patches of a cloth of V vertices, E edges, F faces; each vertex and edge belongs to the first patch with it."""

    faces: np.ndarray  # (F,) int32, patch by patch
    edges: np.ndarray  # (E,)
    vertices: np.ndarray  # (V,)
    face_start: np.ndarray  # (P + 1,) int32 into them
    edge_start: np.ndarray
    vertex_start: np.ndarray
    corners: np.ndarray  # (N,) int32 all vertices that a patch's faces name, each once
    corner_start: np.ndarray  # (P + 1,)
    beside: np.ndarray  # (N,) int32 the patches that share a vertex with each, without itself
    beside_start: np.ndarray  # (P + 1,)


class Shapes(NamedTuple):
    """Working memory: where the patches and their parts are at a time."""

    face_normal: np.ndarray  # (F, 3)
    vertex_normal: np.ndarray  # (V, 3)
    face: (
        np.ndarray
    )  # (F, 8) in the order of Patches.faces: centre, radius of the ball around it, normal, size
    edge: np.ndarray  # (E, 8) of Patches.edges: midpoint, half length, mean normal
    vertex: np.ndarray  # (V, 8) of Patches.vertices: place, 0, normal
    box: np.ndarray  # (P, 6) lowest and highest corner
    cone: (
        np.ndarray
    )  # (P, 5) axis, cosine and sine of the half angle around it that holds all normals (-1, 0: crushed)
    order: np.ndarray  # (P,) by the low end along the longest way
    moved: np.ndarray  # (P, 8) mean way since the mark, furthest from it; mean velocity, furthest from that
    start: np.ndarray  # (P + 2,) int64
    ends: np.ndarray  # (2, 3) lowest and highest corner of all
    some: np.ndarray  # (2, K) int32 which of two patches' parts are near each other
    close: np.ndarray  # (K * K, 2) int32 and which pairs of them


@njit(cache=True)
def _grown(beside, size):
    """Numbers (F,) of connected groups of about `size` faces; beside (F, 3): the faces at each one's sides, or -1."""
    count = len(beside)
    patch = np.full(count, -1, np.int32)
    queue = np.zeros(count, np.int32)
    number = 0
    for seed in range(count):
        if patch[seed] >= 0:
            continue
        head, tail = 0, 1
        queue[0], patch[seed] = seed, number
        while head < tail and tail < size:
            for side in range(3):
                f = beside[queue[head], side]
                if f >= 0 and patch[f] < 0 and tail < size:
                    patch[f] = number
                    queue[tail] = f
                    tail += 1
            head += 1
        if tail < size // 4:  # a remnant between others goes to one of these
            for n in range(tail):
                for side in range(3):
                    f = beside[queue[n], side]
                    if f >= 0 and patch[f] != number:
                        for m in range(tail):
                            patch[queue[m]] = patch[f]
                        tail = 0
                        break
                if tail == 0:
                    break
            if tail == 0:
                continue
        number += 1
    return patch


def patches_of(edges: np.ndarray, faces: np.ndarray, same: np.ndarray, size: int = FACES) -> Patches:
    """Patches of a mesh: edges (E, 2), faces (F, 3) int32, same (V,) int32, one number for vertices that are sewn."""
    count = len(same)
    if not len(faces):
        none, start = np.zeros(0, np.int32), np.zeros(1, np.int32)
        return Patches(none, none, none, start, start, start, none, start, none, start)
    _, face_edges = face_edge_table(faces)
    flat = face_edges.ravel()
    by_edge = np.argsort(flat, kind="stable")
    beside = np.full(len(flat), -1, np.int32)
    twin = flat[by_edge][1:] == flat[by_edge][:-1]
    first, second = by_edge[:-1][twin], by_edge[1:][twin]
    beside[first], beside[second] = second // 3, first // 3
    patch = _grown(beside.reshape(-1, 3), size)
    number = int(patch.max()) + 1
    of_vertex = np.full(count, number, np.int32)
    np.minimum.at(of_vertex, faces.ravel(), np.repeat(patch, 3))
    of_edge = np.full(len(edges), number, np.int32)
    key = np.sort(edges, axis=1).astype(np.int64) @ [count, 1]
    where = np.argsort(key)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        ends = np.sort(faces[:, [a, b]], axis=1).astype(np.int64) @ [count, 1]
        np.minimum.at(of_edge, where[np.searchsorted(key[where], ends)], patch)

    def sorted_by(owner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        start = np.searchsorted(np.sort(owner), np.arange(number + 1))
        return np.argsort(owner, kind="stable").astype(np.int32), start.astype(np.int32)

    (own_faces, face_start), (own_edges, edge_start) = sorted_by(patch), sorted_by(of_edge)
    own_vertices, vertex_start = sorted_by(of_vertex)
    named = np.unique(np.column_stack([np.repeat(patch, 3), faces.ravel()]), axis=0)
    corner_start = np.searchsorted(named[:, 0], np.arange(number + 1)).astype(np.int32)
    near, near_start = _neighbours(same[faces], patch, number)
    return Patches(
        faces=own_faces,
        edges=own_edges,
        vertices=own_vertices,
        face_start=face_start,
        edge_start=edge_start,
        vertex_start=vertex_start,
        corners=named[:, 1].astype(np.int32),
        corner_start=corner_start,
        beside=near,
        beside_start=near_start,
    )


def _neighbours(corners: np.ndarray, patch: np.ndarray, number: int) -> tuple[np.ndarray, np.ndarray]:
    """Which patches share one of the points that corners (F, 3) name, patch by patch: a list (N,) and its begins."""
    touches = np.unique(np.column_stack([corners.ravel(), np.repeat(patch, 3)]).astype(np.int64), axis=0)
    point, of = touches[:, 0], touches[:, 1]
    pairs = [np.zeros((0, 2), np.int64)]
    for shift in range(1, int(np.bincount(point).max())):  # of those that meet in a point, each with each
        both = point[shift:] == point[:-shift]
        pairs.append(np.column_stack([of[:-shift][both], of[shift:][both]]))
    found = np.concatenate(pairs)
    found = np.unique(np.concatenate([found, found[:, ::-1]]), axis=0)
    start = np.searchsorted(found[:, 0], np.arange(number + 1))
    return found[:, 1].astype(np.int32), start.astype(np.int32)


def shapes_of(patches: Patches) -> Shapes:
    """Memory for a search among these patches."""
    vertices, edges, faces = len(patches.vertices), len(patches.edges), len(patches.faces)
    count = len(patches.face_start) - 1
    starts = patches.face_start, patches.edge_start, patches.vertex_start
    most = max(int(np.diff(start).max(initial=0)) for start in starts)
    return Shapes(
        face_normal=np.zeros((faces, 3)),
        vertex_normal=np.zeros((vertices, 3)),
        face=np.zeros((faces, 8)),
        edge=np.zeros((edges, 8)),
        vertex=np.zeros((vertices, 8)),
        box=np.zeros((count, 6)),
        cone=np.zeros((count, 5)),
        order=np.arange(count),
        moved=np.zeros((count, 8)),
        start=np.zeros(count + 2, np.int64),
        ends=np.zeros((2, 3)),
        some=np.zeros((2, most), np.int32),
        close=np.zeros((most * most, 2), np.int32),
    )


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
def grown(pairs, count):
    """A list (K, N) with room for more than `count`."""
    if count < len(pairs):
        return pairs
    wider = np.zeros((2 * count + 64, pairs.shape[1]), np.int32)
    wider[: len(pairs)] = pairs
    return wider


@njit(cache=True, error_model="numpy")
def _place_parts(x, mesh, patches, shapes):
    """Places faces, edges and vertices in the order of their patches."""
    faces, edges, normal = mesh.faces, mesh.edges, shapes.vertex_normal
    for n in range(len(patches.faces)):
        f = patches.faces[n]
        out = shapes.face[n]
        size2 = 0.0
        for c in range(3):
            out[c] = (x[faces[f, 0], c] + x[faces[f, 1], c] + x[faces[f, 2], c]) / 3.0
            out[4 + c] = shapes.face_normal[f, c]
        for k in range(3):
            j = faces[f, k]
            gap2 = (x[j, 0] - out[0]) ** 2 + (x[j, 1] - out[1]) ** 2 + (x[j, 2] - out[2]) ** 2
            size2 = max(size2, gap2)
        out[3] = math.sqrt(size2)
    for n in range(len(patches.edges)):
        i, j = edges[patches.edges[n]]
        out = shapes.edge[n]
        length2 = 0.0
        for c in range(3):
            out[c] = 0.5 * (x[i, c] + x[j, c])
            out[4 + c] = 0.5 * (normal[i, c] + normal[j, c])
            length2 += (x[i, c] - x[j, c]) ** 2
        out[3], out[7] = 0.5 * math.sqrt(length2), length2
    for n in range(len(patches.vertices)):
        i = patches.vertices[n]
        for c in range(3):
            shapes.vertex[n, c], shapes.vertex[n, 4 + c] = x[i, c], normal[i, c]


@njit(cache=True, error_model="numpy")
def _sort_along(box, along, order):
    """Puts order (P,), which holds each patch once, in order of box[:, along], equal ones by number (Shell 1959).

    From one time to the next it hardly changes.
    """
    gap = len(order) // 2
    while gap > 0:
        for n in range(gap, len(order)):
            p, m = order[n], n
            while m >= gap:
                q = order[m - gap]
                if box[q, along] < box[p, along] or (box[q, along] == box[p, along] and q < p):
                    break
                order[m] = q
                m -= gap
            order[m] = p
        gap //= 2


@njit(cache=True, error_model="numpy")
def place_patches(x, mesh, patches, shapes):
    """Where the patches are at x (V, 3): boxes, cones and the parts of each; False where x is not finite."""
    normals_of(x, mesh.faces, shapes.face_normal, shapes.vertex_normal)
    _place_parts(x, mesh, patches, shapes)
    low, high, total = shapes.ends[0], shapes.ends[1], 0.0
    low[:], high[:] = np.inf, -np.inf
    for p in range(len(patches.face_start) - 1):
        box, cone = shapes.box[p], shapes.cone[p]
        box[:3], box[3:], cone[:3] = np.inf, -np.inf, 0.0
        for n in range(patches.face_start[p], patches.face_start[p + 1]):
            f = patches.faces[n]
            for c in range(3):
                cone[c] += shapes.face_normal[f, c]
                for k in range(3):
                    place = x[mesh.faces[f, k], c]
                    total += place  # NaN shows in a sum; min and max pass it over
                    box[c], box[3 + c] = min(box[c], place), max(box[3 + c], place)
        for c in range(3):
            low[c], high[c] = min(low[c], box[c]), max(high[c], box[3 + c])
        size = math.sqrt(cone[0] * cone[0] + cone[1] * cone[1] + cone[2] * cone[2]) + 1e-30
        least = 1.0
        for c in range(3):
            cone[c] /= size
        for n in range(patches.face_start[p], patches.face_start[p + 1]):
            m = shapes.face_normal[patches.faces[n]]
            least = min(least, m[0] * cone[0] + m[1] * cone[1] + m[2] * cone[2])
        for n in range(patches.edge_start[p], patches.edge_start[p + 1]):
            if shapes.edge[n, 7] < CRUSHED * mesh.length2[patches.edges[n]]:
                least = -1.0
        cone[3], cone[4] = least, math.sqrt(max(0.0, 1.0 - least * least))
    along = 0
    for c in range(1, 3):
        if high[c] - low[c] > high[along] - low[along]:
            along = c
    _sort_along(shapes.box, along, shapes.order)
    return math.isfinite(total), along


@njit(cache=True, error_model="numpy")
def flat_together(a, b, wide):
    """Whether no two normals of two cones (see Shapes.cone) are further apart than by an angle with the cosine `wide`."""
    cosine, sine = a[3] * b[3] - a[4] * b[4], a[4] * b[3] + a[3] * b[4]  # of both half angles
    if sine < 0.0 or min(a[3], b[3]) <= 0.0:
        return False
    between = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    beside = math.sqrt(max(0.0, 1.0 - between * between))
    return sine * between + cosine * beside >= 0.0 and cosine * between - sine * beside >= wide


@njit(cache=True, error_model="numpy")
def _joined(patches, cone, p, q, wide):
    """Whether two patches share a vertex, or one with a third that is flat together with both."""
    start, beside = patches.beside_start, patches.beside
    for k in range(start[p], start[p + 1]):
        r = beside[k]
        if r == q:
            return True
        for m in range(start[q], start[q + 1]):
            if beside[m] == r and flat_together(cone[p], cone[r], wide) and flat_together(cone[q], cone[r], wide):
                return True
    return False


@njit(cache=True, error_model="numpy")
def move_patches(x, v, mark, patches, moved):
    """How far patches have come from the mark (V, 3), and how fast they go, into Shapes.moved."""
    corners, start = patches.corners, patches.corner_start
    for p in range(len(start) - 1):
        ax = ay = az = bx = by = bz = 0.0
        for n in range(start[p], start[p + 1]):
            i = corners[n]
            ax, ay, az = ax + x[i, 0] - mark[i, 0], ay + x[i, 1] - mark[i, 1], az + x[i, 2] - mark[i, 2]
            bx, by, bz = bx + v[i, 0], by + v[i, 1], bz + v[i, 2]
        share = 1.0 / (start[p + 1] - start[p])
        ax, ay, az, bx, by, bz = share * ax, share * ay, share * az, share * bx, share * by, share * bz
        far = fast = 0.0
        for n in range(start[p], start[p + 1]):
            i = corners[n]
            dx, dy, dz = x[i, 0] - mark[i, 0] - ax, x[i, 1] - mark[i, 1] - ay, x[i, 2] - mark[i, 2] - az
            far = max(far, dx * dx + dy * dy + dz * dz)
            dx, dy, dz = v[i, 0] - bx, v[i, 1] - by, v[i, 2] - bz
            fast = max(fast, dx * dx + dy * dy + dz * dz)
        moved[p, 0], moved[p, 1], moved[p, 2], moved[p, 3] = ax, ay, az, math.sqrt(far)
        moved[p, 4], moved[p, 5], moved[p, 6], moved[p, 7] = bx, by, bz, math.sqrt(fast)


@njit(error_model="numpy", inline="always")
def apart(moved, p, q, c):
    """The most by which parts of two patches have moved against each other [m] (c = 0), or do [m/s] (c = 4)."""
    dx, dy, dz = (
        moved[p, c] - moved[q, c],
        moved[p, c + 1] - moved[q, c + 1],
        moved[p, c + 2] - moved[q, c + 2],
    )
    within = moved[p, c + 3] + (moved[q, c + 3] if p != q else moved[p, c + 3])
    return math.sqrt(dx * dx + dy * dy + dz * dz) + within


@njit(cache=True, error_model="numpy")
def between(x, patches, box, p, q):
    """At least so far two patches are from each other [m]: along an axis of their boxes, or from middle to middle."""
    ax = max(box[p, 0] - box[q, 3], box[q, 0] - box[p, 3])
    ay = max(box[p, 1] - box[q, 4], box[q, 1] - box[p, 4])
    gap = max(ax, ay, max(box[p, 2] - box[q, 5], box[q, 2] - box[p, 5]))
    dx, dy, dz = (
        box[q, 0] + box[q, 3] - box[p, 0] - box[p, 3],
        box[q, 1] + box[q, 4] - box[p, 1] - box[p, 4],
        box[q, 2] + box[q, 5] - box[p, 2] - box[p, 5],
    )
    size = math.sqrt(dx * dx + dy * dy + dz * dz)
    if size == 0.0:
        return gap
    corners, start, high, low = patches.corners, patches.corner_start, -np.inf, np.inf
    for n in range(start[p], start[p + 1]):
        i = corners[n]
        high = max(high, dx * x[i, 0] + dy * x[i, 1] + dz * x[i, 2])
    for n in range(start[q], start[q + 1]):
        i = corners[n]
        low = min(low, dx * x[i, 0] + dy * x[i, 1] + dz * x[i, 2])
    return max(gap, (low - high) / size)


@njit(cache=True, error_model="numpy")
def patch_pairs(patches, shapes, along, reach, pairs):
    """Pairs (K, 4) of patches p <= q, of which parts may come nearer than `reach` [m]; each is one with itself, too.

    along: the axis that shapes.order goes by. Returns the list, a longer one where it was full, and how many there are.
    """
    box, order, count = shapes.box, shapes.order, 0
    for n in range(len(order)):
        p = order[n]
        pairs = grown(pairs, count + len(order) - n)
        pairs[count, 0], pairs[count, 1] = p, p
        count += 1
        end = box[p, 3 + along] + reach
        for m in range(n + 1, len(order)):
            q = order[m]
            if box[q, along] > end:
                break
            away = False
            for c in range(3):
                if box[q, c] > box[p, 3 + c] + reach or box[p, c] > box[q, 3 + c] + reach:
                    away = True
            if not away:
                pairs[count, 0], pairs[count, 1] = min(p, q), max(p, q)
                count += 1
    return pairs, count


@njit(cache=True, error_model="numpy")
def flat_pair(patches, cone, p, q, wide):
    """Whether two patches, or one, lie in a stretch of cloth that is so flat that it cannot meet itself.

    wide: the cosine of the angle that normals may be apart for that.
    """
    return flat_together(cone[p], cone[q], wide) and (p == q or _joined(patches, cone, p, q, wide))
