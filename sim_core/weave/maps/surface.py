"""The full map set of a cloth from samples of its surface: from albedo to yarn number."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from sim_core.errors import WeaveError
from sim_core.weave.maps.samples import Samples, sample_surface, tile_of
from sim_core.weave.model import Weave
from sim_core.weave.yarns.geometry import YarnGeometry
from sim_core.weave.yarns.particles.cell import ParticleCell
from sim_core.weave.yarns.paths import strands

__all__ = ["SurfaceMaps", "lit_cloth", "resolve", "surface_maps"]

SAMPLES = 2  # per pixel and direction
YARNS_WANTED = 28
ROUGH_ALONG, ROUGH_BONUS = 0.34, 0.5  # a yarn seen on the flat; turned away


@dataclass(frozen=True, eq=False)
class SurfaceMaps:
    """Tileable maps of the face; row 0 at the top, pick 0 at the bottom, so that a Z twill rises to the right.

    albedo, normal: (n, n, 3) uint8; normal as glTF has it (x right, y up).  height, opacity: (n, n) uint8.
    roughness: (n, n) uint8, of the highlight across the yarn.  direction: (n, n, 3) uint8, red and green the direction
    of the yarn (glTF's anisotropy texture: cos, sin to 0..255, y up), blue its strength; angles from -45 to 135
    degrees, so that neither warp nor weft turns round between neighbouring pixels, which filters would blend to naught.
    yarn: (n, n) uint16, number of the yarn on top plus 1, 0 in gaps.
    size: (x, y) [m] of the tile.  relief: [m] between height 0 and 255.  repeats: (across, up).
    """

    albedo: np.ndarray
    normal: np.ndarray
    height: np.ndarray
    roughness: np.ndarray
    direction: np.ndarray
    opacity: np.ndarray
    yarn: np.ndarray
    size: tuple[float, float]
    relief: float
    repeats: tuple[int, int]

    def pictures(self) -> dict[str, np.ndarray]:
        """The maps by name."""
        names = ("albedo", "normal", "height", "roughness", "direction", "opacity", "yarn")
        return {name: getattr(self, name) for name in names}


def surface_maps(
    weave: Weave,
    geometry: YarnGeometry | ParticleCell,
    *,
    pixels: int = 1024,
    seed: int = 0,
    repeats: tuple[int, int] | None = None,
    sampler=sample_surface,
    origin: tuple[float, float] = (0.0, 0.0),
) -> SurfaceMaps:
    """Draw a relaxed cloth as tileable maps.

    pixels: 32 to 4096.  seed: of the yarns' unevenness.  repeats: (across, up), chosen if absent.  sampler: draws the
    samples; `gl_samples.sample_surface` does it by OpenGL.  origin: (x, y) [m] of the lower left corner.
    Raises WeaveError for a map size out of range.
    """
    if not 32 <= pixels <= 4096:
        raise WeaveError(f"weave {weave.name}: {pixels} pixels – give 32 to 4096")
    repeats = repeats or _repeats(weave, pixels)
    shape = (pixels * SAMPLES, pixels * SAMPLES)
    systems = strands(weave, geometry)
    tiles, colours, size = tile_of(systems, repeats, shape, seed, origin)
    low = min(float((t.height - t.tall).min()) for t in tiles)
    high = max(float((t.height + t.tall).max()) for t in tiles)
    return resolve(sampler(tiles, shape, size), colours, low, high, size, repeats)


def _repeats(weave: Weave, pixels: int) -> tuple[int, int]:
    width, height = weave.size
    across = max(1, round(YARNS_WANTED / weave.draft.ends))
    across = max(1, min(across, pixels // (6 * weave.draft.ends)))
    return across, max(1, round(across * width / height))


def resolve(samples: Samples, colours: np.ndarray, low: float, high: float, size, repeats) -> SurfaceMaps:
    """Average the samples of each pixel. colours: (n, 3) linear.  low, high: [m] of heights 0 and 255."""
    streak = 1 + 0.07 * np.random.default_rng(7).standard_normal((256, 48)).astype(np.float32)
    rows, columns = (n // SAMPLES for n in samples.height.shape)
    number = np.zeros((rows, columns), np.uint16)
    lit = np.array(
        [
            ((k / 255) / 12.92 if k / 255 <= 0.04045 else ((k / 255 + 0.055) / 1.055) ** 2.4)
            for k in range(256)
        ]
    )
    to_srgb = np.searchsorted(lit[1:] / 2 + lit[:-1] / 2, np.arange(4096) / 4095).astype(np.uint8)
    pictures = [
        np.zeros((rows, columns, c) if c > 1 else (rows, columns), np.uint8) for c in (3, 3, 1, 1, 3, 1)
    ]
    _resolve(samples.height, samples.yarn, samples.dx, samples.dy, samples.run, samples.colour, samples.across,
             colours.astype(np.float32), streak, low, high, colours.mean(axis=0) * 0.7, to_srgb, number,
             *pictures)  # fmt: skip
    albedo, normal, height, roughness, direction, opacity = pictures
    return SurfaceMaps(
        albedo, normal, height, roughness, direction, opacity, number, size, high - low, repeats
    )


@njit(cache=True, error_model="numpy")
def _resolve(height, yarn, dx, dy, run, colour, across, colours, streak, low, high, gap, to_srgb, number, albedo,
             normal, level, rough, direction, opacity):  # fmt: skip
    rows, columns = number.shape
    n = height.shape[0] // rows
    share = 1.0 / (n * n)
    for i in range(rows):
        for j in range(columns):
            r = g = b = nx = ny = nz = z = cover = c2 = s2 = tilt = 0.0
            best = -1e30
            for a in range(n):
                for e in range(n):
                    y, x = i * n + a, j * n + e
                    if yarn[y, x] < 0:
                        z += low * share
                        continue
                    h = height[y, x]
                    z += h * share
                    cover += share
                    ring = streak[yarn[y, x] % 256, int((across[y, x] + 1.0) * 0.499 * 48)]
                    depth = min(max((h - low) / (high - low), 0.0), 1.0)
                    light = ring * (0.6 + 0.4 * np.sqrt(depth)) * share
                    tint = colour[y, x]
                    r += light * colours[tint, 0]
                    g += light * colours[tint, 1]
                    b += light * colours[tint, 2]
                    sx, sy = dx[y, x], dy[y, x]
                    up = share / np.sqrt(1 + sx * sx + sy * sy)
                    nx -= sx * up
                    ny -= sy * up
                    nz += up
                    tilt += share - up
                    c2 += np.cos(2 * run[y, x]) * share  # a direction and its opposite are one
                    s2 += np.sin(2 * run[y, x]) * share
                    if h > best:
                        best = h
                        number[i, j] = yarn[y, x] % 65535 + 1
            if cover > 0:
                r, g, b = r / cover, g / cover, b / cover
            else:
                r, g, b = gap[0], gap[1], gap[2]
            for c, value in enumerate((r, g, b)):
                albedo[i, j, c] = to_srgb[int(min(max(value, 0.0), 1.0) * 4095 + 0.5)]
            nz += 1 - cover
            size = np.sqrt(nx * nx + ny * ny + nz * nz)
            normal[i, j, 0] = int((nx / size / 2 + 0.5) * 255 + 0.5)
            normal[i, j, 1] = int((ny / size / 2 + 0.5) * 255 + 0.5)
            normal[i, j, 2] = int((nz / size / 2 + 0.5) * 255 + 0.5)
            level[i, j] = int(min(max((z - low) / (high - low), 0.0), 1.0) * 255 + 0.5)
            opacity[i, j] = int(cover * 255 + 0.5)
            spread = np.sqrt(c2 * c2 + s2 * s2)
            half = 0.5 * np.arctan2(s2, c2)
            # A direction and its opposite are one: turned round where neither warp nor weft runs.
            if half < -np.pi / 4:
                half += np.pi
            mean_tilt = tilt / cover if cover > 0 else 0.0
            rough[i, j] = int(min(0.34 + 0.5 * mean_tilt + 0.25 * (1 - cover), 1.0) * 255 + 0.5)
            direction[i, j, 0] = int((np.cos(half) / 2 + 0.5) * 255 + 0.5)
            direction[i, j, 1] = int((np.sin(half) / 2 + 0.5) * 255 + 0.5)
            direction[i, j, 2] = int(min(spread, 1.0) * 255 + 0.5)


def lit_cloth(
    maps: SurfaceMaps, *, backdrop: float = 0.07, light=(-0.35, 0.5, 0.75), gloss: float = 0.3
) -> np.ndarray:
    """The maps under one lamp: Lambert, and Kajiya-Kay's highlight along the yarns. Returns (n, n, 3) uint8.

    The highlight is cos^p of the angle between the half vector and the plane across the yarn, so floats gleam along
    their length. backdrop: grey seen through the gaps.
    """
    lamp = np.array(light) / np.linalg.norm(light)
    half = lamp + [0.0, 0.0, 1.0]
    half /= np.linalg.norm(half)
    normal = maps.normal / 127.5 - 1
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    run = maps.direction[..., :2] / 127.5 - 1
    tangent = np.dstack([run, np.zeros(run.shape[:2])])
    tangent -= (tangent * normal).sum(axis=2, keepdims=True) * normal
    tangent /= np.maximum(np.linalg.norm(tangent, axis=2, keepdims=True), 1e-6)
    strength = maps.direction[..., 2] / 255
    power = 2 / np.maximum(maps.roughness / 255, 0.05) ** 4
    shine = gloss * strength * (1 - (tangent @ half) ** 2) ** (power / 2) * np.clip(normal @ lamp, 0, 1)
    diffuse = 0.28 + 0.8 * np.clip(normal @ lamp, 0, 1)
    albedo = (maps.albedo / 255.0) ** 2.2
    cover = maps.opacity[..., None] / 255.0
    tint = 0.4 + 0.6 * albedo / np.maximum(
        albedo.max(axis=2, keepdims=True), 1e-3
    )  # light that went through the fibre
    linear = cover * (albedo * diffuse[..., None] + shine[..., None] * tint) + (1 - cover) * backdrop**2.2
    return np.rint(np.clip(linear, 0, 1) ** (1 / 2.2) * 255).astype(np.uint8)
