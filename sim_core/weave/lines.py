"""Yarn centre lines: the periodic cubic splines through the relaxed heights, and their natural irregularity."""

from typing import NamedTuple

import numpy as np

from sim_core.weave.geometry import YarnGeometry
from sim_core.weave.model import Weave
from sim_core.weave.yarn import Yarn

__all__ = ["YarnSystem", "resampled", "spline_slopes", "yarn_systems"]

TABLE = 256  # samples of irregularity along a yarn, once round the tile
STREAKS = 64  # fibre streaks round a yarn


class YarnSystem(NamedTuple):
    """All warp ends or all weft picks of a tile, as the rasteriser wants them.

    height, slope: (lines, crossings) of one repeat: height [m] and slope x spacing [m] at the crossings.
    across, along: [m] spacing of the yarns, and of the crossings along a yarn.  half_width, half_height: [m].
    swell, wander: (yarns in the tile, TABLE) relative width and sideways shift [m].  streak: (yarns, STREAKS) shade of
    the fibres round the yarn.  turns: whole turns of twist along the tile.  colour: (3,) linear RGB.
    length: [m] of the tile along the yarns.
    """

    height: np.ndarray
    slope: np.ndarray
    across: float
    along: float
    half_width: float
    half_height: float
    swell: np.ndarray
    wander: np.ndarray
    streak: np.ndarray
    turns: float
    colour: np.ndarray
    length: float


def spline_slopes(height: np.ndarray) -> np.ndarray:
    """Slopes x spacing at the knots of periodic cubic splines; height: (lines, crossings)."""
    theta = 2 * np.pi * np.arange(height.shape[1]) / height.shape[1]
    symbol = 6j * np.sin(theta) / (4 + 2 * np.cos(theta))
    return np.fft.ifft(np.fft.fft(height, axis=1) * symbol, axis=1).real


def resampled(height: np.ndarray, per: int) -> np.ndarray:
    """(lines, crossings) -> (lines, crossings * per) on the periodic cubic spline through the crossings."""
    slope = spline_slopes(height)
    t = np.arange(per) / per
    after, slope_after = np.roll(height, -1, axis=1), np.roll(slope, -1, axis=1)
    z = (
        height[..., None] * (1 + 2 * t) * (1 - t) ** 2 + after[..., None] * t * t * (3 - 2 * t)
        + slope[..., None] * t * (1 - t) ** 2 - slope_after[..., None] * t * t * (1 - t)
    )  # fmt: skip
    return np.ascontiguousarray(z.reshape(len(height), -1))


def yarn_systems(
    weave: Weave, geometry: YarnGeometry, repeats: tuple[int, int], seed: int
) -> tuple[YarnSystem, YarnSystem]:
    """Warp and weft of a tile of repeats (across, down). seed: of the irregularity, periodic over the tile."""
    rng = np.random.default_rng(seed)
    ends, picks = repeats[0] * weave.draft.ends, repeats[1] * weave.draft.picks
    spacings = weave.end_spacing, weave.pick_spacing
    warp = _system(weave.warp, geometry.warp_height.T, spacings, ends, picks, rng)
    weft = _system(weave.weft, geometry.weft_height, spacings[::-1], picks, ends, rng)
    return warp, weft


def _system(yarn: Yarn, height, spacings, count: int, crossings: int, rng) -> YarnSystem:
    across, along = spacings
    length = crossings * along
    room = max(across - yarn.width, 0.15 * across)
    swell = 1 + yarn.unevenness * _smooth_noise(rng, count, length / (6 * along))
    wander = 0.45 * yarn.unevenness * room * _smooth_noise(rng, count, length / (8 * along))
    linear = np.array([_to_linear(c) for c in yarn.colour])
    return YarnSystem(
        height=np.ascontiguousarray(height),
        slope=np.ascontiguousarray(spline_slopes(height)),
        across=across,
        along=along,
        half_width=yarn.width / 2,
        half_height=yarn.height / 2,
        swell=np.clip(swell, 0.5, 1.6),
        wander=np.clip(wander, -0.4 * across, 0.4 * across),
        streak=1 + 0.09 * rng.standard_normal((count, STREAKS)),
        turns=float(max(1, round(length / (60 * yarn.diameter)))),
        colour=linear,
        length=length,
    )


def _smooth_noise(rng: np.random.Generator, count: int, waves: float) -> np.ndarray:
    """(count, TABLE) periodic noise of unit variance with about `waves` swings along the table."""
    frequency = np.fft.rfftfreq(TABLE, 1 / TABLE)
    weight = np.exp(-0.5 * (frequency / max(waves, 1.0)) ** 2)
    noise = np.fft.irfft(np.fft.rfft(rng.standard_normal((count, TABLE)), axis=1) * weight, TABLE, axis=1)
    return noise / noise.std()


def _to_linear(value: float) -> float:
    """sRGB 0..1 to linear light."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
