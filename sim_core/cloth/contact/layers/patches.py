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
CONE = math.cos(
    math.radians(60.0)
)  # of the widest angle between two normals of what cannot pass through itself
WHOLE = 11  # numbers that tell how a patch moves
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

    vertex_normal: np.ndarray  # (V, 3)
    face: np.ndarray  # (F, 7) in the order of Patches.faces: centre, radius of the ball around it, normal
    edge: np.ndarray  # (E, 7) of Patches.edges: midpoint, half length, mean normal
    vertex: np.ndarray  # (V, 7) of Patches.vertices: place, 0, normal
    box: np.ndarray  # (P, 6) lowest and highest corner
    cone: (
        np.ndarray
    )  # (P, 5) axis, cosine and sine of the half angle around it that holds all normals (-1, 0: crushed)
    placed: np.ndarray  # (P, 2) int64 the look at which a patch was placed last, and its parts' normals
    look: np.ndarray  # (2,) int64 the number of looks, and the last at which the vertices' normals were taken
    order: np.ndarray  # (P,) by the low end along the longest way
    moved: (
        np.ndarray
    )  # (P, 2 WHOLE) of the way since the mark, then of the velocity: mean, rotation about the middle, the
    # most of what is left; the furthest part from the middle, and where that is
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
        vertex_normal=np.zeros((vertices, 3)),
        face=np.zeros((faces, 7)),
        edge=np.zeros((edges, 7)),
        vertex=np.zeros((vertices, 7)),
        box=np.zeros((count, 6)),
        cone=np.zeros((count, 5)),
        placed=np.zeros((count, 2), np.int64),
        look=np.zeros(2, np.int64),
        order=np.arange(count),
        moved=np.zeros((count, 2 * WHOLE)),
        start=np.zeros(count + 2, np.int64),
        ends=np.zeros((2, 3)),
        some=np.zeros((2, most), np.int32),
        close=np.zeros((most * most, 2), np.int32),
    )


@njit(cache=True, error_model="numpy")
def normals_of(x, faces, vertex):
    """Unit normals of vertices (V, 3), of their faces' by area, into `vertex`."""
    vertex[:] = 0.0
    for f in range(len(faces)):
        i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
        ax, ay, az = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
        bx, by, bz = x[k, 0] - x[i, 0], x[k, 1] - x[i, 1], x[k, 2] - x[i, 2]
        nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        for c in (i, j, k):
            vertex[c, 0] += nx
            vertex[c, 1] += ny
            vertex[c, 2] += nz
    for i in range(len(x)):
        scale = 1.0 / (math.sqrt(vertex[i, 0] ** 2 + vertex[i, 1] ** 2 + vertex[i, 2] ** 2) + 1e-30)
        for axis in range(3):
            vertex[i, axis] *= scale


@njit(cache=True, error_model="numpy")
def grown(pairs, count):
    """A list (K, N) with room for more than `count`."""
    if count < len(pairs):
        return pairs
    wider = np.zeros((2 * count + 64, pairs.shape[1]), np.int32)
    wider[: len(pairs)] = pairs
    return wider


