"""Where patches are, how their normals spread, and which of them may touch."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from sim_core.cloth.contact.layers.patches import CRUSHED, HELD, grown


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


@njit(error_model="numpy", inline="always")  # calls would count references to every array of the records
def place_now(x, mesh, patches, shapes, p):
    """Where a patch is at x (V, 3): its box and cone; a sum of its coordinates, finite where they are."""
    shapes.placed[p, 0] = shapes.look[0]
    faces, edges, length2, box, cone = mesh.faces, mesh.edges, mesh.length2, shapes.box, shapes.cone
    face, of_face, of_edge = shapes.face, patches.faces, patches.edges
    lx = ly = lz = np.inf
    hx = hy = hz = -np.inf
    ax = ay = az = total = 0.0
    low2 = spare = np.inf
    for n in range(patches.face_start[p], patches.face_start[p + 1]):
        f = of_face[n]
        i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
        xi, yi, zi, xj, yj, zj = x[i, 0], x[i, 1], x[i, 2], x[j, 0], x[j, 1], x[j, 2]
        xk, yk, zk = x[k, 0], x[k, 1], x[k, 2]
        lx, ly, lz = min(lx, xi, xj, xk), min(ly, yi, yj, yk), min(lz, zi, zj, zk)
        hx, hy, hz = max(hx, xi, xj, xk), max(hy, yi, yj, yk), max(hz, zi, zj, zk)
        total += xi + xj + xk + yi + yj + yk + zi + zj + zk  # NaN shows in a sum; min and max pass it over
        nx = (yj - yi) * (zk - zi) - (zj - zi) * (yk - yi)
        ny = (zj - zi) * (xk - xi) - (xj - xi) * (zk - zi)
        nz = (xj - xi) * (yk - yi) - (yj - yi) * (xk - xi)
        twice2 = nx * nx + ny * ny + nz * nz
        longest2 = max(
            (xj - xi) ** 2 + (yj - yi) ** 2 + (zj - zi) ** 2,
            (xk - xi) ** 2 + (yk - yi) ** 2 + (zk - zi) ** 2,
            (xk - xj) ** 2 + (yk - yj) ** 2 + (zk - zj) ** 2,
        )
        low2 = min(low2, twice2 / (longest2 + 1e-30))
        scale = 1.0 / (math.sqrt(twice2) + 1e-30)
        nx, ny, nz = scale * nx, scale * ny, scale * nz
        ax, ay, az = ax + nx, ay + ny, az + nz
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
        spare = min(spare, math.sqrt(size2) - HELD * math.sqrt(length2[e]))
        if size2 < CRUSHED * length2[e]:
            least = -1.0
    cone[p, 0], cone[p, 1], cone[p, 2], cone[p, 3] = ax, ay, az, least
    cone[p, 4] = math.sqrt(max(0.0, 1.0 - least * least))
    cone[p, 5], cone[p, 6], cone[p, 7] = math.acos(min(1.0, least)), math.sqrt(low2), spare
    return total


@njit(cache=True, error_model="numpy")
def place_patch(x, mesh, patches, shapes, p):
    """Likewise, if this look has not asked yet."""
    if shapes.placed[p, 0] != shapes.look[0]:
        place_now(x, mesh, patches, shapes, p)


@njit(error_model="numpy", inline="always")
def place_parts(x, mesh, patches, shapes, p, turned):
    """Where the vertices, edges and faces of a patch are at x (V, 3), and, if turned, the normals there."""
    shapes.placed[p, 1] = shapes.look[0]
    edges, faces, edge, face, vertex = mesh.edges, mesh.faces, shapes.edge, shapes.face, shapes.vertex
    third = 1.0 / 3.0
    for n in range(patches.face_start[p], patches.face_start[p + 1]):
        f = patches.faces[n]
        i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
        a = b = c = 0.0
        for axis in range(3):
            middle = third * (x[i, axis] + x[j, axis] + x[k, axis])
            a, b, c = (
                a + (x[i, axis] - middle) ** 2,
                b + (x[j, axis] - middle) ** 2,
                c + (x[k, axis] - middle) ** 2,
            )
            face[n, axis] = middle
        face[n, 3] = math.sqrt(max(a, b, c))
    for n in range(patches.edge_start[p], patches.edge_start[p + 1]):
        i, j = edges[patches.edges[n], 0], edges[patches.edges[n], 1]
        for c in range(3):
            edge[n, c], edge[n, 7 + c] = 0.5 * (x[i, c] + x[j, c]), 0.5 * (x[j, c] - x[i, c])
        edge[n, 3] = math.sqrt(edge[n, 7] ** 2 + edge[n, 8] ** 2 + edge[n, 9] ** 2)
    for n in range(patches.vertex_start[p], patches.vertex_start[p + 1]):
        for c in range(3):
            vertex[n, c] = x[patches.vertices[n], c]
    if turned:
        _turn_parts(x, mesh, patches, shapes, p)


@njit(cache=True, error_model="numpy")
def _turn_parts(x, mesh, patches, shapes, p):
    """The normals of vertices and edges of a patch at x (V, 3)."""
    if shapes.look[1] != shapes.look[0]:
        shapes.look[1] = shapes.look[0]
        normals_of(x, mesh.faces, shapes.vertex_normal)
    edges, normal, edge, vertex = mesh.edges, shapes.vertex_normal, shapes.edge, shapes.vertex
    for n in range(patches.edge_start[p], patches.edge_start[p + 1]):
        i, j = edges[patches.edges[n], 0], edges[patches.edges[n], 1]
        for c in range(3):
            edge[n, 4 + c] = 0.5 * (normal[i, c] + normal[j, c])
    for n in range(patches.vertex_start[p], patches.vertex_start[p + 1]):
        for c in range(3):
            vertex[n, 4 + c] = normal[patches.vertices[n], c]


@njit(cache=True, error_model="numpy")
def sort_along(box, along, order):
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
        total += place_now(x, mesh, patches, shapes, p)
        for c in range(3):
            low[c], high[c] = min(low[c], box[p, c]), max(high[c], box[p, 3 + c])
    along = 0
    for c in range(1, 3):
        if high[c] - low[c] > high[along] - low[along]:
            along = c
    sort_along(box, along, shapes.order)
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


@njit(error_model="numpy", inline="always")
def are_beside(start, beside, p, q):
    """Whether two patches share a vertex."""
    for k in range(start[p], start[p + 1]):
        if beside[k] == q:
            return True
    return False


@njit(cache=True, error_model="numpy")
def _joined(x, mesh, patches, shapes, p, q, wide):
    """Whether two patches share a vertex each with a third that is flat together with both."""
    start, beside, cone = patches.beside_start, patches.beside, shapes.cone
    for k in range(start[p], start[p + 1]):
        r = beside[k]
        if not patches.bay[r] and are_beside(start, beside, q, r):
            place_patch(x, mesh, patches, shapes, r)
            if flat_together(cone, p, r, wide) and flat_together(cone, q, r, wide):
                return True
    return False


@njit(error_model="numpy", inline="always")
def flat_pair(x, mesh, patches, shapes, p, q, wide):
    """Whether two patches, or one, that are placed lie in a stretch of cloth so flat that it cannot meet itself.

    wide: the cosine of the angle that normals may be apart for that.
    """
    return (
        not (patches.bay[p] or patches.bay[q])
        and flat_together(shapes.cone, p, q, wide)
        and (
            p == q
            or are_beside(patches.beside_start, patches.beside, p, q)
            or _joined(x, mesh, patches, shapes, p, q, wide)
        )
    )


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
def patch_pairs(box, order, along, reach, pairs):
    """Pairs (K, 5) of patches p <= q whose boxes (P, 6) come nearer than `reach` [m]; each is one with itself, too.

    along: the axis that `order` goes by. Returns the list, a longer one where it was full, and how many there are.
    """
    count = 0
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
