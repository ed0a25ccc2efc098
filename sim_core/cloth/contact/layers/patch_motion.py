"""How patches move: each as a whole, and what is left of that; by how much two can have come nearer to each other."""

from __future__ import annotations

import math

from numba import njit

from sim_core.cloth.contact.layers.patches import WHOLE


@njit(error_model="numpy", inline="always")
def _turn(second, moments):
    """The rotation (3 numbers) with such moments of ways about a middle, for second moments xx, yy, zz, xy, xz, yz of
    the places there."""
    (xx, yy, zz, xy, xz, yz), (tx, ty, tz) = second, moments
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
def _rigid(x, y, sign, patches, shapes, first):
    """How each busy patch moves as a whole, and what is left of that, into shapes.moved[:, first:first + WHOLE].

    Its vertices lie at x (V, 3) and go by y - x (sign -1) or by y (sign 0).
    """
    corners, start, moved, busy = patches.corners, patches.corner_start, shapes.moved, shapes.busy
    for p in range(len(start) - 1):
        if not busy[p]:
            continue
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
        wx, wy, wz = _turn((xx, yy, zz, xy, xz, yz), (tx, ty, tz))
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
def move_patches(x, v, mark, patches, shapes):
    """How busy patches have come from the mark (V, 3), and how they go, into Shapes.moved."""
    _rigid(mark, x, -1.0, patches, shapes, 0)
    _rigid(x, v, 0.0, patches, shapes, WHOLE)


@njit(cache=True, error_model="numpy")
def going_patches(x, v, patches, shapes):
    """How all patches go, into Shapes.moved."""
    shapes.busy[:] = True
    _rigid(x, v, 0.0, patches, shapes, WHOLE)


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
    wx, wy, wz = _turn((xx, yy, zz, xy, xz, yz), (tx, ty, tz))
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
