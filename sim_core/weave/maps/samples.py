"""Samples of the cloth's surface by numba: which yarn is on top, how high, which way it faces and runs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from sim_core.weave.yarns.geometry import Strands

__all__ = ["Samples", "Tile", "sample_surface", "tile_of"]

PROFILE = 256
FLANK = 0.1  # the section is vertical at its edge; its slope is cut off here
TABLE = 256  # samples of irregularity along a yarn, once round the tile


@dataclass(frozen=True, eq=False)
class Tile:
    """Yarn paths over whole repeats, sampled for a picture of rows x columns samples; see Strands for the meaning.

    along 0: yarns run up the cloth (warp), 1: to the right.  centre, height, slope, lean: (yarns, places) place across
    [m], axis height [m], dz/d along, d across/d along.  half: (yarns, places) half width [m], tall: half height [m],
    taper: d half/d along, by which what lies beside the axis leans more than it.
    colour: (yarns, places) int16 into colours, -1 absent.  first: number of the first yarn (for the yarn id).
    """

    along: int
    centre: np.ndarray
    height: np.ndarray
    slope: np.ndarray
    lean: np.ndarray
    half: np.ndarray
    tall: np.ndarray
    taper: np.ndarray
    colour: np.ndarray
    first: int
    power: float


@dataclass(frozen=True, eq=False)
class Samples:
    """(rows, columns) of each, row 0 at the top of the cloth: height [m] (float32, -inf where there is no yarn),
    yarn (int32 id, -1 none), dx, dy (surface slopes to the right and up), run (angle of the yarn from the weft
    direction, radians), colour (int16, index), across (-1 to 1, place on the section)."""

    height: np.ndarray
    yarn: np.ndarray
    dx: np.ndarray
    dy: np.ndarray
    run: np.ndarray
    colour: np.ndarray
    across: np.ndarray


def tile_of(
    systems: tuple[Strands, ...],
    repeats: tuple[int, int],
    shape: tuple[int, int],
    seed: int,
    origin=(0.0, 0.0),
) -> tuple[list[Tile], np.ndarray, tuple[float, float]]:
    """Tiles of repeats (across, up) at rows x columns samples, the colours (n, 3) linear, and the size [m] (x, y).

    seed: of the yarns' unevenness, periodic over the tile.  origin: (x, y) [m] of the lower left corner.
    """
    rng = np.random.default_rng(seed)
    tiles, colours, first = [], [], 0
    warp = systems[0]
    size = repeats[0] * warp.across, repeats[1] * warp.length
    for system in systems:
        along = 0 if system.along == "warp" else 1
        lengthwise, crosswise = (repeats[1], repeats[0]) if along == 0 else repeats
        samples = shape[0] if along == 0 else shape[1]
        place = (np.arange(samples) + 0.5) / samples * lengthwise * system.length + origin[1 - along]
        n = system.side.shape[1]
        at = place / system.length * n
        k = np.floor(at).astype(int)
        t = at - k
        side, lean = _cubic(system.side, k % n, t, system.length / n)
        height, _ = _cubic(system.height, k % n, t, system.length / n)
        crest, slope = _cubic(system.height + system.half_height, k % n, t, system.length / n)
        half, taper = _cubic(system.half_width, k % n, t, system.length / n)
        near = (
            np.floor(at + 0.5 + 1e-6).astype(int) % n
        )  # halfway always the same way, wherever the tile begins
        yarns = len(system.place)
        count = yarns * crosswise
        of = np.arange(count) % yarns
        waves = lengthwise * system.length / (6 * system.yarn.width)
        swell = 1 + system.yarn.unevenness * _noise(rng, count, waves, at / (n * lengthwise))
        swell = np.clip(swell, 0.6, 1.5)
        centre = (
            (system.place[of] + (np.arange(count) // yarns) * system.across)[:, None]
            + side[of]
            - origin[along]
        )
        room = max(system.across / yarns - system.yarn.width, 0.1 * system.across / yarns)
        centre = centre + 0.3 * system.yarn.unevenness * room * _noise(
            rng, count, waves, at / (n * lengthwise)
        )
        palette = np.where(
            system.palette <= 0.04045, system.palette / 12.92, ((system.palette + 0.055) / 1.055) ** 2.4
        )
        colour = system.colour[of][:, near]
        colour = np.where(colour < 0, -1, colour + sum(len(c) for c in colours))
        colours.append(palette)
        steep = np.sqrt(1 + slope[of] ** 2)  # the envelope of a sloping tube is taller
        tiles.append(
            Tile(
                along, centre, height[of], slope[of], lean[of], half[of] * swell,
                (crest - height)[of] * swell * steep, taper[of] * swell, colour.astype(np.int16), first,
                1 + min(system.yarn.width / system.yarn.height, 3.0),
            )
        )  # fmt: skip
        first += count
    return tiles, np.concatenate(colours), size


def _noise(rng: np.random.Generator, count: int, waves: float, lap: np.ndarray) -> np.ndarray:
    """(count, places) periodic noise of unit variance with about `waves` swings once round the tile, at laps `lap`."""
    frequency = np.fft.rfftfreq(TABLE, 1 / TABLE)
    weight = np.exp(-0.5 * (frequency / max(waves, 1.0)) ** 2)
    table = np.fft.irfft(np.fft.rfft(rng.standard_normal((count, TABLE)), axis=1) * weight, TABLE, axis=1)
    table /= table.std()
    where = (lap - np.floor(lap)) * TABLE
    k = np.minimum(where.astype(int), TABLE - 1)
    t = where - k
    return table[:, k] * (1 - t) + table[:, (k + 1) % TABLE] * t


def _cubic(values: np.ndarray, k: np.ndarray, t: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Values and slopes of Catmull-Rom curves at places k + t of periodic rows."""
    n = values.shape[1]
    a, b, c, d = (values[:, (k + m) % n] for m in (-1, 0, 1, 2))
    value = b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)))
    slope = 0.5 * (c - a + t * (2 * (2 * a - 5 * b + 4 * c - d) + 3 * t * (3 * (b - c) + d - a)))
    return value, slope / step


