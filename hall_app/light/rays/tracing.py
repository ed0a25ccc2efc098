"""Rays through the tree: the nearest triangle they meet, or whether anything is in their way."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hall_app.light.rays.bvh import WIDTH, Tree

__all__ = ["FAR", "cast", "lanes", "nearest", "occluded", "stack"]

FAR = np.float32(1e30)  # [m] the length of a ray that nothing ends
_RIM = np.float32(-2e-6)  # barycentric: neighbours overlap by this, so that no ray slips between them
_TINY = np.float32(1e-12)


def stack(tree: Tree) -> NDArray[np.float32]:
    """(2, S) room for one thread's open nodes: number and distance."""
    return np.zeros((2, tree.depth * (WIDTH - 1) + WIDTH + 1), np.float32)


def lanes() -> NDArray[np.float32]:
    """(3, 8) room for one thread's results of one node or pack."""
    return np.zeros((3, WIDTH), np.float32)


@njit(cache=True, error_model="numpy", nogil=True, inline="never")
def _enter(box, ox, oy, oz, ix, iy, iz, limit, near):
    """Distances at which the ray enters the eight boxes, FAR where it does not before `limit`."""
    for k in range(8):
        x0, x1 = (box[0, k] - ox) * ix, (box[3, k] - ox) * ix
        y0, y1 = (box[1, k] - oy) * iy, (box[4, k] - oy) * iy
        z0, z1 = (box[2, k] - oz) * iz, (box[5, k] - oz) * iz
        a, b = (x0 if x0 < x1 else x1), (x1 if x0 < x1 else x0)
        c, d = (y0 if y0 < y1 else y1), (y1 if y0 < y1 else y0)
        e, f = (z0 if z0 < z1 else z1), (z1 if z0 < z1 else z0)
        a = c if c > a else a
        a = e if e > a else a
        a = np.float32(0.0) if a < np.float32(0.0) else a
        b = d if d < b else b
        b = f if f < b else b
        b = limit if limit < b else b
        near[k] = a if a <= b else FAR


@njit(cache=True, error_model="numpy", nogil=True, inline="never")
def _meet(pack, ox, oy, oz, dx, dy, dz, found):
    """Möller–Trumbore on eight triangles: distance (FAR where missed) and the two barycentric coordinates."""
    for k in range(8):
        ax, ay, az = pack[3, k], pack[4, k], pack[5, k]
        bx, by, bz = pack[6, k], pack[7, k], pack[8, k]
        px, py, pz = dy * bz - dz * by, dz * bx - dx * bz, dx * by - dy * bx
        det = ax * px + ay * py + az * pz
        inverse = np.float32(1.0) / det
        tx, ty, tz = ox - pack[0, k], oy - pack[1, k], oz - pack[2, k]
        u = (tx * px + ty * py + tz * pz) * inverse
        qx, qy, qz = ty * az - tz * ay, tz * ax - tx * az, tx * ay - ty * ax
        v = (dx * qx + dy * qy + dz * qz) * inverse
        t = (bx * qx + by * qy + bz * qz) * inverse
        inside = (u >= _RIM) & (v >= _RIM) & (u + v <= np.float32(1.0) - _RIM) & (t > np.float32(0.0))
        found[0, k] = t if inside & (det * det > np.float32(1e-24)) else FAR
        found[1, k] = u
        found[2, k] = v


@njit(cache=True, error_model="numpy", nogil=True)
def nearest(tree, ox, oy, oz, dx, dy, dz, limit, opened, room, hit):
    """The nearest triangle a ray from o along the unit vector d meets before `limit`, −1: none.

    opened, room: `stack` and `lanes` of the thread; hit: (3,) float32 takes distance [m] and barycentric u, v.
    """
    boxes, child, packs, face = tree.boxes, tree.child, tree.packs, tree.face
    near = room[0]
    ix = np.float32(1.0) / (dx if abs(dx) > _TINY else _TINY)
    iy = np.float32(1.0) / (dy if abs(dy) > _TINY else _TINY)
    iz = np.float32(1.0) / (dz if abs(dz) > _TINY else _TINY)
    best, found = limit, -1
    top = 1
    opened[0, 0], opened[1, 0] = np.float32(0.0), np.float32(0.0)
    while top > 0:
        top -= 1
        if opened[1, top] >= best:
            continue
        node = int(opened[0, top])
        if node < 0:
            pack = -1 - node
            _meet(packs[pack], ox, oy, oz, dx, dy, dz, room)
            for k in range(8):
                if room[0, k] < best:
                    best, found = room[0, k], face[pack, k]
                    hit[1], hit[2] = room[1, k], room[2, k]
            continue
        _enter(boxes[node], ox, oy, oz, ix, iy, iz, best, near)
        first = top
        for k in range(8):
            t = near[k]
            if t < best:
                place = top
                while place > first and opened[1, place - 1] < t:
                    opened[0, place], opened[1, place] = opened[0, place - 1], opened[1, place - 1]
                    place -= 1
                opened[0, place], opened[1, place] = np.float32(child[node, k]), t
                top += 1
    hit[0] = best
    return found


@njit(cache=True, error_model="numpy", nogil=True)
def occluded(tree, ox, oy, oz, dx, dy, dz, limit, opened, room):
    """Whether anything is met before `limit` [m]."""
    boxes, child, packs = tree.boxes, tree.child, tree.packs
    near = room[0]
    ix = np.float32(1.0) / (dx if abs(dx) > _TINY else _TINY)
    iy = np.float32(1.0) / (dy if abs(dy) > _TINY else _TINY)
    iz = np.float32(1.0) / (dz if abs(dz) > _TINY else _TINY)
    top = 1
    opened[0, 0] = np.float32(0.0)
    while top > 0:
        top -= 1
        node = int(opened[0, top])
        if node < 0:
            _meet(packs[-1 - node], ox, oy, oz, dx, dy, dz, room)
            for k in range(8):
                if room[0, k] < limit:
                    return True
            continue
        _enter(boxes[node], ox, oy, oz, ix, iy, iz, limit, near)
        for k in range(8):
            if near[k] < limit:
                opened[0, top] = np.float32(child[node, k])
                top += 1
    return False


@njit(cache=True, error_model="numpy", nogil=True)
def _cast(tree, origins, directions, limit, opened, room, face, distance, bary):
    hit = np.zeros(3, np.float32)
    for i in range(len(origins)):
        o, d = origins[i], directions[i]
        face[i] = nearest(tree, o[0], o[1], o[2], d[0], d[1], d[2], limit[i], opened, room, hit)
        distance[i] = hit[0]
        bary[i, 0], bary[i, 1] = hit[1], hit[2]


def cast(tree: Tree, origins, directions):
    """face (N,) int32 (−1: none), distance (N,) [m], barycentric (N, 2) of the nearest hits of rays (N, 3)."""
    o, d = (np.ascontiguousarray(a, np.float32) for a in (origins, directions))
    face, distance = np.zeros(len(o), np.int32), np.zeros(len(o), np.float32)
    bary, most = np.zeros((len(o), 2), np.float32), np.full(len(o), FAR, np.float32)
    _cast(tree, o, d, most, stack(tree), lanes(), face, distance, bary)
    return face, distance, bary
