"""Compiled signed distances and their gradients, one function per kind of solid."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from sim_core.cloth.contact.closest_points import triangle_weights
from sim_core.cloth.contact.packed import BOX, CAPSULE, CYLINDER, GRID, MOVING, Fields


@njit(cache=True, error_model="numpy")
def _capsule(r, x, y, z):
    ax, ay, az = r[3] - r[0], r[4] - r[1], r[5] - r[2]
    px, py, pz = x - r[0], y - r[1], z - r[2]
    long2 = ax * ax + ay * ay + az * az
    t = 0.0
    if long2 > 0.0:
        t = min(1.0, max(0.0, (px * ax + py * ay + pz * az) / long2))
    px, py, pz = px - t * ax, py - t * ay, pz - t * az
    far = math.sqrt(px * px + py * py + pz * pz)
    if far < 1e-12:
        return -r[6], 0.0, 1.0, 0.0
    return far - r[6], px / far, py / far, pz / far


@njit(cache=True, error_model="numpy")
def _cylinder(r, x, y, z):
    px, py, pz = x - r[0], y - r[1], z - r[2]
    along = px * r[3] + py * r[4] + pz * r[5]
    px, py, pz = px - along * r[3], py - along * r[4], pz - along * r[5]
    radial = math.sqrt(px * px + py * py + pz * pz)
    side = 1.0 if along >= 0.0 else -1.0
    # In the (radial, axial) half plane a rounded cylinder is a rounded box.
    out = radial - (r[7] - r[8])
    up = abs(along) - (r[6] - r[8])
    if out > 0.0 and up > 0.0:
        far = math.sqrt(out * out + up * up)
        go, gu, d = out / far, up / far, far
    elif out > up:
        go, gu, d = 1.0, 0.0, out
    else:
        go, gu, d = 0.0, 1.0, up
    if radial < 1e-12:
        return d - r[8], gu * side * r[3], gu * side * r[4], gu * side * r[5]
    go, gu = go / radial, gu * side
    return d - r[8], go * px + gu * r[3], go * py + gu * r[4], go * pz + gu * r[5]


@njit(cache=True, error_model="numpy")
def _box(r, x, y, z):
    px, py, pz = x - r[0], y - r[1], z - r[2]
    c, s = r[7], r[8]
    px, pz = c * px - s * pz, s * px + c * pz
    sx, sy, sz = math.copysign(1.0, px), math.copysign(1.0, py), math.copysign(1.0, pz)
    qx, qy, qz = abs(px) - (r[3] - r[6]), abs(py) - (r[4] - r[6]), abs(pz) - (r[5] - r[6])
    top = max(qx, qy, qz)
    if top > 0.0:
        ox, oy, oz = max(qx, 0.0), max(qy, 0.0), max(qz, 0.0)
        d = math.sqrt(ox * ox + oy * oy + oz * oz)
        gx, gy, gz = ox / d, oy / d, oz / d
    else:
        d = top
        gx, gy, gz = (
            1.0 * (qx == top),
            1.0 * (qy == top and qx != top),
            1.0 * (qz == top and qx != top and qy != top),
        )
    gx, gy, gz = gx * sx, gy * sy, gz * sz
    return d - r[6], c * gx + s * gz, gy, -s * gx + c * gz


@njit(error_model="numpy", inline="always")
def _within(u, count):
    """The nearest place in a row of `count` nodes that has one behind it; NaN, of a frame that blew up, is its begin.

    min and max would hand NaN on, and as an index it leads out of the grid.
    """
    u = u if u > 0.0 else 0.0
    last = count - 1.000001
    return u if u < last else last


@njit(error_model="numpy", inline="always")
def _grid(data, p, grid, x, y, z):
    """Trilinear value and gradient; outside the box the value at its border plus the way there."""
    nx, ny, nz = grid.shape
    size = data[p, 3]
    per = 1.0 / size
    u, v, w = (x - data[p, 0]) * per, (y - data[p, 1]) * per, (z - data[p, 2]) * per
    cu, cv, cw = _within(u, nx), _within(v, ny), _within(w, nz)
    ox, oy, oz = (u - cu) * size, (v - cv) * size, (w - cw) * size
    i, j, k = np.uint64(cu), np.uint64(cv), np.uint64(cw)
    a, b, c = cu - i, cv - j, cw - k
    one = np.uint64(1)
    g000, g001 = float(grid[i, j, k]), float(grid[i, j, k + one])
    g010, g011 = float(grid[i, j + one, k]), float(grid[i, j + one, k + one])
    g100, g101 = float(grid[i + one, j, k]), float(grid[i + one, j, k + one])
    g110 = float(grid[i + one, j + one, k])
    g111 = float(grid[i + one, j + one, k + one])
    x00, x01, x10, x11 = g100 - g000, g101 - g001, g110 - g010, g111 - g011
    h00, h01, h10, h11 = g000 + a * x00, g001 + a * x01, g010 + a * x10, g011 + a * x11
    lo, hi = h00 + b * (h10 - h00), h01 + b * (h11 - h01)
    dx = (1.0 - c) * (x00 + b * (x10 - x00)) + c * (x01 + b * (x11 - x01))
    dy = (1.0 - c) * (h10 - h00) + c * (h11 - h01)
    away = math.sqrt(ox * ox + oy * oy + oz * oz)
    value, gx, gy, gz = (1 - c) * lo + c * hi, dx * per, dy * per, (hi - lo) * per
    if away > 0.0:
        value, gx, gy, gz = value + away, ox / away, oy / away, oz / away
    return value, gx, gy, gz


@njit(cache=True, error_model="numpy")
def fields_of(packed):
    """The `Fields` of a `Packed`."""
    return Fields(packed.kind, packed.data, packed.grid, packed.later, packed.blend)


@njit(cache=True, error_model="numpy")
def _exact(kind, row, x, y, z):
    """Distance and gradient of a solid that is no grid."""
    if kind == CAPSULE:
        return _capsule(row, x, y, z)
    if kind == CYLINDER:
        return _cylinder(row, x, y, z)
    if kind == BOX:
        return _box(row, x, y, z)
    gx, gy, gz = row[0], row[1], row[2]
    return (x - row[3]) * gx + (y - row[4]) * gy + (z - row[5]) * gz, gx, gy, gz


@njit(error_model="numpy", inline="always")
def distance_at(kind, data, grid, later, blend, x, y, z):
    """`signed_distance` for loops over many points, which name the arrays of `Fields` once: taken out of the record
    each is counted, at every point. Also at which speed [m/s] any solid comes nearer, be it not the nearest yet.
    """
    best, bx, by, bz, speed, drift = np.inf, 0.0, 1.0, 0.0, 0.0, 0.0
    for p in range(len(kind)):
        around = data[p, 19]
        reach = best + around
        if around >= 0.0:
            ux, uy, uz = x - data[p, 16], y - data[p, 17], z - data[p, 18]
            if ux * ux + uy * uy + uz * uz > reach * abs(reach):
                continue  # not even the ball around it is nearer than the best
        w = 0.0
        if kind[p] >= GRID:
            d, gx, gy, gz = _grid(data, p, grid, x, y, z)
            if kind[p] == MOVING:
                e, hx, hy, hz = _grid(data, p, later, x, y, z)
                s = blend[0]
                w = -(e - d) * blend[1]
                drift = max(drift, w)
                d, gx = (1.0 - s) * d + s * e, (1.0 - s) * gx + s * hx
                gy, gz = (1.0 - s) * gy + s * hy, (1.0 - s) * gz + s * hz
            size = math.sqrt(gx * gx + gy * gy + gz * gz)
            # Between two surfaces the sampled gradient shrinks; pushing along it throws vertices to and fro.
            size = size if size >= 0.75 else np.inf
            gx, gy, gz = gx / size, gy / size, gz / size
        else:
            d, gx, gy, gz = _exact(kind[p], data[p], x, y, z)
        if d < best:
            best, bx, by, bz, speed = d, gx, gy, gz, w
    return best, bx, by, bz, speed, drift


@njit(cache=True, error_model="numpy")
def signed_distance(fields, x, y, z):
    """Distance [m], unit gradient (x, y, z) and the surface's speed along it [m/s] at a point.

    The gradient is 0 where a grid has none (medial axis). A moving grid is blended between two keys; its surface
    moves by what the distance loses.
    """
    kind, data, grid, later, blend = fields
    d, nx, ny, nz, speed, _ = distance_at(kind, data, grid, later, blend, x, y, z)
    return d, (nx, ny, nz), speed


@njit(cache=True, error_model="numpy")
def carried(packed, d, x, y, z):
    """Velocity [m/s] of the body's surface nearest to a point, d [m] from the nearest solid.

    0 far from the body, and where that solid is one that stands still beside it.
    """
    if len(packed.kind) > 1:
        still = Fields(packed.kind[1:], packed.data[1:], packed.grid, packed.later, packed.blend)
        if signed_distance(still, x, y, z)[0] <= d + 1e-12:
            return 0.0, 0.0, 0.0
    row, (nx, ny, nz) = packed.data[0], packed.nearest.shape
    i = int(_within((x - row[0]) / row[3], nx) + 0.5)
    j = int(_within((y - row[1]) / row[3], ny) + 0.5)
    k = int(_within((z - row[2]) / row[3], nz) + 0.5)
    f, rate, s = packed.nearest[i, j, k], packed.blend[1], packed.blend[0]
    if f < 0:
        return 0.0, 0.0, 0.0
    at, ways = packed.corners[f], packed.ways[f]
    a, b, c = triangle_weights(
        (x, y, z),
        (at[0, 0] + s * ways[0, 0], at[0, 1] + s * ways[0, 1], at[0, 2] + s * ways[0, 2]),
        (at[1, 0] + s * ways[1, 0], at[1, 1] + s * ways[1, 1], at[1, 2] + s * ways[1, 2]),
        (at[2, 0] + s * ways[2, 0], at[2, 1] + s * ways[2, 1], at[2, 2] + s * ways[2, 2]),
    )
    return (
        rate * (a * ways[0, 0] + b * ways[1, 0] + c * ways[2, 0]),
        rate * (a * ways[0, 1] + b * ways[1, 1] + c * ways[2, 1]),
        rate * (a * ways[0, 2] + b * ways[1, 2] + c * ways[2, 2]),
    )


@njit(cache=True, error_model="numpy")
def distances(packed, points):
    """Signed distance (N,) at points (N, 3)."""
    out, (kind, data, grid, later, blend) = np.zeros(len(points)), fields_of(packed)
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        out[i] = distance_at(kind, data, grid, later, blend, x, y, z)[0]
    return out
