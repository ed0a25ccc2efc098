"""Pearson correlation with two-tailed probabilities (the paper's Fig. 6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import t as student

from survey.analysis.checks import finite_scores, require_varying

__all__ = ["Correlation", "correlate", "stars"]


@dataclass(frozen=True)
class Correlation:
    """r: (p, p) Pearson coefficients. p: (p, p) two-tailed probability of |r| or more when there is none."""

    r: NDArray[np.float64]
    p: NDArray[np.float64]
    n: int


def correlate(scores: ArrayLike, items: Sequence[str] | None = None) -> Correlation:
    """Pearson matrix of scores (n, p) with t = r √((n − 2) / (1 − r²)) on n − 2 degrees of freedom.

    Raises TooFewRows below three answers, NotFinite, ConstantItem, AllEqual.
    """
    table, names = finite_scores(scores, items, rows=3)
    require_varying(table, names)
    centred = table - table.mean(axis=0)
    unit = centred / np.sqrt((centred**2).sum(axis=0))
    r = np.clip(unit.T @ unit, -1.0, 1.0)
    r = (r + r.T) / 2
    np.fill_diagonal(r, 1.0)
    return Correlation(r, _two_tailed(r, len(table)), len(table))


def _two_tailed(r: NDArray[np.float64], n: int) -> NDArray[np.float64]:
    p = np.zeros_like(r)  # a perfect correlation leaves no chance, and its t is infinite
    imperfect = np.abs(r) < 1.0
    t = np.abs(r[imperfect]) * np.sqrt((n - 2) / (1.0 - r[imperfect] ** 2))
    p[imperfect] = 2.0 * student.sf(t, n - 2)
    return p


def stars(p: float) -> str:
    """ "**" below .01, "*" below .05, else nothing, as the paper prints them."""
    return "**" if p < 0.01 else "*" if p < 0.05 else ""
