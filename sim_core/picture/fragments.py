"""The colour of what is seen: fragments of opaque and sheer cloth under a key light, sky and ground."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.picture.raster import lit_at

GLOSS, SHEEN, THROUGH, ALPHA, FLOOR = 3, 4, 5, 6, 7  # columns of Scene.looks behind the colour
TONES = 1 << 14  # of the table of tones


class Scene(NamedTuple):
    """S surfaces before a camera, one behind the other: V vertices, F faces."""

    screen: np.ndarray  # (V, 3) x, y [pixel] and 1 / distance
    world: np.ndarray  # (V, 3) [m]
    normals: np.ndarray  # (V, 3)
    sky: np.ndarray  # (V,) the share of it that each vertex sees
    faces: np.ndarray  # (F, 3) int32
    of: np.ndarray  # (F,) int32 the surface of each face
    looks: (
        np.ndarray
    )  # (S, 8) linear colour, gloss, sheen, through, alpha, 1 for a floor that only shows shadows
    lights: np.ndarray  # (5, 3) eye, key, key colour, sky, ground
    texels: np.ndarray  # (T, 3) linear colours of all fabrics, row by row, one behind the other
    tiles: (
        np.ndarray
    )  # (S, 5) of each surface's: first texel, rows, columns (0: none), texels a metre along x and y
    corners: np.ndarray  # (F, 3, 2) [m] where the faces lie in their fabric


class Shadow(NamedTuple):
    """The key light's shadow: matrix (3, 4) from world to its maps, depths (h, w) of the opaque and of the sheer, the
    share that the sheer hold back, bias [m] by which a surface lies before its own shadow."""

    matrix: np.ndarray
    opaque: np.ndarray
    sheer: np.ndarray
    veil: float
    bias: float


class Seen(NamedTuple):
    """What is in each pixel: the opaque face or -1, and of the sheer ones before it how many, and which, near first."""

    owner: np.ndarray  # (h, w) int32
    count: np.ndarray  # (h, w) uint8, or (0, 0) where nothing is sheer
    layers: np.ndarray  # (h, w, LAYERS) int32


@njit(error_model="numpy", inline="always")
def _channel(colour, lamp, gloss, sheen, up, opened, key, sky, ground):
    """One colour channel of a shaded fragment."""
    ambient = opened * (up * sky + (1.0 - up) * ground)
    light = lamp * key + ambient
    return colour * light + gloss * key + sheen * (0.35 + 0.65 * colour) * (0.5 * ambient + 0.4 * light)


@njit(error_model="numpy", inline="always")
def _along(a, i, j, k, u, v, w, c):
    return u * a[i, c] + v * a[j, c] + w * a[k, c]


@njit(error_model="numpy", inline="always")
def _shaded(
    screen, world, normals, sky, faces, of, looks, lights, texels, tiles, corners,
    matrix, opaque, sheer, veil, bias, f, x, y,
):  # fmt: skip
    """Linear colour of a face where it is seen at (x, y) [pixel], and how squarely it is seen, 0.05 to 1."""
    i, j, k, s = faces[f, 0], faces[f, 1], faces[f, 2], of[f]
    cx, cy = screen[k, 0], screen[k, 1]
    ax, ay, bx, by = screen[i, 0] - cx, screen[i, 1] - cy, screen[j, 0] - cx, screen[j, 1] - cy
    over = 1.0 / (ax * by - bx * ay)
    u, v = ((x - cx) * by - (y - cy) * bx) * over, ((y - cy) * ax - (x - cx) * ay) * over
    u, v, w = u * screen[i, 2], v * screen[j, 2], (1.0 - u - v) * screen[k, 2]
    over = 1.0 / (u + v + w)
    u, v, w = u * over, v * over, w * over
    px, py, pz = (
        _along(world, i, j, k, u, v, w, 0),
        _along(world, i, j, k, u, v, w, 1),
        _along(world, i, j, k, u, v, w, 2),
    )
    mx = matrix[0, 0] * px + matrix[0, 1] * py + matrix[0, 2] * pz + matrix[0, 3]
    my = matrix[1, 0] * px + matrix[1, 1] * py + matrix[1, 2] * pz + matrix[1, 3]
    mz = matrix[2, 0] * px + matrix[2, 1] * py + matrix[2, 2] * pz + matrix[2, 3]
    seen, opened = lit_at(mx, my, mz, opaque, bias, 2), u * sky[i] + v * sky[j] + w * sky[k]
    if veil > 0.0:
        seen *= 1.0 - veil * (1.0 - lit_at(mx, my, mz, sheer, bias, 3))
    r, g, b = looks[s, 0], looks[s, 1], looks[s, 2]
    if tiles[s, 2] > 0.0:
        across = u * corners[f, 0, 0] + v * corners[f, 1, 0] + w * corners[f, 2, 0]
        down = u * corners[f, 0, 1] + v * corners[f, 1, 1] + w * corners[f, 2, 1]
        rows, columns = int(tiles[s, 1]), int(tiles[s, 2])
        t = int(tiles[s, 0]) + int(math.floor(down * tiles[s, 4])) % rows * columns
        t += int(math.floor(across * tiles[s, 3])) % columns
        r, g, b = r * texels[t, 0], g * texels[t, 1], b * texels[t, 2]
    if looks[s, FLOOR] > 0.0:  # what its shadows leave of the backdrop
        shade = (0.55 + 0.45 * opened) * (0.72 + 0.28 * seen)
        return shade, shade, shade, 1.0
    ex, ey, ez = lights[0, 0] - px, lights[0, 1] - py, lights[0, 2] - pz
    size = 1.0 / math.sqrt(ex * ex + ey * ey + ez * ez)
    ex, ey, ez = ex * size, ey * size, ez * size
    nx, ny, nz = (
        _along(normals, i, j, k, u, v, w, 0),
        _along(normals, i, j, k, u, v, w, 1),
        _along(normals, i, j, k, u, v, w, 2),
    )
    size = 1.0 / (math.sqrt(nx * nx + ny * ny + nz * nz) + 1e-12)
    facing = (nx * ex + ny * ey + nz * ez) * size
    if facing < 0.0:  # both sides of cloth are alike: the normal is turned to the eye
        size, facing = -size, -facing
    nx, ny, nz = nx * size, ny * size, nz * size
    kx, ky, kz = lights[1, 0], lights[1, 1], lights[1, 2]
    key = nx * kx + ny * ky + nz * kz
    # Part of the light comes through from behind: thin cloth glows.
    diffuse, gloss = max(key, 0.0) + looks[s, THROUGH] * max(-key, 0.0), 0.0
    if looks[s, GLOSS] > 0.0:
        hx, hy, hz = ex + kx, ey + ky, ez + kz
        size = 1.0 / math.sqrt(hx * hx + hy * hy + hz * hz)
        gloss = looks[s, GLOSS] * max(0.0, (nx * hx + ny * hy + nz * hz) * size) ** 24
        gloss *= math.sqrt(max(key, 0.0)) * seen
    edge = 1.0 - min(1.0, facing)
    sheen, up, lamp = looks[s, SHEEN] * edge * edge * edge, 0.5 + 0.5 * ny, seen * diffuse
    r = _channel(r, lamp, gloss, sheen, up, opened, lights[2, 0], lights[3, 0], lights[4, 0])
    g = _channel(g, lamp, gloss, sheen, up, opened, lights[2, 1], lights[3, 1], lights[4, 1])
    b = _channel(b, lamp, gloss, sheen, up, opened, lights[2, 2], lights[3, 2], lights[4, 2])
    return r, g, b, max(facing, 0.05)


@njit(cache=True, error_model="numpy")
def developed(scene, shadow, seen, backdrop, tones, fine):
    """The picture (h / fine, w / fine, 3) uint8 of what is seen in (h, w).

    backdrop (h, 3): linear colour behind everything, row by row; tones (TONES + 1,) uint8 of linear light 0 to 1. A
    pixel that one opaque face fills is shaded once.
    """
    screen, world, normals, sky, faces = scene.screen, scene.world, scene.normals, scene.sky, scene.faces
    of, looks, lights = scene.of, scene.looks, scene.lights
    texels, tiles, corners = scene.texels, scene.tiles, scene.corners
    owner, count, layers = seen.owner, seen.count, seen.layers
    matrix, opaque, sheer, veil, bias = shadow.matrix, shadow.opaque, shadow.sheer, shadow.veil, shadow.bias
    height, width = owner.shape[0] // fine, owner.shape[1] // fine
    out, sheers = np.zeros((height, width, 3), np.uint8), len(count) > 0
    for row in range(height):
        for column in range(width):
            y, x = row * fine, column * fine
            first, alike = owner[y, x], True
            for n in range(fine * fine):
                sy, sx = y + n // fine, x + n % fine
                alike = alike and owner[sy, sx] == first and not (sheers and count[sy, sx] > 0)
            samples, wide = (1, fine) if alike else (fine * fine, 1)
            red = green = blue = 0.0
            for n in range(samples):
                sy, sx = y + n // fine, x + n % fine
                r, g, b = backdrop[sy, 0], backdrop[sy, 1], backdrop[sy, 2]
                depth = int(count[sy, sx]) if sheers else 0
                for m in range(depth, -1, -1):  # from far to near
                    f = owner[sy, sx] if m == depth else layers[sy, sx, m]
                    if f < 0:
                        continue
                    r1, g1, b1, facing = _shaded(
                        screen, world, normals, sky, faces, of, looks, lights, texels, tiles, corners,
                        matrix, opaque, sheer, veil, bias, f, sx + 0.5 * wide, sy + 0.5 * wide,
                    )  # fmt: skip
                    if looks[of[f], FLOOR] > 0.0:
                        r, g, b = r * r1, g * g1, b * b1
                        continue
                    a = 1.0
                    if m < depth:  # more threads lie in a slanting line of sight
                        a = 1.0 - (1.0 - looks[of[f], ALPHA]) ** (1.0 / facing)
                    r, g, b = r + a * (r1 - r), g + a * (g1 - g), b + a * (b1 - b)
                red, green, blue = red + r / samples, green + g / samples, blue + b / samples
            out[row, column, 0] = tones[int(TONES * min(max(red, 0.0), 1.0) + 0.5)]
            out[row, column, 1] = tones[int(TONES * min(max(green, 0.0), 1.0) + 0.5)]
            out[row, column, 2] = tones[int(TONES * min(max(blue, 0.0), 1.0) + 0.5)]
    return out
