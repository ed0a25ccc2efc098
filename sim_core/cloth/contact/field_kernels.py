"""Compiled loops behind `field`: exact splats, nearest faces handed on, sign by crossings, fast sweeping."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from sim_core.cloth.contact.closest_points import at
from sim_core.metrics.triangles import squared_gap


@njit(cache=True, error_model="numpy")
def splat(vertices, faces, origin, cell, reach, distance, nearest):
    """Writes, into every node within `reach` [m] of a face, the least distance and the face it belongs to."""
    nx, ny, nz = distance.shape
    ox, oy, oz = origin[0], origin[1], origin[2]
    for f in range(len(faces)):
        a, b, c = at(vertices, faces[f, 0]), at(vertices, faces[f, 1]), at(vertices, faces[f, 2])
        ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
        vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
        mx, my, mz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        size = math.sqrt(mx * mx + my * my + mz * mz)
        if size > 0.0:
            mx, my, mz = mx / size, my / size, mz / size
        cx, cy, cz = (a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0
        ball = 0.0
        for q in (a, b, c):
            ball = max(ball, (q[0] - cx) ** 2 + (q[1] - cy) ** 2 + (q[2] - cz) ** 2)
        ball = math.sqrt(ball)
        i0 = max(0, math.ceil((min(a[0], b[0], c[0]) - reach - ox) / cell))
        j0 = max(0, math.ceil((min(a[1], b[1], c[1]) - reach - oy) / cell))
        k0 = max(0, math.ceil((min(a[2], b[2], c[2]) - reach - oz) / cell))
        i1 = min(nx - 1, math.floor((max(a[0], b[0], c[0]) + reach - ox) / cell))
        j1 = min(ny - 1, math.floor((max(a[1], b[1], c[1]) + reach - oy) / cell))
        k1 = min(nz - 1, math.floor((max(a[2], b[2], c[2]) + reach - oz) / cell))
        for i in range(i0, i1 + 1):
            px = ox + cell * i
            for j in range(j0, j1 + 1):
                py = oy + cell * j
                for k in range(k0, k1 + 1):
                    pz = oz + cell * k
                    best = min(distance[i, j, k], reach)
                    rim = best + ball
                    if (px - cx) ** 2 + (py - cy) ** 2 + (pz - cz) ** 2 >= rim * rim:
                        continue  # not even the ball around the face is nearer
                    if abs((px - a[0]) * mx + (py - a[1]) * my + (pz - a[2]) * mz) >= best:
                        continue  # nor its plane
                    d2 = squared_gap((px, py, pz), a, b, c)
                    if d2 < best * best:
                        distance[i, j, k] = math.sqrt(d2)
                        nearest[i, j, k] = f


@njit(cache=True, error_model="numpy")
def spread(vertices, faces, origin, cell, band, distance, nearest):
    """Hands nearest faces on, layer by layer, to all nodes within `band`: each measures its neighbours' faces.

    A node that finds a nearer face tells its neighbours again, so that the order of layers does not matter.
    """
    nx, ny, nz = distance.shape
    queue = np.flatnonzero(nearest.ravel() >= 0).astype(np.int64)
    ox, oy, oz = origin[0], origin[1], origin[2]
    while len(queue):
        following = np.zeros(6 * len(queue), np.int64)
        count = 0
        for q in range(len(queue)):
            i, rest = queue[q] // (ny * nz), queue[q] % (ny * nz)
            j, k = rest // nz, rest % nz
            f = nearest[i, j, k]
            a, b, c = at(vertices, faces[f, 0]), at(vertices, faces[f, 1]), at(vertices, faces[f, 2])
            limit = distance[i, j, k] + cell * 1.001
            for side in range(6):
                u, v, w = i, j, k
                step = 1 if side % 2 == 0 else -1
                if side < 2:
                    u += step
                elif side < 4:
                    v += step
                else:
                    w += step
                if u < 0 or v < 0 or w < 0 or u >= nx or v >= ny or w >= nz or nearest[u, v, w] == f:
                    continue
                best = distance[u, v, w]
                if best <= distance[i, j, k] - cell:
                    continue
                d2 = squared_gap((ox + cell * u, oy + cell * v, oz + cell * w), a, b, c)
                least = min(best, limit, band)
                if d2 < least * least * (1.0 - 1e-6):
                    distance[u, v, w] = math.sqrt(d2)
                    nearest[u, v, w] = f
                    following[count] = (u * ny + v) * nz + w
                    count += 1
        queue = following[:count].copy()


@njit(cache=True, error_model="numpy")
def _eikonal(a, b, c, cell):
    """Godunov's solution of |grad d| = 1 from the least neighbours along three axes."""
    if a > b:
        a, b = b, a
    if b > c:
        b, c = c, b
    if a > b:
        a, b = b, a
    d = a + cell
    if d <= b:
        return d
    d = 0.5 * (a + b + math.sqrt(max(2.0 * cell * cell - (a - b) * (a - b), 0.0)))
    if d <= c:
        return d
    s = a + b + c
    return (s + math.sqrt(max(s * s - 3.0 * (a * a + b * b + c * c - cell * cell), 0.0))) / 3.0


