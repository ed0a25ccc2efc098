"""Whether a correlation matrix may be factored: Kaiser–Meyer–Olkin and Bartlett's test of sphericity.

The figures are ours, from the matrix, so that they serve pairwise and polychoric correlations too. factor_analyzer,
whose two functions agree with R's psych to 1e-15, computes them once more from the scores: a fault in either is
seen and never printed.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.special import chdtrc

from survey.analysis.checks import finite_scores, require_independent
from survey.analysis.correlation import correlate
from survey.analysis.errors import CrossCheckFailed, LoneItem, TooFewItems, TooFewRows

__all__ = ["Adequacy", "Bartlett", "adequacy", "adequacy_by_factor_analyzer", "adequacy_of"]

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


def adequacy_of(r: NDArray[np.float64], n: int, names: Sequence[str]) -> Adequacy:
    """KMO and Bartlett of a correlation matrix (p, p) of n answers.

    KMO = Σ r² / (Σ r² + Σ q²) over i ≠ j, q the anti-image correlation −S_ij / √(S_ii S_jj), S = R⁻¹
    (Kaiser 1974). Raises TooFewRows when n ≤ p, TooFewItems, LoneItem, DependentItems, NotPositiveDefinite.
    """
    p = len(r)
    if p < 2:
        raise TooFewItems("one item alone cannot be factored – give at least two", names)
    if n <= p:
        raise TooFewRows(f"{n} answers for {p} items – KMO and Bartlett need more answers than items")
    require_independent(r, names)
    factor = cho_factor(r, lower=True)
    inverse = cho_solve(factor, np.eye(p))
    scale = np.sqrt(np.diag(inverse))
    outside = 1.0 - np.eye(p)
    r2 = ((r * outside) ** 2).sum(axis=0)
    q2 = ((inverse / np.outer(scale, scale) * outside) ** 2).sum(axis=0)
    lone = [name for name, alone in zip(names, r2 < ROUNDING, strict=True) if alone]
    if lone:
        raise LoneItem(f"{', '.join(lone)}: correlated with no other item – KMO is undefined, drop it", lone)
    log_determinant = 2.0 * float(np.log(np.diag(factor[0])).sum())
    chi2 = -(n - 1 - (2 * p + 5) / 6) * log_determinant
    df = p * (p - 1) // 2
    bartlett = Bartlett(chi2, df, float(chdtrc(df, max(chi2, 0.0))))
    return Adequacy(float(r2.sum() / (r2.sum() + q2.sum())), r2 / (r2 + q2), bartlett)


def adequacy(scores: ArrayLike, items: Sequence[str] | None = None) -> Adequacy:
    """KMO and Bartlett of complete scores (n, p), cross-checked by factor_analyzer.

    Raises what `adequacy_of` and `correlate` raise, and CrossCheckFailed when the two disagree by more than 1e-8 of
    the figure.
    """
    table, names = finite_scores(scores, items)
    if len(table) <= table.shape[1]:
        raise TooFewRows(
            f"{len(table)} answers for {table.shape[1]} items – KMO and Bartlett need more answers than items"
        )
    if table.shape[1] < 2:
        raise TooFewItems("one item alone cannot be factored – give at least two", names)
    ours = adequacy_of(correlate(table, names).r, len(table), names)
    theirs = adequacy_by_factor_analyzer(table)
    for what, one, other in (
        ("KMO", ours.kmo, theirs.kmo),
        ("Bartlett's chi-square", ours.bartlett.chi2, theirs.bartlett.chi2),
    ):
        if abs(one - other) > AGREEMENT * max(1.0, abs(one)):
            raise CrossCheckFailed(
                f"{what}: factor_analyzer says {other!r}, the formula {one!r} – the items are nearly dependent",
                names,
            )
    return ours


def adequacy_by_factor_analyzer(table: NDArray[np.float64]) -> Adequacy:
    """The same by factor_analyzer, from complete scores (n, p) that `adequacy_of` has accepted."""
    with warnings.catch_warnings():
        # factor_analyzer 0.5.1 passes `force_all_finite`, which scikit-learn 1.6–1.7 announces to rename.
        warnings.filterwarnings("ignore", message=".*force_all_finite.*", category=FutureWarning)
        # Below a determinant of 1e-7 it takes the pseudo-inverse and warns. The items are known to be independent
        # by then, so this is the inverse, and the cross-check would show it were it not.
        warnings.filterwarnings("ignore", message=".*Moore-Penrose.*", category=UserWarning)
        from factor_analyzer.factor_analyzer import calculate_bartlett_sphericity, calculate_kmo

        per_item, kmo = calculate_kmo(table)
        chi2, p = calculate_bartlett_sphericity(table)
    df = table.shape[1] * (table.shape[1] - 1) // 2
    return Adequacy(float(kmo), np.asarray(per_item, dtype=np.float64), Bartlett(float(chi2), df, float(p)))