@njit(cache=True, error_model="numpy")
def place_patch(x, mesh, patches, shapes, p):
    """Where a patch is at x (V, 3), if this look has not asked yet: its box and cone, its faces and edges.

    Returns a sum over all of its coordinates, which is finite where they are.
    """
    if shapes.placed[p, 0] == shapes.look[0]:
        return 0.0
    shapes.placed[p, 0] = shapes.look[0]
    faces, edges, length2, box, cone = mesh.faces, mesh.edges, mesh.length2, shapes.box, shapes.cone
    face, edge, of_face, of_edge = shapes.face, shapes.edge, patches.faces, patches.edges
    lx = ly = lz = np.inf
    hx = hy = hz = -np.inf
    ax = ay = az = total = 0.0
    third = 1.0 / 3.0
    for n in range(patches.face_start[p], patches.face_start[p + 1]):
        f = of_face[n]
        i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
        xi, yi, zi, xj, yj, zj = x[i, 0], x[i, 1], x[i, 2], x[j, 0], x[j, 1], x[j, 2]
        xk, yk, zk = x[k, 0], x[k, 1], x[k, 2]
        lx, ly, lz = min(lx, xi, xj, xk), min(ly, yi, yj, yk), min(lz, zi, zj, zk)
        hx, hy, hz = max(hx, xi, xj, xk), max(hy, yi, yj, yk), max(hz, zi, zj, zk)
        cx, cy, cz = third * (xi + xj + xk), third * (yi + yj + yk), third * (zi + zj + zk)
        total += cx + cy + cz  # NaN shows in a sum; min and max pass it over
        size2 = max(
            (xi - cx) ** 2 + (yi - cy) ** 2 + (zi - cz) ** 2,
            (xj - cx) ** 2 + (yj - cy) ** 2 + (zj - cz) ** 2,
            (xk - cx) ** 2 + (yk - cy) ** 2 + (zk - cz) ** 2,
        )
        nx = (yj - yi) * (zk - zi) - (zj - zi) * (yk - yi)
        ny = (zj - zi) * (xk - xi) - (xj - xi) * (zk - zi)
        nz = (xj - xi) * (yk - yi) - (yj - yi) * (xk - xi)
        scale = 1.0 / (math.sqrt(nx * nx + ny * ny + nz * nz) + 1e-30)
        nx, ny, nz = scale * nx, scale * ny, scale * nz
        ax, ay, az = ax + nx, ay + ny, az + nz
        face[n, 0], face[n, 1], face[n, 2], face[n, 3] = cx, cy, cz, math.sqrt(size2)
        face[n, 4], face[n, 5], face[n, 6] = nx, ny, nz
    box[p, 0], box[p, 1], box[p, 2], box[p, 3], box[p, 4], box[p, 5] = lx, ly, lz, hx, hy, hz
    scale, least = 1.0 / (math.sqrt(ax * ax + ay * ay + az * az) + 1e-30), 1.0
    ax, ay, az = scale * ax, scale * ay, scale * az
    for n in range(patches.face_start[p], patches.face_start[p + 1]):
        least = min(least, face[n, 4] * ax + face[n, 5] * ay + face[n, 6] * az)
    for n in range(patches.edge_start[p], patches.edge_start[p + 1]):
        e = of_edge[n]
        i, j = edges[e, 0], edges[e, 1]
        size2 = (x[i, 0] - x[j, 0]) ** 2 + (x[i, 1] - x[j, 1]) ** 2 + (x[i, 2] - x[j, 2]) ** 2
        for c in range(3):
            edge[n, c] = 0.5 * (x[i, c] + x[j, c])
        edge[n, 3] = 0.5 * math.sqrt(size2)
        if size2 < CRUSHED * length2[e]:
            least = -1.0
    cone[p, 0], cone[p, 1], cone[p, 2], cone[p, 3] = ax, ay, az, least
    cone[p, 4] = math.sqrt(max(0.0, 1.0 - least * least))
    return total


@njit(cache=True, error_model="numpy")
def turn_parts(x, mesh, patches, shapes, p):
    """Where the vertices of a patch are at x (V, 3), and the normals there and at its edges, likewise."""
    if shapes.placed[p, 1] == shapes.look[0]:
        return
    shapes.placed[p, 1] = shapes.look[0]
    if shapes.look[1] != shapes.look[0]:
        shapes.look[1] = shapes.look[0]
        normals_of(x, mesh.faces, shapes.vertex_normal)
    edges, normal, edge, vertex = mesh.edges, shapes.vertex_normal, shapes.edge, shapes.vertex
    for n in range(patches.edge_start[p], patches.edge_start[p + 1]):
        i, j = edges[patches.edges[n], 0], edges[patches.edges[n], 1]
        for c in range(3):
            edge[n, 4 + c] = 0.5 * (normal[i, c] + normal[j, c])
    for n in range(patches.vertex_start[p], patches.vertex_start[p + 1]):
        i = patches.vertices[n]
        for c in range(3):
            vertex[n, c], vertex[n, 4 + c] = x[i, c], normal[i, c]


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
    """Where all patches are at x (V, 3), sorted; False where x is not finite, and the axis they are sorted along."""
    shapes.look[0] += 1
    low, high, box, total = shapes.ends[0], shapes.ends[1], shapes.box, 0.0
    low[:], high[:] = np.inf, -np.inf
    for p in range(len(patches.face_start) - 1):
        total += place_patch(x, mesh, patches, shapes, p)
        for c in range(3):
            low[c], high[c] = min(low[c], box[p, c]), max(high[c], box[p, 3 + c])
    along = 0
    for c in range(1, 3):
        if high[c] - low[c] > high[along] - low[along]:
            along = c
    _sort_along(box, along, shapes.order)
    return math.isfinite(total), along


