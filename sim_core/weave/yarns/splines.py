"""Yarn centre lines: the periodic cubic splines through the relaxed heights, and easing between two crossings."""

import numpy as np

__all__ = ["eased", "resampled", "spline_slopes"]


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


def eased(values: np.ndarray, n: int) -> np.ndarray:
    """(lines, n) values at the crossings, eased from one to the next round the repeat."""
    t = np.arange(n // values.shape[1]) / (n // values.shape[1])
    ease = t * t * (3 - 2 * t)
    return (values[..., None] * (1 - ease) + np.roll(values, -1, axis=1)[..., None] * ease).reshape(
        len(values), -1
    )
