"""The full map set of a cloth from samples of its surface: from albedo to yarn number."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.fft import irfft2, rfft2

from sim_core.errors import WeaveError
from sim_core.weave.maps.filaments import SPREAD_ACROSS, Filaments, filaments_of, with_filaments
from sim_core.weave.maps.samples import Samples, sample_surface, tile_of
from sim_core.weave.model import Weave
from sim_core.weave.yarns.geometry import YarnGeometry
from sim_core.weave.yarns.particles.cell import ParticleCell
from sim_core.weave.yarns.paths import strands

__all__ = ["SurfaceMaps", "highlight", "lit_cloth", "resolve", "surface_maps"]

SAMPLES = 2  # per pixel and direction
YARNS_WANTED = 28
ALPHA = 0.2  # of GGX on one filament, after a study of the look (its near lobe: exponent 28 along the yarn)
REACH, DEPTH = 1.0, 1.1  # shade: how far round a sample in thicknesses of the cloth, and how deep
LEAST_LIGHT, MOST_LIGHT = 0.3, 1.1
SKY, SUN, SILK_GLOSS = 0.22, 0.42, 0.2  # of `lit_cloth`


@dataclass(frozen=True, eq=False)
class SurfaceMaps:
    """Tileable maps of the face; row 0 at the top, pick 0 at the bottom, so that a Z twill rises to the right.

    albedo, normal: (n, n, 3) uint8; normal as glTF has it (x right, y up).  height, opacity: (n, n) uint8.
    roughness: (n, n) uint8, of the highlight along the yarn, where it is narrow.  direction: (n, n, 3) uint8, red and
    green the direction of the yarn (cos, sin to 0..255, y up; glTF's anisotropy texture has the direction across it),
    blue how much wider the highlight is across, as glTF's strength; angles from -45 to 135 degrees, so that neither
    warp nor weft turns round between neighbouring pixels, which filters would blend to naught.
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
    step = size[0] / shape[1], size[1] / shape[0]
    return resolve(
        sampler(tiles, shape, size),
        filaments_of(systems, repeats, step, origin),
        colours,
        low,
        high,
        size,
        repeats,
    )


def _repeats(weave: Weave, pixels: int) -> tuple[int, int]:
    width, height = weave.size
    across = max(1, round(YARNS_WANTED / weave.draft.ends))
    across = max(1, min(across, pixels // (6 * weave.draft.ends)))
    return across, max(1, round(across * width / height))


def resolve(
    samples: Samples, filaments: Filaments, colours: np.ndarray, low: float, high: float, size, repeats
) -> SurfaceMaps:
    """Average the samples of each pixel. colours: (n, 3) linear.  low, high: [m] of heights 0 and 255."""
    drawn, bright = with_filaments(samples, filaments)
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
    # What is not drawn is rough: filaments too fine for these samples.
    hidden = np.where(filaments.shown == 0, SPREAD_ACROSS, 0.0)
    reach = REACH * (high - low)
    around = _surroundings(samples.height, low, reach, size)
    _resolve(drawn.height, drawn.yarn, drawn.dx, drawn.dy, drawn.run, drawn.colour, bright, around, DEPTH / reach,
             filaments.first, hidden, colours.astype(np.float32), low, high, colours.mean(axis=0) * 0.7, to_srgb,
             number, *pictures)  # fmt: skip
    albedo, normal, height, roughness, direction, opacity = pictures
    return SurfaceMaps(
        albedo, normal, height, roughness, direction, opacity, number, size, high - low, repeats
    )


def _surroundings(height: np.ndarray, low: float, reach: float, size: tuple[float, float]) -> np.ndarray:
    """(rows, columns) [m] mean height round each pixel, weighted by a bell `reach` [m] wide, round the tile."""
    filled = np.where(np.isfinite(height), height, low).astype(np.float32)
    rows, columns = (n // SAMPLES for n in height.shape)
    mean = filled.reshape(rows, SAMPLES, columns, SAMPLES).mean(axis=(1, 3))
    v = np.fft.fftfreq(rows, size[1] / rows)[:, None]
    u = np.fft.rfftfreq(columns, size[0] / columns)[None]
    bell = np.exp(-2.0 * (np.pi * reach) ** 2 * (u * u + v * v)).astype(np.float32)
    return np.asarray(irfft2(rfft2(mean) * bell, mean.shape))


@njit(cache=True, error_model="numpy")
def _resolve(height, yarn, dx, dy, run, colour, bright, around, deep, first, hidden, colours, low, high, gap, to_srgb,
             number, albedo, normal, level, rough, direction, opacity):  # fmt: skip
    rows, columns = number.shape
    n = height.shape[0] // rows
    share = 1.0 / (n * n)
    for i in range(rows):
        for j in range(columns):
            r = g = b = nx = ny = nz = z = cover = c2 = s2 = 0.0
            along = across = along2 = across2 = 0.0  # slopes along and across the yarns, and their squares
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
                    # less of the sky reaches what lies deeper than its surroundings
                    shade = min(max(1.0 + deep * (h - around[i, j]), LEAST_LIGHT), MOST_LIGHT)
                    light = bright[y, x] * shade * share
                    tint = colour[y, x]
                    r += light * colours[tint, 0]
                    g += light * colours[tint, 1]
                    b += light * colours[tint, 2]
                    sx, sy = dx[y, x], dy[y, x]
                    up = share / np.sqrt(1 + sx * sx + sy * sy)
                    nx -= sx * up
                    ny -= sy * up
                    nz += up
                    cosine, sine = np.cos(run[y, x]), np.sin(run[y, x])
                    c2 += (cosine * cosine - sine * sine) * share  # a direction and its opposite are one
                    s2 += 2 * sine * cosine * share
                    one, other = sx * cosine + sy * sine, sx * sine - sy * cosine
                    one, other = min(max(one, -2.0), 2.0), min(max(other, -2.0), 2.0)
                    kind = first.size - 1
                    while yarn[y, x] < first[kind]:
                        kind -= 1
                    along += one * share
                    across += other * share
                    along2 += one * one * share
                    across2 += (other * other + hidden[kind]) * share
                    if h > best:
                        best = h
                        number[i, j] = yarn[y, x] % 65535 + 1
            if cover > 0:
                r, g, b = r / cover, g / cover, b / cover
                along, across, along2, across2 = (
                    along / cover,
                    across / cover,
                    along2 / cover,
                    across2 / cover,
                )
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
            half = 0.5 * np.arctan2(s2, c2)
            # A direction and its opposite are one: turned round where neither warp nor weft runs.
            if half < -np.pi / 4:
                half += np.pi
            # What a pixel holds of slopes makes its highlight wider (Olano and Baker 2010): alpha^2 grows by twice
            # their variance. glTF: alpha across = alpha along + (1 - alpha along) strength^2.
            narrow = np.sqrt(ALPHA**2 + 2 * max(along2 - along * along, 0.0))
            wide = np.sqrt(ALPHA**2 + 2 * max(across2 - across * across, 0.0))
            narrow = min(narrow, 0.98)
            strength = np.sqrt(min(max((wide - narrow) / (1 - narrow), 0.0), 1.0)) * np.sqrt(
                c2 * c2 + s2 * s2
            )
            rough[i, j] = int(np.sqrt(narrow) * 255 + 0.5)
            direction[i, j, 0] = int((np.cos(half) / 2 + 0.5) * 255 + 0.5)
            direction[i, j, 1] = int((np.sin(half) / 2 + 0.5) * 255 + 0.5)
            direction[i, j, 2] = int(min(strength, 1.0) * 255 + 0.5)


def lit_cloth(
    maps: SurfaceMaps, *, backdrop: float = 0.07, light=(-0.35, 0.5, 0.75), gloss: float = 1.0
) -> np.ndarray:
    """The maps under one lamp and a sky, the eye above: Lambert, and the highlight of `highlight`.

    backdrop: grey seen through the gaps.  Returns (n, n, 3) uint8.
    """
    lamp = np.array(light) / np.linalg.norm(light)
    normal = maps.normal / 127.5 - 1
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    facing = np.clip(normal @ lamp, 0, 1)
    diffuse = SKY + SUN * facing
    shine = gloss * SILK_GLOSS * highlight(maps, lamp) * facing
    albedo = (maps.albedo / 255.0) ** 2.2
    cover = maps.opacity[..., None] / 255.0
    tint = 0.35 + 0.65 * albedo / np.maximum(
        albedo.max(axis=2, keepdims=True), 1e-3
    )  # light that went through the fibre
    linear = cover * (albedo * diffuse[..., None] + shine[..., None] * tint) + (1 - cover) * backdrop**2.2
    return np.rint(np.clip(linear, 0, 1) ** (1 / 2.2) * 255).astype(np.uint8)


def highlight(maps: SurfaceMaps, lamp: np.ndarray) -> np.ndarray:
    """(n, n) GGX of half vectors between a lamp, a direction (3,), and the eye above: how many facets mirror it.

    Narrow along the yarns, wide across them, as `roughness` and `direction` say; 1 / pi at a mirror of alpha 1.
    """
    normal = maps.normal / 127.5 - 1
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    half = lamp / np.linalg.norm(lamp) + [0.0, 0.0, 1.0]
    half /= np.linalg.norm(half)
    run = maps.direction[..., :2] / 127.5 - 1
    tangent = np.dstack([run, np.zeros(run.shape[:2])])
    tangent -= (tangent * normal).sum(axis=2, keepdims=True) * normal
    tangent /= np.maximum(np.linalg.norm(tangent, axis=2, keepdims=True), 1e-6)
    narrow = (maps.roughness / 255) ** 2
    wide = narrow + (1 - narrow) * (maps.direction[..., 2] / 255) ** 2
    along, across, up = tangent @ half, np.cross(normal, tangent) @ half, normal @ half
    spread = (along / narrow) ** 2 + (across / wide) ** 2 + up**2
    return np.where(up > 0, 1 / (np.pi * narrow * wide * spread**2), 0.0)
