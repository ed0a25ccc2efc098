"""Cronbach's α (Cronbach 1951), α without each item, and each item's correlation with the rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.analysis.checks import finite_scores
from survey.analysis.errors import AllEqual, TooFewItems

__all__ = ["Reliability", "reliability", "reliability_of"]

STILL = 1e-12  # a variance of the sums below this share of the items' variances counts as none


@dataclass(frozen=True)
class Reliability:
    """alpha: raw; standardised: from the mean correlation; if_deleted: (p,) raw α without each item, or None.

    item_total: (p,) corrected, the correlation of an item with the sum of the others (r.drop in R's psych).
    standardised is None where an item is constant, if_deleted where only two items are left; an entry of
    if_deleted or item_total is NaN where the item or the sums of the others do not vary.
    """

    alpha: float
    standardised: float | None
    if_deleted: NDArray[np.float64] | None
    item_total: NDArray[np.float64]


def reliability(scores: ArrayLike, items: Sequence[str] | None = None) -> Reliability:
    """α = p / (p − 1) (1 − Σ var_i / var(Σ x_i)) of complete scores (n, p).

    Raises AllEqual when the sums do not vary, TooFewItems for a single one, NotFinite, TooFewRows.
    """
    table, names = finite_scores(scores, items)
    return reliability_of(np.atleast_2d(np.cov(table, rowvar=False)), names)


def reliability_of(covariance: NDArray[np.float64], names: Sequence[str]) -> Reliability:
    """The same from covariances (p, p). Raises AllEqual, TooFewItems."""
    p = len(covariance)
    if p < 2:
        raise TooFewItems("one item alone has no internal consistency – give at least two", names)
    variances = np.diag(covariance)
    alpha = float(_alpha(np.array([variances.sum()]), np.array([covariance.sum()]), p)[0])
    if np.isnan(alpha):
        raise AllEqual("the sums of the answers do not vary – α is undefined", names)
    deleted = None
    shared = covariance.sum(axis=0) - variances  # covariance of each item with the sum of the others
    rest = covariance.sum() - 2.0 * shared - variances
    if p > 2:
        deleted = _alpha(variances.sum() - variances, rest, p - 1)
    standardised = None
    if (variances > 0.0).all():
        deviation = np.sqrt(variances)
        total = (covariance / np.outer(deviation, deviation)).sum()
        value = float(_alpha(np.array([float(p)]), np.array([total]), p)[0])
        standardised = None if np.isnan(value) else value
    return Reliability(alpha, standardised, deleted, _correlated(shared, variances, rest))


def _correlated(
    shared: NDArray[np.float64], own: NDArray[np.float64], rest: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Correlations from covariances and the two variances, all (p,); NaN where one of the two is none."""
    still = (own <= 0.0) | (rest <= STILL * own.sum())
    return np.where(still, np.nan, shared / np.sqrt(np.where(still, 1.0, own * rest)))


def _alpha(parts: NDArray[np.float64], total: NDArray[np.float64], p: int) -> NDArray[np.float64]:
    """α from the sum of the variances and the variance of the sum; NaN where the sum does not vary."""
    still = total <= STILL * parts
    return np.where(still, np.nan, p / (p - 1) * (1.0 - parts / np.where(still, 1.0, total)))
