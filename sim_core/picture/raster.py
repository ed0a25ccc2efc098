"""Compiled triangle rasteriser behind `picture`: which triangle is nearest in each pixel, and depth maps."""

from __future__ import annotations

import numpy as np
from numba import njit

LAYERS = 8  # sheer layers kept per pixel, the nearest ones
HALF = 0.5 - 1e-9
NARROW = 6  # pixels of a triangle's box, up to which each is tried


@njit(error_model="numpy", inline="always")
def spread(screen, i, j, k, width, height):
    """Of a screen triangle its first and last column and row of pixels whose middles it may cover (none: last < first),
    and the barycentric weights u of i and v of j: at the origin, and their growth a pixel along x and y.
    """
    ax, ay, bx, by, cx, cy = (
        screen[i, 0], screen[i, 1], screen[j, 0], screen[j, 1], screen[k, 0], screen[k, 1],
    )  # fmt: skip
    # Middles lie at halves: rounded up from the least, down from the most.
    x0 = int(min(max(min(ax, bx, cx) + HALF, 0.0), width))
    x1 = int(min(max(max(ax, bx, cx) + 0.5, 0.0), width)) - 1
    y0 = int(min(max(min(ay, by, cy) + HALF, 0.0), height))
    y1 = int(min(max(max(ay, by, cy) + 0.5, 0.0), height)) - 1
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if area == 0.0:
        x1 = x0 - 1
    over = 1.0 / area
    ux, uy, vx, vy = (by - cy) * over, (cx - bx) * over, (cy - ay) * over, (ax - cx) * over
    return x0, x1, y0, y1, -ux * cx - uy * cy, ux, uy, -vx * cx - vy * cy, vx, vy


@njit(error_model="numpy", inline="always")
def narrowed(u, ux, v, vx, x0, x1):
    """Columns between x0 and x1 whose middles may lie in the triangle; one too many at either end. u, v: at x = 0."""
    low, high = x0 + 0.5, x1 + 0.5
    w, wx = 1.0 - u - v, -ux - vx
    if ux > 0.0:
        low = max(low, -u / ux)
    elif ux < 0.0:
        high = min(high, -u / ux)
    if vx > 0.0:
        low = max(low, -v / vx)
    elif vx < 0.0:
        high = min(high, -v / vx)
    if wx > 0.0:
        low = max(low, -w / wx)
    elif wx < 0.0:
        high = min(high, -w / wx)
    if not low <= high + 1.0:
        return 1, 0
    return max(int(low - 0.5), x0), min(int(high + 0.5), x1)


@njit(cache=True, error_model="numpy")
def depth_map(screen, faces, depth):
    """Smallest screen z per pixel into depth (h, w); screen (V, 3): x, y [pixel], z."""
    height, width = depth.shape
    for f in range(len(faces)):
        i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
        x0, x1, y0, y1, u0, ux, uy, v0, vx, vy = spread(screen, i, j, k, width, height)
        if x1 < x0 or y1 < y0:
            continue
        base = screen[k, 2]
        rise, lean = screen[i, 2] - base, screen[j, 2] - base
        first, last = x0, x1
        for py in range(y0, y1 + 1):
            ur, vr = u0 + uy * (py + 0.5), v0 + vy * (py + 0.5)
            if x1 - x0 > NARROW:
                first, last = narrowed(ur, ux, vr, vx, x0, x1)
            for px in range(first, last + 1):
                u, v = ur + ux * (px + 0.5), vr + vx * (px + 0.5)
                z, before = base + u * rise + v * lean, depth[py, px]
                nearer = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (z < before)
                depth[py, px] = z if nearer else before  # no branch that nobody can foretell


@njit(cache=True, error_model="numpy")
def nearest_faces(screen, faces, which, near, owner):
    """Of `which` (K,) of the faces the nearest in each pixel into owner (h, w) int32, and the inverse of its distance
    into near (h, w), which begin with -1 and 0; screen (V, 3): x, y [pixel], 1 / distance.
    """
    height, width = near.shape
    for n in range(len(which)):
        f = which[n]
        i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
        base = screen[k, 2]
        rise, lean = screen[i, 2] - base, screen[j, 2] - base
        if base <= 0.0 or base + rise <= 0.0 or base + lean <= 0.0:  # behind the eye
            continue
        x0, x1, y0, y1, u0, ux, uy, v0, vx, vy = spread(screen, i, j, k, width, height)
        if x1 < x0 or y1 < y0:
            continue
        first, last = x0, x1
        for py in range(y0, y1 + 1):
            ur, vr = u0 + uy * (py + 0.5), v0 + vy * (py + 0.5)
            if x1 - x0 > NARROW:
                first, last = narrowed(ur, ux, vr, vx, x0, x1)
            for px in range(first, last + 1):
                u, v = ur + ux * (px + 0.5), vr + vx * (px + 0.5)
                if u >= 0.0 and v >= 0.0 and u + v <= 1.0:
                    z = base + u * rise + v * lean
                    if z > near[py, px]:
                        near[py, px], owner[py, px] = z, f


