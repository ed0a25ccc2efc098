"""Cronbach's α (Cronbach 1951)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.analysis.checks import constant_columns, finite_scores
from survey.analysis.errors import AllEqual, AnalysisError

__all__ = ["Reliability", "reliability"]


@dataclass(frozen=True)
class Reliability:
    """alpha: raw; standardised: from the mean correlation; if_deleted: (p,) raw α without each item, or None.

    standardised is None where an item is constant, if_deleted where only two items are left.
    """

    alpha: float
    standardised: float | None
    if_deleted: NDArray[np.float64] | None


def reliability(scores: ArrayLike, items: Sequence[str] | None = None) -> Reliability:
    """α = p / (p − 1) (1 − Σ var_i / var(Σ x_i)) of scores (n, p).

    Raises AllEqual when the sums do not vary, AnalysisError for a single item, NotFinite, TooFewRows.
    """
    table, names = finite_scores(scores, items)
    p = table.shape[1]
    if p < 2:
        raise AnalysisError("one item alone has no internal consistency – give at least two", names)
    covariance = np.cov(table, rowvar=False)
    deleted = None
    if p > 2:
        rest = [np.delete(np.delete(covariance, item, 0), item, 1) for item in range(p)]
        deleted = np.array([_alpha(part, names) for part in rest])
    standardised = None
    if not constant_columns(table).any():
        deviation = np.sqrt(np.diag(covariance))
        standardised = _alpha(covariance / np.outer(deviation, deviation), names)
    return Reliability(_alpha(covariance, names), standardised, deleted)


def _alpha(covariance: NDArray[np.float64], names: Sequence[str]) -> float:
    total = covariance.sum()
    if total <= 1e-12 * np.trace(covariance) or np.trace(covariance) == 0.0:
        raise AllEqual("the sums of the answers do not vary – α is undefined", names)
    p = len(covariance)
    return float(p / (p - 1) * (1.0 - np.trace(covariance) / total))
