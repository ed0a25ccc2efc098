"""Direct oblimin with γ = 0 (quartimin), Kaiser-normalised, as SPSS's δ = 0.

The criterion and its gradient are Jennrich's (2002, Psychometrika 67); the descent is L-BFGS over turns whose columns
are scaled to length 1, from several starts. factor_analyzer multiplies by zeros for γ ≠ 0 and stops at 1e-5;
GPArotation's default stops there too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize

from survey.analysis.components.orthogonal_rotation import row_lengths, starts, varimax
from survey.analysis.errors import NotConverged, WrongShape

__all__ = ["oblimin", "quartimin_criterion"]

AT_REST = 1e-6  # length of the gradient below which an end counts as one; most ends reach 1e-9
STEPS = 1500
STARTS = 4


def oblimin(loadings: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Pattern (p, k) and correlations of the components (k, k) at the least quartimin criterion.

    Columns are sorted by the sum of squares they explain, Σ over items of pattern × structure, largest first, each
    with a sum of loadings ≥ 0. Raises NotConverged.
    """
    start = np.asarray(loadings, dtype=np.float64)
    if start.ndim != 2 or not np.isfinite(start).all():
        raise WrongShape("loadings must be a finite table, one row per item, one column per component")
    if start.shape[1] < 2:
        return varimax(start), np.eye(start.shape[1])
    length = row_lengths(start)
    unit = start / length
    # Varimax is close to the end when components correlate little; random starts find other minima.
    turns = [np.linalg.lstsq(unit, varimax(start) / length, rcond=None)[0], *starts(start.shape[1], STARTS)]
    ends = [end for turn in turns if (end := _descend(unit, turn)) is not None]
    if not ends:
        raise NotConverged(f"oblimin moves on after {STEPS} steps – the components may be too many")
    turn = min(ends, key=lambda end: quartimin_criterion(unit @ np.linalg.inv(end).T))
    return _ordered(unit @ np.linalg.inv(turn).T * length, turn.T @ turn)


def quartimin_criterion(pattern: NDArray[np.float64]) -> float:
    """¼ Σ over items and over pairs of columns of the product of squared loadings, each pair counted twice."""
    squares = pattern**2
    return float((squares.sum(axis=1) ** 2 - (squares**2).sum(axis=1)).sum() / 4.0)


def _descend(unit: NDArray[np.float64], turn: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """From T (k, k) downhill to unit columns; the pattern is A T⁻ᵀ. None where it does not come to rest."""
    shape = turn.shape
    scale = float((unit**2).sum())
    found = minimize(
        _value_and_slope, turn.ravel(), args=(unit, shape), jac=True, method="L-BFGS-B",
        options={"ftol": 0.0, "gtol": 1e-12 * scale, "maxiter": STEPS, "maxfun": 3 * STEPS, "maxcor": 30},
    )  # fmt: skip
    end = found.x.reshape(shape)
    end = end / np.sqrt((end**2).sum(axis=0))
    slope = _value_and_slope(end.ravel(), unit, shape)[1]
    return end if float(np.sqrt((slope**2).sum())) < AT_REST * scale else None


def _value_and_slope(
    flat: NDArray[np.float64], unit: NDArray[np.float64], shape: tuple[int, int]
) -> tuple[float, NDArray[np.float64]]:
    length = np.sqrt((flat.reshape(shape) ** 2).sum(axis=0))
    turn = flat.reshape(shape) / length
    inverse = np.linalg.inv(turn)
    pattern = unit @ inverse.T
    squares = pattern**2
    slope = pattern * (squares.sum(axis=1, keepdims=True) - squares)
    gradient = -(pattern.T @ slope @ inverse).T
    along = (gradient - turn * (turn * gradient).sum(axis=0)) / length  # what keeps the columns' length
    return quartimin_criterion(pattern), along.ravel()


def _ordered(
    pattern: NDArray[np.float64], correlation: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    sign = np.where(pattern.sum(axis=0) < 0.0, -1.0, 1.0)
    pattern, correlation = pattern * sign, correlation * np.outer(sign, sign)
    order = np.argsort(-(pattern * (pattern @ correlation)).sum(axis=0), kind="stable")
    return pattern[:, order], correlation[np.ix_(order, order)]