@njit(error_model="numpy", inline="always")
def flat_together(cone, p, q, wide):
    """Whether no two normals of two patches are further apart than by an angle with the cosine `wide`."""
    cosine, sine = (
        cone[p, 3] * cone[q, 3] - cone[p, 4] * cone[q, 4],
        cone[p, 4] * cone[q, 3] + cone[q, 4] * cone[p, 3],
    )
    between = cone[p, 0] * cone[q, 0] + cone[p, 1] * cone[q, 1] + cone[p, 2] * cone[q, 2]
    beside = math.sqrt(max(0.0, 1.0 - between * between))
    narrow = sine >= 0.0 and cone[p, 3] > 0.0 and cone[q, 3] > 0.0 and sine * between + cosine * beside >= 0.0
    return narrow and cosine * between - sine * beside >= wide


@njit(cache=True, error_model="numpy")
def _joined(x, mesh, patches, shapes, p, q, wide):
    """Whether two patches share a vertex, or one with a third that is flat together with both."""
    start, beside, cone = patches.beside_start, patches.beside, shapes.cone
    for k in range(start[p], start[p + 1]):
        if beside[k] == q:
            return True
    for k in range(start[p], start[p + 1]):
        r = beside[k]
        for m in range(start[q], start[q + 1]):
            if beside[m] == r:
                place_patch(x, mesh, patches, shapes, r)
                if flat_together(cone, p, r, wide) and flat_together(cone, q, r, wide):
                    return True
    return False


@njit(error_model="numpy", inline="always")
def _turn(xx, yy, zz, xy, xz, yz, tx, ty, tz):
    """The rotation (3 numbers) with moments t of ways about a middle, for second moments of the places there."""
    a, b, c, d, e, f = yy + zz, xx + zz, xx + yy, -xy, -xz, -yz  # the tensor of inertia
    p, q, r = b * c - f * f, e * f - d * c, d * f - b * e
    size = a * p + d * q + e * r
    if not size > 1e-6 * (a + b + c) ** 3:
        return 0.0, 0.0, 0.0
    s, t, u = a * c - e * e, d * e - a * f, a * b - d * d
    return (
        (p * tx + q * ty + r * tz) / size,
        (q * tx + s * ty + t * tz) / size,
        (r * tx + t * ty + u * tz) / size,
    )


