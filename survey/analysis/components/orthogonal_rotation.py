"""Varimax by planar rotations with Kaiser's normalisation, turned until no angle is left, from several starts.

psych and factor_analyzer stop at 1e-5 of the criterion, which leaves loadings 4–9e-4 from the optimum, and they
start once: the criterion may have more than one maximum.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.analysis.errors import NotConverged, WrongShape

__all__ = ["ordered", "row_lengths", "starts", "varimax", "varimax_criterion"]

TOLERANCE = 1e-12  # [rad], the largest rotation of a sweep that counts as none
SWEEPS = 500
STARTS = 10


def varimax(loadings: ArrayLike, *, normalise: bool = True, attempts: int = STARTS) -> NDArray[np.float64]:
    """Rotate loadings (p, k) to the maximum of the varimax criterion (Kaiser 1958).

    normalise: divide each row by the root of its communality while rotating, as SPSS does and prints.
    attempts: how many starts, the loadings as they are and seeded random turns of them; the best end is taken.
    Columns come back sorted by their sum of squares, largest first, each with a sum of loadings ≥ 0.
    Raises NotConverged when no start comes to rest.
    """
    start = np.asarray(loadings, dtype=np.float64)
    if start.ndim != 2 or not np.isfinite(start).all():
        raise WrongShape("loadings must be a finite table, one row per item, one column per component")
    if start.shape[1] < 2:
        return ordered(start)
    length = row_lengths(start) if normalise else np.ones((len(start), 1))
    ends = [
        end for turn in starts(start.shape[1], attempts) if (end := _turn(start / length @ turn)) is not None
    ]
    if not ends:
        raise NotConverged(f"varimax turns on after {SWEEPS} sweeps – look for items without any structure")
    return ordered(max(ends, key=varimax_criterion) * length)


def row_lengths(loadings: NDArray[np.float64]) -> NDArray[np.float64]:
    """(p, 1) roots of the communalities, by which Kaiser divides; 1 for an item without any loading."""
    length = np.sqrt((loadings**2).sum(axis=1, keepdims=True))
    length[length == 0.0] = 1.0  # it stays where it is
    return length


def starts(k: int, attempts: int) -> list[NDArray[np.float64]]:
    """Orthogonal (k, k) turns to start from: none, then random ones, always the same."""
    rng = np.random.default_rng(1958)
    return [np.eye(k), *(np.linalg.qr(rng.normal(size=(k, k)))[0] for _ in range(attempts - 1))]


def varimax_criterion(loadings: NDArray[np.float64]) -> float:
    """Σ over columns of the variance of the squared loadings (p, k)."""
    return float((loadings**2).var(axis=0).sum())


def ordered(loadings: NDArray[np.float64]) -> NDArray[np.float64]:
    """Columns of loadings (p, k) by their sum of squares, largest first, each turned to a sum ≥ 0."""
    upright = loadings * np.where(loadings.sum(axis=0) < 0.0, -1.0, 1.0)
    return upright[:, np.argsort(-(upright**2).sum(axis=0), kind="stable")]


def _turn(loadings: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Sweep over all planes; in each the best angle is known in closed form. None where it turns on and on."""
    columns = np.ascontiguousarray(loadings.T)
    planes = list(combinations(range(len(columns)), 2))
    for _ in range(SWEEPS):
        largest = 0.0
        for i, j in planes:
            angle = _best_angle(columns[i], columns[j])
            if angle:
                largest = max(largest, abs(angle))
                cos, sin = np.cos(angle), np.sin(angle)
                columns[[i, j]] = np.array([[cos, sin], [-sin, cos]]) @ columns[[i, j]]
        if largest < TOLERANCE:
            return columns.T.copy()
    return None


def _best_angle(x: NDArray[np.float64], y: NDArray[np.float64]) -> float:
    """Angle in (−π/4, π/4] that maximises the variance of squares in the plane of two columns."""
    u, v = x * x - y * y, 2.0 * x * y
    p = len(x)
    total_u, total_v = u.sum(), v.sum()
    across = 2.0 * (u @ v - total_u * total_v / p)
    along = u @ u - v @ v - (total_u**2 - total_v**2) / p
    # Rounding noise must not be taken for a direction: equal columns have no best angle.
    if np.hypot(across, along) < 1e-14 * p:
        return 0.0
    return float(np.arctan2(across, along)) / 4.0
