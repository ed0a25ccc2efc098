"""Yarn centre lines: the periodic cubic splines through the relaxed heights, and their natural irregularity."""

import numpy as np

__all__ = ["resampled", "smooth_noise", "spline_slopes"]

TABLE = 256  # samples of irregularity along a yarn, once round the tile


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


def smooth_noise(rng: np.random.Generator, count: int, waves: float) -> np.ndarray:
    """(count, TABLE) periodic noise of unit variance with about `waves` swings along the table."""
    frequency = np.fft.rfftfreq(TABLE, 1 / TABLE)
    weight = np.exp(-0.5 * (frequency / max(waves, 1.0)) ** 2)
    noise = np.fft.irfft(np.fft.rfft(rng.standard_normal((count, TABLE)), axis=1) * weight, TABLE, axis=1)
    return noise / noise.std()