@njit(cache=True, error_model="numpy")
def _rigid(x, y, sign, patches, moved, first):
    """How each patch moves as a whole, and what is left of that, into moved[:, first:first + WHOLE].

    Its vertices lie at x (V, 3) and go by y - x (sign -1) or by y (sign 0).
    """
    corners, start = patches.corners, patches.corner_start
    for p in range(len(start) - 1):
        share = 1.0 / (start[p + 1] - start[p])
        cx = cy = cz = ax = ay = az = 0.0
        for n in range(start[p], start[p + 1]):
            i = corners[n]
            cx, cy, cz = cx + x[i, 0], cy + x[i, 1], cz + x[i, 2]
            ax, ay, az = ax + y[i, 0], ay + y[i, 1], az + y[i, 2]
        cx, cy, cz = share * cx, share * cy, share * cz
        ax, ay, az = share * ax + sign * cx, share * ay + sign * cy, share * az + sign * cz
        xx = yy = zz = xy = xz = yz = tx = ty = tz = 0.0
        for n in range(start[p], start[p + 1]):
            i = corners[n]
            rx, ry, rz = x[i, 0] - cx, x[i, 1] - cy, x[i, 2] - cz
            dx, dy, dz = (
                y[i, 0] + sign * x[i, 0] - ax,
                y[i, 1] + sign * x[i, 1] - ay,
                y[i, 2] + sign * x[i, 2] - az,
            )
            xx, yy, zz, xy, xz, yz = (
                xx + rx * rx,
                yy + ry * ry,
                zz + rz * rz,
                xy + rx * ry,
                xz + rx * rz,
                yz + ry * rz,
            )
            tx, ty, tz = tx + ry * dz - rz * dy, ty + rz * dx - rx * dz, tz + rx * dy - ry * dx
        wx, wy, wz = _turn(xx, yy, zz, xy, xz, yz, tx, ty, tz)
        left = wide = 0.0
        for n in range(start[p], start[p + 1]):
            i = corners[n]
            rx, ry, rz = x[i, 0] - cx, x[i, 1] - cy, x[i, 2] - cz
            dx = y[i, 0] + sign * x[i, 0] - ax - (wy * rz - wz * ry)
            dy = y[i, 1] + sign * x[i, 1] - ay - (wz * rx - wx * rz)
            dz = y[i, 2] + sign * x[i, 2] - az - (wx * ry - wy * rx)
            left, wide = max(left, dx * dx + dy * dy + dz * dz), max(wide, rx * rx + ry * ry + rz * rz)
        moved[p, first], moved[p, first + 1], moved[p, first + 2] = ax, ay, az
        moved[p, first + 3], moved[p, first + 4], moved[p, first + 5] = wx, wy, wz
        moved[p, first + 6], moved[p, first + 7] = math.sqrt(left), math.sqrt(wide)
        moved[p, first + 8], moved[p, first + 9], moved[p, first + 10] = cx, cy, cz


@njit(cache=True, error_model="numpy")
def move_patches(x, v, mark, patches, moved):
    """How patches have come from the mark (V, 3), and how they go, into Shapes.moved."""
    _rigid(mark, x, -1.0, patches, moved, 0)
    _rigid(x, v, 0.0, patches, moved, WHOLE)


@njit(error_model="numpy", inline="always")
def apart(moved, p, q, c):
    """The most by which parts of two patches can have come nearer to each other [m] (c = 0), or do [m/s] (c = WHOLE).

    A rotation that both go along with brings nothing nearer: x + w × x is no shorter than x.
    """
    wx, wy, wz = (
        0.5 * (moved[p, c + 3] + moved[q, c + 3]),
        0.5 * (moved[p, c + 4] + moved[q, c + 4]),
        0.5 * (moved[p, c + 5] + moved[q, c + 5]),
    )
    ux, uy, uz = moved[p, c + 3] - wx, moved[p, c + 4] - wy, moved[p, c + 5] - wz
    rx, ry, rz = (
        moved[q, c + 8] - moved[p, c + 8],
        moved[q, c + 9] - moved[p, c + 9],
        moved[q, c + 10] - moved[p, c + 10],
    )
    dx = moved[q, c] - moved[p, c] - (wy * rz - wz * ry)
    dy = moved[q, c + 1] - moved[p, c + 1] - (wz * rx - wx * rz)
    dz = moved[q, c + 2] - moved[p, c + 2] - (wx * ry - wy * rx)
    within = (
        moved[p, c + 6]
        + moved[q, c + 6]
        + math.sqrt(ux * ux + uy * uy + uz * uz) * (moved[p, c + 7] + moved[q, c + 7])
    )
    return math.sqrt(dx * dx + dy * dy + dz * dz) + within


