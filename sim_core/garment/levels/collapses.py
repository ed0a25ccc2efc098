"""Half-edge collapses in the order of their quadric error (Garland and Heckbert 1997), compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

SHAPE_WEIGHT = 2e-3  # of short ways
LEAST_SHAPE = 0.05  # area over longest side squared; 0.43 is equilateral
TURN = 0.2  # cosine between a face's old and new normal
TWINS = 32  # of one vertex, that move at once


class Mesh(NamedTuple):
    """V vertices in M moments, P pattern vertices, F faces; the corner k of face f is number 3 f + k."""

    x: np.ndarray  # (V, 3 M) [m]; ways and turns are looked at in the first moment
    flat: np.ndarray  # (P, 2) [m], or (0, 2)
    weld: np.ndarray  # (P,) int64
    faces: np.ndarray  # (F, 3) int64
    alive: np.ndarray  # (F,) bool
    head: np.ndarray  # (V,) a corner of each vertex, or -1
    link: np.ndarray  # (3 F,) the next one
    lines: np.ndarray  # (N,) neighbours along borders and seams, or -1
    line_start: np.ndarray  # (V + 1,)
    stays: np.ndarray  # (V,) bool
    quadric: np.ndarray  # (V, 10 M)
    version: np.ndarray  # (V,) int64: what the heap holds of an older one counts no more
    count: np.ndarray  # (1,) int64 of the faces that are left
    ring: np.ndarray  # (V,) int64 working memory
    met: np.ndarray  # (V,) int64 likewise: when each vertex was met last
    clock: np.ndarray  # (1,) int64
    old: np.ndarray  # (TWINS,) int64 pattern vertices that move
    new: np.ndarray  # (TWINS,) int64 to where


class Heap(NamedTuple):
    """Ways of vertices onto others, the one of the least error first, then the lower vertices."""

    error: np.ndarray  # (N,)
    way: np.ndarray  # (N, 3) int64 vertex, onto which, and its version
    size: np.ndarray  # (1,) int64


@njit(error_model="numpy", inline="always")
def _before(error, way, n, m):
    """Whether the entry n of a heap goes before the entry m."""
    if error[n] != error[m]:
        return error[n] < error[m]
    if way[n, 0] != way[m, 0]:
        return way[n, 0] < way[m, 0]
    return way[n, 1] < way[m, 1] if way[n, 1] != way[m, 1] else way[n, 2] < way[m, 2]


@njit(error_model="numpy", inline="always")
def _swap(error, way, n, m):
    error[n], error[m] = error[m], error[n]
    for c in range(3):
        way[n, c], way[m, c] = way[m, c], way[n, c]


@njit(cache=True, error_model="numpy")
def _pushed(heap, error, v, u, version):
    """The heap with one more way."""
    size = heap.size[0]
    if size == len(heap.error):
        wider = Heap(np.zeros(2 * size), np.zeros((2 * size, 3), np.int64), heap.size)
        wider.error[:size], wider.way[:size] = heap.error, heap.way
        heap = wider
    errors, way = heap.error, heap.way
    errors[size], way[size, 0], way[size, 1], way[size, 2] = error, v, u, version
    heap.size[0] = size + 1
    while size > 0 and _before(errors, way, size, (size - 1) // 2):
        _swap(errors, way, size, (size - 1) // 2)
        size = (size - 1) // 2
    return heap


@njit(cache=True, error_model="numpy")
def _popped(heap):
    """The first way, which leaves the heap: vertex, onto which, and its version."""
    error, way, last = heap.error, heap.way, heap.size[0] - 1
    v, u, version = way[0, 0], way[0, 1], way[0, 2]
    _swap(error, way, 0, last)
    heap.size[0] = last
    n = 0
    while 2 * n + 1 < last:
        m = 2 * n + 1
        if m + 1 < last and _before(error, way, m + 1, m):
            m += 1
        if not _before(error, way, m, n):
            break
        _swap(error, way, n, m)
        n = m
    return v, u, version


@njit(cache=True, error_model="numpy")
def offer_all(mesh, heap):
    """The heap with all ways of all vertices."""
    for v in range(len(mesh.x)):
        heap = _offer(mesh, heap, v)
    return heap


@njit(cache=True, error_model="numpy")
def thin(mesh, heap, triangles):
    """Collapses edges until at most so many triangles are left, or no collapse is sound; returns the heap."""
    while mesh.count[0] > triangles and heap.size[0] > 0:
        v, u, version = _popped(heap)
        if version == mesh.version[v]:
            moves = _sound(mesh, v, u)
            if moves > 0:
                heap = _collapse(mesh, heap, v, u, moves)
    return heap


@njit(cache=True, error_model="numpy")
def _neighbours(mesh, v, first):
    """Appends the neighbours of v that this tick of the clock has not met to mesh.ring[:first]; how many it holds."""
    weld, faces, met, now = mesh.weld, mesh.faces, mesh.met, mesh.clock[0]
    c = mesh.head[v]
    while c >= 0:
        f = c // 3
        if mesh.alive[f]:
            for k in range(3):
                u = weld[faces[f, k]]
                if u != v and met[u] != now:
                    met[u] = now
                    mesh.ring[first] = u
                    first += 1
        c = mesh.link[c]
    return first


@njit(cache=True, error_model="numpy")
def _common(mesh, v, u):
    """How many neighbours two vertices share."""
    mesh.clock[0] += 1
    mine = _neighbours(mesh, v, 0)
    others = _neighbours(mesh, u, mine) - mine  # of u, but not of v
    mesh.clock[0] += 1
    return _neighbours(mesh, u, 0) - others


@njit(cache=True, error_model="numpy")
def _offer(mesh, heap, v):
    """The heap with all ways v may go."""
    mesh.version[v] += 1
    start, end = mesh.line_start[v], mesh.line_start[v + 1]
    along = 0
    for n in range(start, end):
        along += mesh.lines[n] >= 0
    if mesh.stays[v] or along not in (0, 2):
        return heap
    mesh.clock[0] += 1
    many = _neighbours(mesh, v, 0)
    if many == 0:
        return heap
    if along > 0:
        many = 0
        for n in range(start, end):
            if mesh.lines[n] >= 0:
                mesh.ring[many] = mesh.lines[n]
                many += 1
    x, q = mesh.x, mesh.quadric
    for n in range(many):
        u = mesh.ring[n]
        way = (x[v, 0] - x[u, 0]) ** 2 + (x[v, 1] - x[u, 1]) ** 2 + (x[v, 2] - x[u, 2]) ** 2
        error = _error(q, v, x, u) + SHAPE_WEIGHT * way * q[v, 9] * 1e-3
        heap = _pushed(heap, error, v, u, mesh.version[v])
    return heap


@njit(cache=True, error_model="numpy")
def _sound(mesh, v, u):
    """How many pattern vertices move where v goes to u, into mesh.old and mesh.new: each twin of v to the twin of u
    that lies in one face with it. 0 where that makes a pinch, or a turned or needle-like face, in space or pattern.
    """
    weld, faces, alive = mesh.weld, mesh.faces, mesh.alive
    shared = moves = 0
    c = mesh.head[v]
    while c >= 0:
        f = c // 3
        if alive[f]:
            p = -1
            for k in range(3):
                if weld[faces[f, k]] == u:
                    p = faces[f, k]
            if p >= 0:
                shared += 1
                known = False
                for n in range(moves):
                    if mesh.old[n] == faces[f, c % 3]:
                        known = True
                        if mesh.new[n] != p:
                            return 0
                if not known:
                    if moves == TWINS:
                        return 0
                    mesh.old[moves], mesh.new[moves] = faces[f, c % 3], p
                    moves += 1
        c = mesh.link[c]
    if shared == 0:
        return 0
    if _common(mesh, v, u) != shared:
        return 0
    c = mesh.head[v]
    while c >= 0:
        f = c // 3
        if alive[f]:
            a, b, d = faces[f, 0], faces[f, 1], faces[f, 2]
            if weld[a] != u and weld[b] != u and weld[d] != u:
                a, b, d = _moved(mesh, a, moves), _moved(mesh, b, moves), _moved(mesh, d, moves)
                left = weld[a] == v or weld[b] == v or weld[d] == v
                if left or not _fair(mesh, f, a, b, d):
                    return 0
        c = mesh.link[c]
    return moves


@njit(error_model="numpy", inline="always")
def _moved(mesh, p, moves):
    for n in range(moves):
        if mesh.old[n] == p:
            return mesh.new[n]
    return p


@njit(cache=True, error_model="numpy")
def _fair(mesh, f, a, b, c):
    """Whether the face f may have the corners a, b, c."""
    x, weld, faces = mesh.x, mesh.weld, mesh.faces
    n = _normal(x, weld[faces[f, 0]], weld[faces[f, 1]], weld[faces[f, 2]])
    i, j, k = weld[a], weld[b], weld[c]
    m = _normal(x, i, j, k)
    size, old = math.sqrt(m[0] ** 2 + m[1] ** 2 + m[2] ** 2), math.sqrt(n[0] ** 2 + n[1] ** 2 + n[2] ** 2)
    longest = max(_far(x, i, j), _far(x, j, k), _far(x, k, i))
    if 0.5 * size < LEAST_SHAPE * longest or n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < TURN * old * size:
        return False
    flat = mesh.flat
    if len(flat) == 0:
        return True
    turn = (flat[b, 1] - flat[a, 1]) * (flat[c, 0] - flat[a, 0])
    turn -= (flat[b, 0] - flat[a, 0]) * (flat[c, 1] - flat[a, 1])
    return turn > 0.02 * longest  # positive in (x, -y)


@njit(cache=True, error_model="numpy")
def _collapse(mesh, heap, v, u, moves):
    weld, faces, link, head, lines, start = (
        mesh.weld,
        mesh.faces,
        mesh.link,
        mesh.head,
        mesh.lines,
        mesh.line_start,
    )
    mesh.clock[0] += 1
    many = _neighbours(mesh, u, _neighbours(mesh, v, 0))  # v is among them
    c, left = head[v], -1
    while c >= 0:
        after, f = link[c], c // 3
        if mesh.alive[f]:
            if weld[faces[f, 0]] == u or weld[faces[f, 1]] == u or weld[faces[f, 2]] == u:
                mesh.alive[f] = False
                mesh.count[0] -= 1
            else:
                faces[f, c % 3] = _moved(mesh, faces[f, c % 3], moves)
                link[c], left = left, c
        c = after
    head[v] = -1
    c = head[u]
    while c >= 0:
        after = link[c]
        if mesh.alive[c // 3]:
            link[c], left = left, c
        c = after
    head[u] = left
    for n in range(start[v], start[v + 1]):
        w = lines[n]
        lines[n] = -1
        if w >= 0 and w != u:  # there are two, and u is the other one
            _replace(lines, start, w, v, u)
            _replace(lines, start, u, v, w)
    for n in range(mesh.quadric.shape[1]):
        mesh.quadric[u, n] += mesh.quadric[v, n]
    mesh.version[v] += 1
    for w in mesh.ring[:many].copy():  # which offers write over
        if w != v:
            heap = _offer(mesh, heap, w)
    return heap


@njit(cache=True, error_model="numpy")
def _replace(lines, start, v, old, new):
    """Puts a neighbour along v's lines in the place of another, once."""
    place = -1
    for n in range(start[v], start[v + 1]):
        if lines[n] == old:
            place = n
        elif lines[n] == new:
            new = -1
    if place >= 0:
        lines[place] = new


@njit(error_model="numpy", inline="always")
def _normal(x, i, j, k):
    ux, uy, uz = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
    vx, vy, vz = x[k, 0] - x[i, 0], x[k, 1] - x[i, 1], x[k, 2] - x[i, 2]
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


@njit(error_model="numpy", inline="always")
def _far(x, i, j):
    return (x[i, 0] - x[j, 0]) ** 2 + (x[i, 1] - x[j, 1]) ** 2 + (x[i, 2] - x[j, 2]) ** 2


@njit(cache=True, error_model="numpy")
def _error(quadric, v, places, u):
    """Sum of weighted squared distances of the vertex u to all planes of v, in the moment when that is worst."""
    worst = 0.0
    for n in range(quadric.shape[1] // 10):
        q, (x, y, z) = quadric[v, 10 * n : 10 * n + 10], places[u, 3 * n : 3 * n + 3]
        square = q[0] * x * x + q[4] * y * y + q[7] * z * z + q[9]
        cross = q[1] * x * y + q[2] * x * z + q[5] * y * z
        worst = max(worst, square + 2 * (cross + q[3] * x + q[6] * y + q[8] * z))
    return worst
