"""Compiled triangle rasteriser behind `picture`: depth maps, and shaded fragments of opaque and sheer cloth."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

LAYERS = 8  # sheer layers kept per pixel, the nearest ones


class Projected(NamedTuple):
    """A surface before the camera: screen (V, 3) x, y [pixel] and 1 / distance, faces (F, 3) int32, world (V, 3) [m],
    normals (V, 3), sky (V,): the share of it that each vertex sees."""

    screen: np.ndarray
    faces: np.ndarray
    world: np.ndarray
    normals: np.ndarray
    sky: np.ndarray


class Shadow(NamedTuple):
    """The key light's shadow: matrix (3, 4) from world to its maps, depths (h, w) of the opaque and of the sheer, the
    share that the sheer hold back, bias [m] by which a surface lies before its own shadow."""

    matrix: np.ndarray
    opaque: np.ndarray
    sheer: np.ndarray
    veil: float
    bias: float


@njit(cache=True, error_model="numpy")
def _rows(a, b, c, height):
    """Pixel rows of a screen triangle, clipped, and one over twice its signed area (0: degenerate)."""
    y0 = max(int(math.floor(min(a[1], b[1], c[1]))), 0)
    y1 = min(int(math.ceil(max(a[1], b[1], c[1]))), height - 1)
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return y0, y1, 1.0 / area if area != 0.0 else 0.0


@njit(cache=True, error_model="numpy")
def _weights(a, b, c, over, y):
    """Barycentric weights of a and b along the row y: each (value at x = 0, growth per pixel)."""
    u1, v1 = (b[1] - c[1]) * over, (c[1] - a[1]) * over
    u0 = (b[0] * (c[1] - y) - (b[1] - y) * c[0]) * over
    v0 = (c[0] * (a[1] - y) - (c[1] - y) * a[0]) * over
    return u0, u1, v0, v1


@njit(cache=True, error_model="numpy")
def _columns(u0, u1, v0, v1, width):
    """First and last pixel of a row whose middle may lie in the triangle; one too many at either end."""
    low, high = -1.0, width + 1.0
    for value, growth in ((u0, u1), (v0, v1), (1.0 - u0 - v0, -u1 - v1)):
        if growth > 0.0:
            low = max(low, -value / growth)
        elif growth < 0.0:
            high = min(high, -value / growth)
        elif value < 0.0:
            return 1, 0
    return max(int(low - 0.5), 0), min(int(high + 0.5), width - 1)


@njit(cache=True, error_model="numpy")
def depth_map(screen, faces, depth):
    """Smallest screen z per pixel into depth (h, w); screen (V, 3): x, y [pixel], z."""
    height, width = depth.shape
    for f in range(len(faces)):
        a, b, c = screen[faces[f, 0]], screen[faces[f, 1]], screen[faces[f, 2]]
        y0, y1, over = _rows(a, b, c, height)
        if over == 0.0:
            continue
        for py in range(y0, y1 + 1):
            u0, u1, v0, v1 = _weights(a, b, c, over, py + 0.5)
            x0, x1 = _columns(u0, u1, v0, v1, width)
            for px in range(x0, x1 + 1):
                u, v = u0 + u1 * (px + 0.5), v0 + v1 * (px + 0.5)
                w = 1.0 - u - v
                if u >= 0.0 and v >= 0.0 and w >= 0.0:
                    z = u * a[2] + v * b[2] + w * c[2]
                    if z < depth[py, px]:
                        depth[py, px] = z


@njit(cache=True, error_model="numpy")
def lit(screen, depth, bias, radius):
    """Fraction of the depth map's taps around each point (N, 3) that do not hide it, (N,)."""
    out = np.zeros(len(screen))
    for i in range(len(screen)):
        out[i] = _lit_at(screen[i, 0], screen[i, 1], screen[i, 2], depth, bias, radius)
    return out


