"""Whether a correlation matrix may be factored: Kaiser–Meyer–Olkin and Bartlett's test of sphericity.

The published figures come from factor_analyzer, whose two functions agree with R's psych to 1e-15. Our own
formulas stand beside them and must agree, so a fault in either is seen and never printed.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import chi2 as chi_square

from survey.analysis.checks import finite_scores, require_independent
from survey.analysis.correlation import correlate
from survey.analysis.errors import AnalysisError, TooFewRows

__all__ = ["Adequacy", "Bartlett", "adequacy", "adequacy_by_formula"]

AGREEMENT = 1e-8
ROUNDING = 1e-24  # a sum of squared correlations below it is zero


@dataclass(frozen=True)
class Bartlett:
    """chi2 = −(n − 1 − (2p + 5) / 6) ln det R on df = p (p − 1) / 2; p is its upper tail."""

    chi2: float
    df: int
    p: float


@dataclass(frozen=True)
class Adequacy:
    """kmo: overall; kmo_per_item: (p,)."""

    kmo: float
    kmo_per_item: NDArray[np.float64]
    bartlett: Bartlett


def adequacy(scores: ArrayLike, items: Sequence[str] | None = None) -> Adequacy:
    """KMO and Bartlett of scores (n, p) by factor_analyzer, cross-checked by our formulas.

    Raises TooFewRows when n ≤ p, DependentItems, ConstantItem, NotFinite, and AnalysisError when the two
    disagree by more than 1e-8 of the figure.
    """
    table, names = finite_scores(scores, items)
    ours = adequacy_by_formula(table, names)
    theirs = _by_factor_analyzer(table, ours.bartlett.df)
    for what, one, other in (
        ("KMO", ours.kmo, theirs.kmo),
        ("Bartlett's chi-square", ours.bartlett.chi2, theirs.bartlett.chi2),
    ):
        if abs(one - other) > AGREEMENT * max(1.0, abs(one)):
            raise AnalysisError(
                f"{what}: factor_analyzer says {other!r}, the formula {one!r} – the items are nearly dependent",
                names,
            )
    return theirs


def adequacy_by_formula(scores: ArrayLike, items: Sequence[str] | None = None) -> Adequacy:
    """The same from the textbook formulas, with Q the anti-image correlation −S_ij / √(S_ii S_jj), S = R⁻¹.

    KMO = Σ r² / (Σ r² + Σ q²) over i ≠ j (Kaiser 1974). Raises as `adequacy`.
    """
    table, names = finite_scores(scores, items)
    n, p = table.shape
    if p < 2:
        raise AnalysisError("one item alone cannot be factored – give at least two", names)
    if n <= p:
        raise TooFewRows(f"{n} answers for {p} items – KMO and Bartlett need more answers than items")
    r = correlate(table, names).r
    require_independent(r, names)
    inverse = np.linalg.inv(r)
    scale = np.sqrt(np.diag(inverse))
    outside = 1.0 - np.eye(p)
    r2 = (r * outside) ** 2
    q2 = (inverse / np.outer(scale, scale) * outside) ** 2
    alone = r2.sum(axis=0) < ROUNDING
    if alone.any():
        lone = [name for name, flag in zip(names, alone, strict=True) if flag]
        raise AnalysisError(
            f"{', '.join(lone)}: correlated with no other item – KMO is undefined, drop it", lone
        )
    kmo = float(r2.sum() / (r2.sum() + q2.sum()))
    per_item = r2.sum(axis=0) / (r2.sum(axis=0) + q2.sum(axis=0))
    chi2 = -(n - 1 - (2 * p + 5) / 6) * float(np.linalg.slogdet(r).logabsdet)
    df = p * (p - 1) // 2
    return Adequacy(kmo, per_item, Bartlett(chi2, df, float(chi_square.sf(chi2, df))))


def _by_factor_analyzer(table: NDArray[np.float64], df: int) -> Adequacy:
    with warnings.catch_warnings():
        # factor_analyzer 0.5.1 passes `force_all_finite`, which scikit-learn 1.6–1.7 announces to rename.
        warnings.filterwarnings("ignore", message=".*force_all_finite.*", category=FutureWarning)
        # Below a determinant of 1e-7 it takes the pseudo-inverse and warns. The items are known to be independent
        # by then, so this is the inverse, and the cross-check would show it were it not.
        warnings.filterwarnings("ignore", message=".*Moore-Penrose.*", category=UserWarning)
        from factor_analyzer.factor_analyzer import calculate_bartlett_sphericity, calculate_kmo

        per_item, kmo = calculate_kmo(table)
        chi2, p = calculate_bartlett_sphericity(table)
    return Adequacy(float(kmo), np.asarray(per_item, dtype=np.float64), Bartlett(float(chi2), df, float(p)))
