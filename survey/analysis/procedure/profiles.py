"""Means per module and dimension of a questionnaire that judges every module from the same sides (III.C)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

__all__ = ["LEVEL", "Profile", "profile"]

LEVEL = 0.95


@dataclass(frozen=True)
class Profile:
    """Of m modules and d dimensions: mean, half (m, d), NaN where nobody (or one alone) answered; n (m, d).

    mean ± half is the 95 % interval of Student's t.
    """

    mean: NDArray[np.float64]
    half: NDArray[np.float64]
    n: NDArray[np.int64]

    @property
    def lowest(self) -> float:
        """Lower end of the lowest interval; 1 where nobody answered."""
        ends = self.mean - np.nan_to_num(self.half)
        return float(np.nanmin(ends)) if np.isfinite(ends).any() else 1.0


def profile(scores: NDArray[np.float64], modules: int, dimensions: int) -> Profile:
    """Of scores (n, modules × dimensions), NaN where missing, the items of a module side by side."""
    cube = np.asarray(scores, dtype=np.float64).reshape(len(scores), modules, dimensions)
    there = ~np.isnan(cube)
    n = there.sum(axis=0)
    total = np.where(there, cube, 0.0).sum(axis=0)
    mean = np.where(n > 0, total / np.maximum(n, 1), np.nan)
    spread = np.where(there, cube - mean, 0.0)
    deviation = np.sqrt((spread**2).sum(axis=0) / np.maximum(n - 1, 1))
    quantile = stdtrit(np.maximum(n - 1, 1), (1.0 + LEVEL) / 2.0)
    half = np.where(n > 1, quantile * deviation / np.sqrt(np.maximum(n, 1)), np.nan)
    return Profile(mean, half, n)