@njit(cache=True, error_model="numpy")
def sheer_faces(screen, faces, which, near, count, layer_near, layer_face):
    """Of `which` (K,) of the faces those before the opaque ones, the LAYERS nearest of each pixel from near to far.

    near (h, w): of the opaque, as `nearest_faces` left it; count (h, w) uint8 begins with 0, layer_near and layer_face
    (h, w, LAYERS) are filled so far.
    """
    height, width = near.shape
    for n in range(len(which)):
        f = which[n]
        i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
        base = screen[k, 2]
        rise, lean = screen[i, 2] - base, screen[j, 2] - base
        if base <= 0.0 or base + rise <= 0.0 or base + lean <= 0.0:
            continue
        x0, x1, y0, y1, u0, ux, uy, v0, vx, vy = spread(screen, i, j, k, width, height)
        if x1 < x0 or y1 < y0:
            continue
        first, last = x0, x1
        for py in range(y0, y1 + 1):
            ur, vr = u0 + uy * (py + 0.5), v0 + vy * (py + 0.5)
            if x1 - x0 > NARROW:
                first, last = narrowed(ur, ux, vr, vx, x0, x1)
            for px in range(first, last + 1):
                u, v = ur + ux * (px + 0.5), vr + vx * (px + 0.5)
                z = base + u * rise + v * lean
                if not (u >= 0.0 and v >= 0.0 and u + v <= 1.0 and z > near[py, px]):
                    continue
                m = count[py, px]
                if m == LAYERS:
                    if z <= layer_near[py, px, LAYERS - 1]:
                        continue
                    m -= 1
                else:
                    count[py, px] = m + 1
                while m > 0 and layer_near[py, px, m - 1] < z:
                    layer_near[py, px, m] = layer_near[py, px, m - 1]
                    layer_face[py, px, m] = layer_face[py, px, m - 1]
                    m -= 1
                layer_near[py, px, m], layer_face[py, px, m] = z, f


@njit(error_model="numpy", inline="always")
def lit_at(x, y, z, depth, bias, radius):
    """Fraction of the depth map's taps around a point that do not hide it; where there is no map, nothing does."""
    height, width = depth.shape
    if not (x > -radius - 1 and y > -radius - 1 and x < width + radius and y < height + radius):
        return 1.0
    column, row, limit, hidden = int(x), int(y), z - bias, 0
    if column >= radius and row >= radius and column + radius < width and row + radius < height:
        for dy in range(-radius, radius + 1):
            for dx in range(-radius, radius + 1):
                hidden += depth[row + dy, column + dx] < limit
    else:
        for py in range(max(row - radius, 0), min(row + radius, height - 1) + 1):
            for px in range(max(column - radius, 0), min(column + radius, width - 1) + 1):
                hidden += depth[py, px] < limit
    return 1.0 - hidden / ((2 * radius + 1) * (2 * radius + 1))


@njit(cache=True, error_model="numpy")
def placed(points, matrix, out):
    """points (N, 3) under an affine map (3, 4), into out."""
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        for c in range(3):
            out[i, c] = matrix[c, 0] * x + matrix[c, 1] * y + matrix[c, 2] * z + matrix[c, 3]


@njit(cache=True, error_model="numpy")
def fitted(points, axes, pixels, out):
    """Affine map (3, 4) that projects points (N, 3) [m] along the last row of axes (3, 3) onto a square of so many
    pixels, which they fill; z grows along it [m]. Into out.
    """
    lx = ly = np.inf
    hx = hy = -np.inf
    for i in range(len(points)):
        px, py, pz = points[i, 0], points[i, 1], points[i, 2]
        x = px * axes[0, 0] + py * axes[0, 1] + pz * axes[0, 2]
        y = px * axes[1, 0] + py * axes[1, 1] + pz * axes[1, 2]
        lx, hx, ly, hy = min(lx, x), max(hx, x), min(ly, y), max(hy, y)
    scale = (pixels - 4) / max(hx - lx, hy - ly, 1e-6)
    for c in range(3):
        out[0, c], out[1, c], out[2, c] = scale * axes[0, c], scale * axes[1, c], axes[2, c]
    out[0, 3], out[1, 3], out[2, 3] = 2.0 - scale * lx, 2.0 - scale * ly, 0.0


@njit(cache=True, error_model="numpy")
def _look_along(points, casters, faces, way, matrix, at, depth):
    """Points (N, 3) in the map along `way`, which their first `casters` fill, into at; and how near faces are there."""
    fitted(points[:casters], way, len(depth), matrix)
    placed(points, matrix, at)
    depth[:] = np.inf
    depth_map(at, faces, depth)


@njit(cache=True, error_model="numpy")
def open_shares(points, casters, faces, ways, pixels, bias):
    """Share (N,) of `ways` (K, 3, 3), along whose last rows light comes, from which nothing hides points (N, 3) [m].

    The first `casters` of the points bear the faces (F, 3) that cast shadows, seen in maps of so many pixels.
    """
    out, at, matrix = np.zeros(len(points)), np.zeros((len(points), 3)), np.zeros((3, 4))
    depth = np.zeros((pixels, pixels), np.float32)
    for way in range(len(ways)):
        _look_along(points, casters, faces, ways[way], matrix, at, depth)
        for i in range(len(points)):
            out[i] += lit_at(at[i, 0], at[i, 1], at[i, 2], depth, bias, 1)
    for i in range(len(points)):
        out[i] /= len(ways)
    return out


@njit(cache=True, error_model="numpy")
def seen_from(points, own, faces, ways, pixels, bias):
    """Which (own,) of the first points (N, 3) [m] can be seen along any of `ways` (K, 3, 3) past the faces (F, 3)."""
    found, at, matrix = np.zeros(own, np.bool_), np.zeros((len(points), 3)), np.zeros((3, 4))
    depth = np.zeros((pixels, pixels), np.float32)
    for way in range(len(ways)):
        _look_along(points, len(points), faces, ways[way], matrix, at, depth)
        for i in range(own):
            found[i] = found[i] or lit_at(at[i, 0], at[i, 1], at[i, 2], depth, bias, 0) > 0.5
    return found
