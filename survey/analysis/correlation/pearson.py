"""Pearson correlation with two-tailed probabilities (the paper's Fig. 6), listwise or pairwise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import stdtr

from survey.analysis.checks import finite_scores, require_varying
from survey.analysis.errors import ConstantItem, NotFinite, TooFewRows

__all__ = ["Correlation", "correlate", "correlate_pairwise", "covariance_pairwise", "stars", "two_tailed"]


@dataclass(frozen=True)
class Correlation:
    """r: (p, p) coefficients. p: (p, p) two-tailed probability of |r| or more when there is none.

    counts: (p, p) answers behind each coefficient; n: the smallest of them.
    """

    r: NDArray[np.float64]
    p: NDArray[np.float64]
    counts: NDArray[np.int64]

    @property
    def n(self) -> int:
        return int(self.counts.min())


def correlate(scores: ArrayLike, items: Sequence[str] | None = None) -> Correlation:
    """Pearson matrix of complete scores (n, p) with t = r √((n − 2) / (1 − r²)) on n − 2 degrees of freedom.

    Raises TooFewRows below three answers, NotFinite, ConstantItem, AllEqual.
    """
    table, names = finite_scores(scores, items, rows=3)
    require_varying(table, names)
    centred = table - table.mean(axis=0)
    unit = centred / np.sqrt((centred**2).sum(axis=0))
    r = _tidy(unit.T @ unit)
    counts = np.full(r.shape, len(table), dtype=np.int64)
    return Correlation(r, two_tailed(r, counts), counts)


def correlate_pairwise(scores: ArrayLike, items: Sequence[str] | None = None) -> Correlation:
    """Pearson matrix of scores (n, p) with gaps (NaN), each coefficient over the answers that have both items.

    The matrix need not be positive definite. Raises TooFewRows where a pair has fewer than three answers in
    common, ConstantItem where an item does not vary within a pair, NotFinite for an infinite score.
    """
    table = np.asarray(scores, dtype=np.float64)
    finite_scores(np.nan_to_num(table, nan=0.0, posinf=0.0, neginf=0.0), items, rows=0)
    names = tuple(items) if items is not None else tuple(f"item_{at + 1}" for at in range(table.shape[1]))
    if np.isinf(table).any():
        raise NotFinite("infinite scores – correct them", names)
    r, counts = np.eye(table.shape[1]), np.zeros((table.shape[1],) * 2, dtype=np.int64)
    for i in range(table.shape[1]):
        for j in range(i + 1):
            both = table[~np.isnan(table[:, i]) & ~np.isnan(table[:, j])][:, [i, j]]
            counts[i, j] = counts[j, i] = len(both)
            pair = (names[i], names[j]) if i != j else (names[i],)
            if len(both) < 3:
                raise TooFewRows(f"{' and '.join(pair)}: {len(both)} answers in common – drop one", pair)
            if (both == both[0]).all(axis=0).any():
                raise ConstantItem(f"{' and '.join(pair)}: one never varies where both are answered", pair)
            if i != j:
                centred = both - both.mean(axis=0)
                x, y = (centred / np.sqrt((centred**2).sum(axis=0))).T
                r[i, j] = r[j, i] = float(x @ y)
    r = _tidy(r)
    return Correlation(r, two_tailed(r, counts), counts)


def covariance_pairwise(table: NDArray[np.float64], found: Correlation) -> NDArray[np.float64]:
    """(p, p) covariances from pairwise correlations and each item's own standard deviation."""
    deviation = np.nanstd(table, axis=0, ddof=1)
    return found.r * np.outer(deviation, deviation)


def _tidy(r: NDArray[np.float64]) -> NDArray[np.float64]:
    r = np.clip((r + r.T) / 2, -1.0, 1.0)
    np.fill_diagonal(r, 1.0)
    return r


def two_tailed(r: NDArray[np.float64], counts: NDArray[np.int64]) -> NDArray[np.float64]:
    """Probabilities (p, p) of coefficients r (p, p), each over its number of answers."""
    p = np.zeros_like(r)  # a perfect correlation leaves no chance, and its t is infinite
    imperfect = np.abs(r) < 1.0
    freedom = counts[imperfect] - 2.0
    t = np.abs(r[imperfect]) * np.sqrt(freedom / (1.0 - r[imperfect] ** 2))
    p[imperfect] = 2.0 * stdtr(freedom, -t)
    return p


def stars(p: float) -> str:
    """ "**" below .01, "*" below .05, else nothing, as the paper prints them."""
    return "**" if p < 0.01 else "*" if p < 0.05 else ""
