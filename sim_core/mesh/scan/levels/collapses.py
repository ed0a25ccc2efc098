"""Half-edge collapses of millions of triangles in rounds: no heap, memory in proportion to the mesh, compiled.

A heap of all ways (garment.levels) keeps a garment's few ten thousand triangles in perfect order; of five million it
holds a hundred million ways. Here each round looks once at every vertex' best way, and takes the better part of them,
the best first, where none has been taken beside it; a quarter of the vertices goes in each.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

INSIDE, BORDER, STAYS = 0, 1, 2
LEAST_SHAPE = 0.05  # area over longest side squared; 0.43 is equilateral
TURN = 0.2  # cosine between a face's old and new normal
SHORT = 1e-4  # of a way's squared length, beside squared distances: short ways first where all is flat
LINE = 4.0  # of keeping a border in its line, against keeping a face in its plane
WIDEST = 256  # neighbours of a vertex that is looked at


class Web(NamedTuple):
    """V vertices, F faces; the corner k of face f is number 3 f + k."""

    x: np.ndarray  # (V, 3) [m]
    faces: np.ndarray  # (F, 3) int32
    alive: np.ndarray  # (F,) bool
    head: np.ndarray  # (V,) int32 a corner of each vertex, or -1
    link: np.ndarray  # (3 F,) int32 the next one
    kind: np.ndarray  # (V,) uint8
    quadric: np.ndarray  # (V, 10) squared distance [m2], weighted by area [m2], of what a vertex stands for
    upright: np.ndarray  # (V, 3) sum of its normals by area
    met: np.ndarray  # (V,) int64 when each vertex was met last
    clock: np.ndarray  # (1,) int64
    count: np.ndarray  # (1,) int64 faces that are left


@njit(error_model="numpy", inline="always")
def _cross(x, i, j, k):
    ux, uy, uz = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
    vx, vy, vz = x[k, 0] - x[i, 0], x[k, 1] - x[i, 1], x[k, 2] - x[i, 2]
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


@njit(error_model="numpy", inline="always")
def _far(x, i, j):
    return (x[i, 0] - x[j, 0]) ** 2 + (x[i, 1] - x[j, 1]) ** 2 + (x[i, 2] - x[j, 2]) ** 2


@njit(cache=True, error_model="numpy")
def _add_plane(q, v, nx, ny, nz, w, weight):
    q[v, 0] += weight * nx * nx
    q[v, 1] += weight * nx * ny
    q[v, 2] += weight * nx * nz
    q[v, 3] += weight * nx * w
    q[v, 4] += weight * ny * ny
    q[v, 5] += weight * ny * nz
    q[v, 6] += weight * ny * w
    q[v, 7] += weight * nz * nz
    q[v, 8] += weight * nz * w
    q[v, 9] += weight * w * w


@njit(cache=True, error_model="numpy")
def prepare(web, borders):
    """Lists of corners, planes and normals of all faces; planes that hold the open edges (N, 2), as a face has them."""
    x, faces = web.x, web.faces
    for f in range(len(faces)):
        i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
        nx, ny, nz = _cross(x, i, j, k)
        size = math.sqrt(nx * nx + ny * ny + nz * nz)
        for c in range(3):
            v = faces[f, c]
            web.link[3 * f + c] = web.head[v]
            web.head[v] = 3 * f + c
            web.upright[v, 0] += nx
            web.upright[v, 1] += ny
            web.upright[v, 2] += nz
        if size > 0.0:
            nx, ny, nz = nx / size, ny / size, nz / size
            w = -(nx * x[i, 0] + ny * x[i, 1] + nz * x[i, 2])
            for c in range(3):
                _add_plane(web.quadric, faces[f, c], nx, ny, nz, w, size / 6.0)
    for n in range(len(borders)):
        i, j = borders[n, 0], borders[n, 1]
        ux, uy, uz = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
        mx = web.upright[i, 0] + web.upright[j, 0]
        my = web.upright[i, 1] + web.upright[j, 1]
        mz = web.upright[i, 2] + web.upright[j, 2]
        nx, ny, nz = uy * mz - uz * my, uz * mx - ux * mz, ux * my - uy * mx
        size = math.sqrt(nx * nx + ny * ny + nz * nz)
        if size > 0.0:
            nx, ny, nz = nx / size, ny / size, nz / size
            w = -(nx * x[i, 0] + ny * x[i, 1] + nz * x[i, 2])
            weight = 0.5 * LINE * (ux * ux + uy * uy + uz * uz)
            _add_plane(web.quadric, i, nx, ny, nz, w, weight)
            _add_plane(web.quadric, j, nx, ny, nz, w, weight)


@njit(cache=True, error_model="numpy")
def _ring(web, v, ring):
    """The neighbours of v, each once; -1 where they are more than `ring` holds."""
    web.clock[0] += 1
    now, many, c = web.clock[0], 0, web.head[v]
    web.met[v] = now
    while c >= 0:
        f = c // 3
        if web.alive[f]:
            for k in range(3):
                u = web.faces[f, k]
                if web.met[u] != now:
                    if many == len(ring):
                        return -1
                    web.met[u] = now
                    ring[many] = u
                    many += 1
        c = web.link[c]
    return many


@njit(cache=True, error_model="numpy")
def _shared(web, v, u):
    """How many faces two vertices share."""
    many, c = 0, web.head[v]
    while c >= 0:
        f = c // 3
        if web.alive[f] and (web.faces[f, 0] == u or web.faces[f, 1] == u or web.faces[f, 2] == u):
            many += 1
        c = web.link[c]
    return many


@njit(cache=True, error_model="numpy")
def error_at(q, v, x, y, z):
    """Weighted squared distance of a place to what v stands for."""
    square = q[v, 0] * x * x + q[v, 4] * y * y + q[v, 7] * z * z + q[v, 9]
    cross = q[v, 1] * x * y + q[v, 2] * x * z + q[v, 5] * y * z
    return square + 2.0 * (cross + q[v, 3] * x + q[v, 6] * y + q[v, 8] * z)


@njit(cache=True, error_model="numpy")
def best_ways(web, error, onto):
    """Of every vertex the neighbour it goes onto with the least error, -1 where it stays."""
    ring = np.zeros(WIDEST, np.int64)
    for v in range(len(web.x)):
        error[v], onto[v] = math.inf, -1
        if web.kind[v] == STAYS or web.head[v] < 0:
            continue
        many = _ring(web, v, ring)
        area = web.quadric[v, 0] + web.quadric[v, 4] + web.quadric[v, 7]
        for n in range(many):
            u = ring[n]
            if web.kind[v] == BORDER and (web.kind[u] == INSIDE or _shared(web, v, u) != 1):
                continue
            cost = error_at(web.quadric, v, web.x[u, 0], web.x[u, 1], web.x[u, 2])
            cost = max(cost, 0.0) + SHORT * area * _far(web.x, v, u)
            if cost < error[v]:
                error[v], onto[v] = cost, u


@njit(cache=True, error_model="numpy")
def _sound(web, v, u, ring):
    """Whether v may go onto u: no pinch, no turned and no needle-like face."""
    shared = _shared(web, v, u)
    if shared == 0 or shared > 2:
        return False
    if _ring(web, u, ring) < 0:
        return False
    now = web.clock[0]  # all that u meets are marked by it
    common, c = 0, web.head[v]
    web.clock[0] += 1
    later = web.clock[0]
    web.met[v] = later
    while c >= 0:
        f = c // 3
        if web.alive[f]:
            for k in range(3):
                w = web.faces[f, k]
                if web.met[w] == now:
                    common += w != u
                    web.met[w] = later
        c = web.link[c]
    if common != shared:
        return False
    x, c = web.x, web.head[v]
    while c >= 0:
        f = c // 3
        if web.alive[f]:
            i, j, k = web.faces[f, 0], web.faces[f, 1], web.faces[f, 2]
            if i != u and j != u and k != u:
                ax, ay, az = _cross(x, i, j, k)
                before = max(_far(x, i, j), _far(x, j, k), _far(x, k, i))
                i, j, k = u if i == v else i, u if j == v else j, u if k == v else k
                bx, by, bz = _cross(x, i, j, k)
                size, old = math.sqrt(bx * bx + by * by + bz * bz), math.sqrt(ax * ax + ay * ay + az * az)
                before = 0.5 * old / before if before > 0.0 else 0.0
                if ax * bx + ay * by + az * bz < TURN * old * size:
                    return False
                shape = 0.5 * size / max(_far(x, i, j), _far(x, j, k), _far(x, k, i))
                if shape < min(LEAST_SHAPE, before):
                    return False
        c = web.link[c]
    return True


@njit(cache=True, error_model="numpy")
def _collapse(web, v, u):
    c, left = web.head[v], -1
    while c >= 0:
        after, f = web.link[c], c // 3
        if web.alive[f]:
            if web.faces[f, 0] == u or web.faces[f, 1] == u or web.faces[f, 2] == u:
                web.alive[f] = False
                web.count[0] -= 1
            else:
                web.faces[f, c % 3] = u
                web.link[c], left = left, c
        c = after
    web.head[v] = -1
    c = web.head[u]
    while c >= 0:
        after = web.link[c]
        if web.alive[c // 3]:
            web.link[c], left = left, c
        c = after
    web.head[u] = left
    for n in range(10):
        web.quadric[u, n] += web.quadric[v, n]
    for n in range(3):
        web.upright[u, n] += web.upright[v, n]


@njit(cache=True, error_model="numpy")
def take(web, order, onto, least):
    """Takes the ways of the vertices in `order`, none of which was chosen before its end was moved onto, until `least`
    faces are left; how many were taken."""
    ring, grown = np.zeros(WIDEST, np.int64), np.zeros(len(web.x), np.bool_)
    taken = 0
    for n in range(len(order)):
        if web.count[0] <= least:
            break
        v = order[n]
        u = onto[v]
        if not grown[v] and web.head[u] >= 0 and _sound(web, v, u, ring):
            _collapse(web, v, u)
            grown[u] = True
            taken += 1
    return taken


@njit(cache=True, error_model="numpy")
def evened(web, used, out):
    """Places (N, 3) of the used vertices (N,), each moved along its normal to the middle of what it stands for, by no
    more than a third of its shortest edge."""
    ring = np.zeros(WIDEST, np.int64)
    for n in range(len(used)):
        v = used[n]
        x, y, z = web.x[v, 0], web.x[v, 1], web.x[v, 2]
        nx, ny, nz = web.upright[v, 0], web.upright[v, 1], web.upright[v, 2]
        size = math.sqrt(nx * nx + ny * ny + nz * nz)
        out[n, 0], out[n, 1], out[n, 2] = x, y, z
        many = _ring(web, v, ring)
        if size == 0.0 or many <= 0:
            continue
        nx, ny, nz = nx / size, ny / size, nz / size
        q = web.quadric[v]
        gx = q[0] * x + q[1] * y + q[2] * z + q[3]
        gy = q[1] * x + q[4] * y + q[5] * z + q[6]
        gz = q[2] * x + q[5] * y + q[7] * z + q[8]
        bend = nx * (q[0] * nx + q[1] * ny + q[2] * nz) + ny * (q[1] * nx + q[4] * ny + q[5] * nz)
        bend += nz * (q[2] * nx + q[5] * ny + q[7] * nz)
        if bend <= 0.0:
            continue
        shortest = math.inf
        for m in range(many):
            shortest = min(shortest, _far(web.x, v, ring[m]))
        most = math.sqrt(shortest) / 3.0
        way = min(max(-(nx * gx + ny * gy + nz * gz) / bend, -most), most)
        out[n, 0], out[n, 1], out[n, 2] = x + way * nx, y + way * ny, z + way * nz