@njit(cache=True, error_model="numpy")
def _lit_at(x, y, z, depth, bias, radius):
    height, width = depth.shape
    seen, taps = 0.0, 0
    for dy in range(-radius, radius + 1):
        for dx in range(-radius, radius + 1):
            px, py = int(x) + dx, int(y) + dy
            taps += 1
            if px < 0 or py < 0 or px >= width or py >= height or z <= depth[py, px] + bias:
                seen += 1.0
    return seen / taps


@njit(cache=True, error_model="numpy")
def _place(m, p):
    """An affine map (3, 4) of a point; triples instead of arrays, since a fragment must not allocate."""
    x, y, z = p
    return (
        m[0, 0] * x + m[0, 1] * y + m[0, 2] * z + m[0, 3],
        m[1, 0] * x + m[1, 1] * y + m[1, 2] * z + m[1, 3],
        m[2, 0] * x + m[2, 1] * y + m[2, 2] * z + m[2, 3],
    )


@njit(cache=True, error_model="numpy")
def _shade(n, p, open_sky, colour, look, scene):
    """Linear colour of a fragment with normal n turned to the eye; scene rows: eye, key, key colour, sky, ground."""
    ex, ey, ez = scene[0, 0] - p[0], scene[0, 1] - p[1], scene[0, 2] - p[2]
    far = math.sqrt(ex * ex + ey * ey + ez * ez)
    ex, ey, ez = ex / far, ey / far, ez / far
    facing = n[0] * ex + n[1] * ey + n[2] * ez
    if look[4] > 0.0:  # a floor that only shows shadows, else the backdrop's own colour
        shade = (0.55 + 0.45 * open_sky[1]) * (0.72 + 0.28 * open_sky[0])
        return (colour[0] * shade, colour[1] * shade, colour[2] * shade), 1.0
    key = n[0] * scene[1, 0] + n[1] * scene[1, 1] + n[2] * scene[1, 2]
    through = look[2]  # part of the light that comes through from behind: thin cloth glows
    diffuse = max(key, 0.0) + through * max(-key, 0.0)
    hx, hy, hz = ex + scene[1, 0], ey + scene[1, 1], ez + scene[1, 2]
    size = math.sqrt(hx * hx + hy * hy + hz * hz)
    gloss = 0.0
    if look[0] > 0.0:
        gloss = look[0] * max(0.0, (n[0] * hx + n[1] * hy + n[2] * hz) / size) ** 24
        gloss *= math.sqrt(max(key, 0.0)) * open_sky[0]
    sheen = look[1] * (1.0 - min(1.0, max(facing, 0.0))) ** 3
    up, lamp = 0.5 + 0.5 * n[1], open_sky[0] * diffuse
    r0 = _channel(colour[0], lamp, gloss, sheen, up, open_sky[1], scene[2, 0], scene[3, 0], scene[4, 0])
    r1 = _channel(colour[1], lamp, gloss, sheen, up, open_sky[1], scene[2, 1], scene[3, 1], scene[4, 1])
    r2 = _channel(colour[2], lamp, gloss, sheen, up, open_sky[1], scene[2, 2], scene[3, 2], scene[4, 2])
    return (r0, r1, r2), max(facing, 0.05)


@njit(cache=True, error_model="numpy")
def _channel(colour, lamp, gloss, sheen, up, opened, key, sky, ground):
    """One colour channel of a shaded fragment."""
    ambient = opened * (up * sky + (1.0 - up) * ground)
    light = lamp * key + ambient
    return colour * light + gloss * key + sheen * (0.35 + 0.65 * colour) * (0.5 * ambient + 0.4 * light)


@njit(cache=True, error_model="numpy")
def _insert(layer_depth, layer_colour, z, r, alpha):
    """Keeps the nearest layers of a pixel, sorted from near to far."""
    k = LAYERS - 1
    if z >= layer_depth[k]:
        return
    while k > 0 and layer_depth[k - 1] > z:
        layer_depth[k] = layer_depth[k - 1]
        layer_colour[k] = layer_colour[k - 1]
        k -= 1
    layer_depth[k] = z
    layer_colour[k, 0], layer_colour[k, 1], layer_colour[k, 2], layer_colour[k, 3] = r[0], r[1], r[2], alpha


