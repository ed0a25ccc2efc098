"""Varimax by planar rotations with Kaiser's normalisation, turned until no angle is left.

psych and factor_analyzer stop at 1e-5 of the criterion, which leaves loadings 4–9e-4 from the optimum.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.analysis.errors import AnalysisError

__all__ = ["varimax"]

TOLERANCE = 1e-12  # [rad], the largest rotation of a sweep that counts as none
SWEEPS = 500


def varimax(loadings: ArrayLike, *, normalise: bool = True) -> NDArray[np.float64]:
    """Rotate loadings (p, k) to the maximum of the varimax criterion (Kaiser 1958).

    normalise: divide each row by the root of its communality while rotating, as SPSS does and prints.
    Columns come back sorted by their sum of squares, largest first, each with a sum of loadings ≥ 0.
    Raises AnalysisError when the sweeps do not come to rest.
    """
    start = np.asarray(loadings, dtype=np.float64)
    if start.ndim != 2 or not np.isfinite(start).all():
        raise AnalysisError("loadings must be a finite table, one row per item, one column per component")
    length = np.sqrt((start**2).sum(axis=1, keepdims=True)) if normalise else np.ones((len(start), 1))
    length[length == 0.0] = 1.0  # an item without any loading stays where it is
    rotated = _turn(start / length) * length
    rotated = rotated * np.where(rotated.sum(axis=0) < 0.0, -1.0, 1.0)
    order = np.argsort(-(rotated**2).sum(axis=0), kind="stable")
    return rotated[:, order]


def _turn(loadings: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sweep over all planes; in each the best angle is known in closed form."""
    loadings = loadings.copy()
    planes = list(combinations(range(loadings.shape[1]), 2))
    for _ in range(SWEEPS):
        largest = 0.0
        for i, j in planes:
            angle = _best_angle(loadings[:, i], loadings[:, j])
            largest = max(largest, abs(angle))
            cos, sin = np.cos(angle), np.sin(angle)
            loadings[:, [i, j]] = loadings[:, [i, j]] @ np.array([[cos, -sin], [sin, cos]])
        if largest < TOLERANCE:
            return loadings
    raise AnalysisError(f"varimax turns on after {SWEEPS} sweeps – look for items without any structure")


def _best_angle(x: NDArray[np.float64], y: NDArray[np.float64]) -> float:
    """Angle in (−π/4, π/4] that maximises the variance of squares in the plane of two columns."""
    u, v = x**2 - y**2, 2.0 * x * y
    p = len(x)
    across = 2.0 * ((u * v).sum() - u.sum() * v.sum() / p)
    along = (u**2 - v**2).sum() - (u.sum() ** 2 - v.sum() ** 2) / p
    # Rounding noise must not be taken for a direction: equal columns have no best angle.
    if np.hypot(across, along) < 1e-14 * p:
        return 0.0
    return float(np.arctan2(across, along)) / 4.0