@njit(cache=True, error_model="numpy")
def sweep(distance, known, cell):
    """Fast sweeping (Zhao 2005), once in each of the eight directions, over the nodes that are not known."""
    nx, ny, nz = distance.shape
    for turn in range(8):
        for i0 in range(nx):
            i = i0 if turn & 1 else nx - 1 - i0
            for j0 in range(ny):
                j = j0 if turn & 2 else ny - 1 - j0
                for k0 in range(nz):
                    k = k0 if turn & 4 else nz - 1 - k0
                    if known[i, j, k]:
                        continue
                    a = min(distance[max(i - 1, 0), j, k], distance[min(i + 1, nx - 1), j, k])
                    b = min(distance[i, max(j - 1, 0), k], distance[i, min(j + 1, ny - 1), k])
                    c = min(distance[i, j, max(k - 1, 0)], distance[i, j, min(k + 1, nz - 1)])
                    if min(a, b, c) == np.inf:
                        continue
                    d = _eikonal(a, b, c, cell)
                    if d < distance[i, j, k]:
                        distance[i, j, k] = d


@njit(cache=True, error_model="numpy")
def crossings(vertices, faces, origin, cell, distance):
    """Signs: minus where faces crossed along z, with their sense, sum up above 0. Returns the distances signed.

    The columns are moved by less than a nanometre, so that none meets an edge.
    """
    nx, ny, nz = distance.shape
    turns = np.zeros(distance.shape, np.int8)
    ox, oy = origin[0] + 3.1415926e-10, origin[1] + 2.7182818e-10
    for f in range(len(faces)):
        a, b, c = vertices[faces[f, 0]], vertices[faces[f, 1]], vertices[faces[f, 2]]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area == 0.0:
            continue
        i0 = max(0, math.ceil((min(a[0], b[0], c[0]) - ox) / cell))
        j0 = max(0, math.ceil((min(a[1], b[1], c[1]) - oy) / cell))
        i1 = min(nx - 1, math.floor((max(a[0], b[0], c[0]) - ox) / cell))
        j1 = min(ny - 1, math.floor((max(a[1], b[1], c[1]) - oy) / cell))
        for i in range(i0, i1 + 1):
            x = ox + cell * i
            for j in range(j0, j1 + 1):
                y = oy + cell * j
                u = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area
                v = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area
                w = 1.0 - u - v
                if u < 0.0 or v < 0.0 or w < 0.0:
                    continue
                k = max(0, math.ceil((u * a[2] + v * b[2] + w * c[2] - origin[2]) / cell))
                if k < nz:
                    turns[i, j, k] += -1 if area > 0.0 else 1
    for i in range(nx):
        for j in range(ny):
            inside = 0
            for k in range(nz):
                inside += turns[i, j, k]
                if inside > 0:
                    distance[i, j, k] = -distance[i, j, k]
    return distance


@njit(cache=True, error_model="numpy")
def interpolate(values, origin, cell, points):
    """Trilinear value (N,) and its gradient (N, 3); outside the box the border's value plus the way there."""
    nx, ny, nz = values.shape
    out, gradient = np.zeros(len(points)), np.zeros((len(points), 3))
    for p in range(len(points)):
        u, v, w = (
            (points[p, 0] - origin[0]) / cell,
            (points[p, 1] - origin[1]) / cell,
            (points[p, 2] - origin[2]) / cell,
        )
        cu, cv, cw = (
            min(max(u, 0.0), nx - 1.000001),
            min(max(v, 0.0), ny - 1.000001),
            min(max(w, 0.0), nz - 1.000001),
        )
        i, j, k = int(cu), int(cv), int(cw)
        a, b, c = cu - i, cv - j, cw - k
        total, dx, dy, dz = 0.0, 0.0, 0.0, 0.0
        for q in range(2):
            for r in range(2):
                for s in range(2):
                    g = values[i + q, j + r, k + s]
                    fa, fb, fc = (
                        (a if q else 1.0 - a),
                        (b if r else 1.0 - b),
                        (c if s else 1.0 - c),
                    )
                    total += g * fa * fb * fc
                    dx += g * (1.0 if q else -1.0) * fb * fc
                    dy += g * (1.0 if r else -1.0) * fa * fc
                    dz += g * (1.0 if s else -1.0) * fa * fb
        ox, oy, oz = (u - cu) * cell, (v - cv) * cell, (w - cw) * cell
        away = math.sqrt(ox * ox + oy * oy + oz * oz)
        out[p] = total + away
        if away > 0.0:
            gradient[p, 0], gradient[p, 1], gradient[p, 2] = ox / away, oy / away, oz / away
        else:
            gradient[p, 0], gradient[p, 1], gradient[p, 2] = dx / cell, dy / cell, dz / cell
    return out, gradient