@njit(cache=True, error_model="numpy")
def furthest(moved, c):
    """The most by which any part of a patch leaves the way that all go as a whole [m], or [m/s], and the mean."""
    many = len(moved)
    share = 1.0 / max(many, 1)
    cx = cy = cz = ax = ay = az = 0.0
    for p in range(many):
        cx, cy, cz = cx + moved[p, c + 8], cy + moved[p, c + 9], cz + moved[p, c + 10]
        ax, ay, az = ax + moved[p, c], ay + moved[p, c + 1], az + moved[p, c + 2]
    cx, cy, cz, ax, ay, az = share * cx, share * cy, share * cz, share * ax, share * ay, share * az
    xx = yy = zz = xy = xz = yz = tx = ty = tz = 0.0
    for p in range(many):
        rx, ry, rz = moved[p, c + 8] - cx, moved[p, c + 9] - cy, moved[p, c + 10] - cz
        dx, dy, dz = moved[p, c] - ax, moved[p, c + 1] - ay, moved[p, c + 2] - az
        xx, yy, zz, xy, xz, yz = (
            xx + rx * rx,
            yy + ry * ry,
            zz + rz * rz,
            xy + rx * ry,
            xz + rx * rz,
            yz + ry * rz,
        )
        tx, ty, tz = tx + ry * dz - rz * dy, ty + rz * dx - rx * dz, tz + rx * dy - ry * dx
    wx, wy, wz = _turn(xx, yy, zz, xy, xz, yz, tx, ty, tz)
    most = total = 0.0
    for p in range(many):
        rx, ry, rz = moved[p, c + 8] - cx, moved[p, c + 9] - cy, moved[p, c + 10] - cz
        dx = moved[p, c] - ax - (wy * rz - wz * ry)
        dy = moved[p, c + 1] - ay - (wz * rx - wx * rz)
        dz = moved[p, c + 2] - az - (wx * ry - wy * rx)
        ux, uy, uz = moved[p, c + 3] - wx, moved[p, c + 4] - wy, moved[p, c + 5] - wz
        turned = math.sqrt(ux * ux + uy * uy + uz * uz) * moved[p, c + 7]
        own = math.sqrt(dx * dx + dy * dy + dz * dz) + moved[p, c + 6] + turned
        most, total = max(most, own), total + own  # NaN shows in a sum
    return most, share * total


@njit(error_model="numpy", inline="always")
def between(x, corners, start, box, p, q):
    """At least so far two patches are from each other [m]: along an axis of their boxes, or from middle to middle."""
    ax = max(box[p, 0] - box[q, 3], box[q, 0] - box[p, 3])
    ay = max(box[p, 1] - box[q, 4], box[q, 1] - box[p, 4])
    gap = max(ax, ay, max(box[p, 2] - box[q, 5], box[q, 2] - box[p, 5]))
    dx, dy, dz = (
        box[q, 0] + box[q, 3] - box[p, 0] - box[p, 3],
        box[q, 1] + box[q, 4] - box[p, 1] - box[p, 4],
        box[q, 2] + box[q, 5] - box[p, 2] - box[p, 5],
    )
    size = math.sqrt(dx * dx + dy * dy + dz * dz) + 1e-30
    high, low = -np.inf, np.inf
    for n in range(start[p], start[p + 1]):
        i = corners[n]
        high = max(high, dx * x[i, 0] + dy * x[i, 1] + dz * x[i, 2])
    for n in range(start[q], start[q + 1]):
        i = corners[n]
        low = min(low, dx * x[i, 0] + dy * x[i, 1] + dz * x[i, 2])
    return max(gap, (low - high) / size)


@njit(cache=True, error_model="numpy")
def patch_pairs(patches, shapes, along, reach, pairs):
    """Pairs (K, 5) of patches p <= q, of which parts may come nearer than `reach` [m]; each is one with itself, too.

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


@njit(error_model="numpy", inline="always")
def flat_pair(x, mesh, patches, shapes, p, q, wide):
    """Whether two patches, or one, that are placed lie in a stretch of cloth so flat that it cannot meet itself.

    wide: the cosine of the angle that normals may be apart for that.
    """
    return flat_together(shapes.cone, p, q, wide) and (
        p == q or _joined(x, mesh, patches, shapes, p, q, wide)
    )
