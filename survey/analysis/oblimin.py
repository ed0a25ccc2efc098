"""Direct oblimin with γ = 0 (quartimin), Kaiser-normalised, as SPSS's δ = 0.

Gradient projection in the oblique manifold (Jennrich 2002, Psychometrika 67) from several starts. factor_analyzer
multiplies by zeros for γ ≠ 0 and stops at 1e-5; GPArotation's default stops there too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.analysis.errors import AnalysisError, NotConverged
from survey.analysis.varimax import row_lengths, starts, varimax

__all__ = ["oblimin", "quartimin_criterion"]

TOLERANCE = 1e-10  # length of the projected gradient
STEPS = 20_000
STARTS = 6


def oblimin(
    loadings: ArrayLike, *, attempts: int = STARTS
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Pattern (p, k) and correlations of the components (k, k) at the least quartimin criterion.

    Columns are sorted by the sum of squares they explain, Σ over items of pattern × structure, largest first, each
    with a sum of loadings ≥ 0. Raises NotConverged.
    """
    start = np.asarray(loadings, dtype=np.float64)
    if start.ndim != 2 or not np.isfinite(start).all():
        raise AnalysisError("loadings must be a finite table, one row per item, one column per component")
    if start.shape[1] < 2:
        return varimax(start), np.eye(start.shape[1])
    length = row_lengths(start)
    unit = start / length
    # Varimax is close to the end when components correlate little; random starts find other minima.
    turns = [np.linalg.lstsq(unit, varimax(start) / length, rcond=None)[0], *starts(start.shape[1], attempts)]
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
    """From T (k, k) with unit columns downhill; the pattern is A T⁻ᵀ. None where it does not come to rest."""
    turn = turn / np.sqrt((turn**2).sum(axis=0))
    pattern, step = unit @ np.linalg.inv(turn).T, 1.0
    value = quartimin_criterion(pattern)
    for _ in range(STEPS):
        squares = pattern**2
        slope = pattern * (squares.sum(axis=1, keepdims=True) - squares)
        gradient = -(pattern.T @ slope @ np.linalg.inv(turn)).T
        along = gradient - turn * (turn * gradient).sum(axis=0)  # what keeps the columns' length
        size = float(np.sqrt((along**2).sum()))
        if size < TOLERANCE:
            return turn
        step *= 2.0
        for _ in range(60):
            moved = turn - step * along
            moved = moved / np.sqrt((moved**2).sum(axis=0))
            tried = unit @ np.linalg.inv(moved).T
            after = quartimin_criterion(tried)
            if after < value - 0.5 * size**2 * step:
                break
            step /= 2.0
        else:
            return turn if size < 1e-7 else None  # no step lowers it any more: rounding's floor
        turn, pattern, value = moved, tried, after
    return None


def _ordered(
    pattern: NDArray[np.float64], correlation: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    sign = np.where(pattern.sum(axis=0) < 0.0, -1.0, 1.0)
    pattern, correlation = pattern * sign, correlation * np.outer(sign, sign)
    order = np.argsort(-(pattern * (pattern @ correlation)).sum(axis=0), kind="stable")
    return pattern[:, order], correlation[np.ix_(order, order)]