def sample_surface(tiles: list[Tile], shape: tuple[int, int], size: tuple[float, float]) -> Samples:
    """Draw all yarns into a depth buffer of shape (rows, columns) over a periodic tile of size (x, y) [m]."""
    height = np.full(shape, -np.inf, np.float32)
    yarn, colour = np.full(shape, -1, np.int32), np.full(shape, -1, np.int16)
    dx, dy, run, across = (np.zeros(shape, np.float32) for _ in range(4))
    for tile in tiles:
        offset = np.linspace(0, 1, PROFILE + 1)
        top = np.sqrt(np.maximum(1 - offset**tile.power, 0))
        fall = tile.power / 2 * offset ** (tile.power - 1) / np.maximum(top, FLANK)
        draw = _draw_warp if tile.along == 0 else _draw_weft
        step = size[0] / shape[1] if tile.along == 0 else size[1] / shape[0]
        draw(tile.centre, tile.height, tile.slope, tile.lean, tile.half, tile.tall, tile.taper, tile.colour, tile.first,
             top, fall, step, height, yarn, dx, dy, run, colour, across)  # fmt: skip
    return Samples(height, yarn, dx, dy, run, colour, across)


@njit(cache=True, error_model="numpy")
def _draw_warp(centre, axis, slope, lean, half, tall, taper, tint, first, top, fall, step, height, yarn, dx, dy, run,
               colour, across):  # fmt: skip
    rows, columns = height.shape
    profile = top.size - 1
    for row in range(rows):
        place = rows - 1 - row  # row 0 is the top of the cloth
        for y in range(centre.shape[0]):
            if tint[y, place] < 0:
                continue
            c, h, wide, high = centre[y, place], axis[y, place], half[y, place], tall[y, place]
            begin = int(np.ceil((c - wide) / step - 0.5))
            end = int(np.floor((c + wide) / step - 0.5))
            for q in range(begin, end + 1):
                o = ((q + 0.5) * step - c) / wide
                part = int(abs(o) * profile + 0.5)
                if part > profile:
                    continue
                z = h + high * top[part]
                column = q % columns
                if z > height[row, column]:
                    steep = -high / wide * fall[part] * (1.0 if o > 0 else -1.0)
                    leans = lean[y, place] + o * taper[y, place]
                    height[row, column] = z
                    yarn[row, column] = first + y
                    dx[row, column] = steep
                    dy[row, column] = slope[y, place] - steep * leans
                    run[row, column] = np.pi / 2 - np.arctan(leans)
                    colour[row, column] = tint[y, place]
                    across[row, column] = o


@njit(cache=True, error_model="numpy")
def _draw_weft(centre, axis, slope, lean, half, tall, taper, tint, first, top, fall, step, height, yarn, dx, dy, run,
               colour, across):  # fmt: skip
    rows, columns = height.shape
    profile = top.size - 1
    for y in range(centre.shape[0]):
        low, high_edge = 1e30, -1e30
        for k in range(columns):
            low = min(low, centre[y, k] - half[y, k])
            high_edge = max(high_edge, centre[y, k] + half[y, k])
        for q in range(int(np.ceil(low / step - 0.5)), int(np.floor(high_edge / step - 0.5)) + 1):
            row = rows - 1 - q % rows
            for k in range(columns):
                o = ((q + 0.5) * step - centre[y, k]) / half[y, k]
                if abs(o) > 1.0 or tint[y, k] < 0:
                    continue
                part = int(abs(o) * profile + 0.5)
                z = axis[y, k] + tall[y, k] * top[part]
                if z > height[row, k]:
                    steep = -tall[y, k] / half[y, k] * fall[part] * (1.0 if o > 0 else -1.0)
                    leans = lean[y, k] + o * taper[y, k]
                    height[row, k] = z
                    yarn[row, k] = first + y
                    dy[row, k] = steep
                    dx[row, k] = slope[y, k] - steep * leans
                    run[row, k] = np.arctan(leans)
                    colour[row, k] = tint[y, k]
                    across[row, k] = o