@njit(cache=True, error_model="numpy")
def _mixed(rows, i, j, k, u, v, w):
    """Weighted sum of three rows of (V, 3)."""
    return (
        u * rows[i, 0] + v * rows[j, 0] + w * rows[k, 0],
        u * rows[i, 1] + v * rows[j, 1] + w * rows[k, 1],
        u * rows[i, 2] + v * rows[j, 2] + w * rows[k, 2],
    )


@njit(cache=True, error_model="numpy")
def _fragment(p, n, sky, colour, look, scene, shadow):
    """Colour and slant of a fragment at p whose normal n is turned to the eye first."""
    size = math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) + 1e-12
    if n[0] * (scene[0, 0] - p[0]) + n[1] * (scene[0, 1] - p[1]) + n[2] * (scene[0, 2] - p[2]) < 0.0:
        size = -size
    at = _place(shadow.matrix, p)
    seen = _lit_at(at[0], at[1], at[2], shadow.opaque, shadow.bias, 2)
    seen *= 1.0 - shadow.veil * (1.0 - _lit_at(at[0], at[1], at[2], shadow.sheer, shadow.bias, 3))
    return _shade((n[0] / size, n[1] / size, n[2] / size), p, (seen, sky), colour, look, scene)


@njit(cache=True, error_model="numpy")
def fragments(mesh, colour, look, scene, shadow, depth, image, layer_depth, layer_colour):
    """Draws one surface, mesh: `Projected`, shadow: `Shadow`.

    look: gloss, sheen, through, alpha, 1 for a floor that only shows shadows. depth holds -1/distance of the opaque;
    sheer surfaces (alpha < 1) go to the layers.
    """
    screen, faces, sky = mesh.screen, mesh.faces, mesh.sky
    height, width = depth.shape
    for f in range(len(faces)):
        i, j, k = faces[f]
        a, b, c = screen[i], screen[j], screen[k]
        if a[2] <= 0.0 or b[2] <= 0.0 or c[2] <= 0.0:
            continue
        y0, y1, over = _rows(a, b, c, height)
        if over == 0.0:
            continue
        for py in range(y0, y1 + 1):
            u0, u1, v0, v1 = _weights(a, b, c, over, py + 0.5)
            x0, x1 = _columns(u0, u1, v0, v1, width)
            for px in range(x0, x1 + 1):
                u, v = u0 + u1 * (px + 0.5), v0 + v1 * (px + 0.5)
                w = 1.0 - u - v
                if u < 0.0 or v < 0.0 or w < 0.0:
                    continue
                near = u * a[2] + v * b[2] + w * c[2]
                if -near >= depth[py, px]:
                    continue
                u, v, w = u * a[2] / near, v * b[2] / near, w * c[2] / near
                p = _mixed(mesh.world, i, j, k, u, v, w)
                n = _mixed(mesh.normals, i, j, k, u, v, w)
                r, facing = _fragment(p, n, u * sky[i] + v * sky[j] + w * sky[k], colour, look, scene, shadow)
                if look[3] >= 1.0:
                    depth[py, px] = -near
                    image[py, px, 0], image[py, px, 1], image[py, px, 2] = r
                else:
                    # More threads lie in a slanting line of sight.
                    alpha = 1.0 - (1.0 - look[3]) ** (1.0 / facing)
                    _insert(layer_depth[py, px], layer_colour[py, px], -near, r, alpha)


@njit(cache=True, error_model="numpy")
def compose(image, depth, layer_depth, layer_colour):
    """Lays the sheer layers over the opaque image, far to near, in place."""
    height, width = depth.shape
    for y in range(height):
        for x in range(width):
            for k in range(LAYERS - 1, -1, -1):
                if layer_depth[y, x, k] < depth[y, x]:
                    a = layer_colour[y, x, k, 3]
                    for c in range(3):
                        image[y, x, c] = a * layer_colour[y, x, k, c] + (1.0 - a) * image[y, x, c]
