"""Answers by what they leave out, and the mean and covariance of greatest likelihood that they have all together.

Complete answers are the case of one pattern, so one code serves both (full information, Arbuckle 1996).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.analysis.checks import DEPENDENT, constant_columns, dependent_columns
from survey.analysis.correlation.pearson import Correlation, two_tailed
from survey.analysis.errors import (
    ConstantItem,
    DependentItems,
    NotConverged,
    NotFinite,
    TooFewRows,
)

__all__ = ["Patterns", "Saturated", "correlate_likely", "misfit_of", "patterns_of", "saturated"]

ROUNDS, REST = 20_000, 1e-10


@dataclass(frozen=True)
class Patterns:
    """The answers that have the same items: there (K, p), counts (K,), and of each pattern its mean (K, p) and
    covariance (K, p, p; divided by its count), 0 where there is nothing."""

    there: NDArray[np.bool_]
    counts: NDArray[np.float64]
    mean: NDArray[np.float64]
    covariance: NDArray[np.float64]

    @property
    def n(self) -> int:
        return int(self.counts.sum())

    @property
    def whole(self) -> bool:
        return bool(self.there.all())

    @property
    def share(self) -> NDArray[np.float64]:
        """(K,) of all answers."""
        return self.counts / self.counts.sum()

    def around(self, mean: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """How far each pattern's own mean lies from a mean (K, p), and its scores' products about that (K, p, p)."""
        apart = np.where(self.there, self.mean - mean, 0.0)
        return apart, self.covariance + apart[:, :, None] * apart[:, None, :]


@dataclass(frozen=True)
class Saturated:
    """mean (p,), covariance (p, p; divided by n) and misfit of a model that leaves everything free."""

    mean: NDArray[np.float64]
    covariance: NDArray[np.float64]
    misfit: float


def patterns_of(table: NDArray[np.float64], names: Sequence[str]) -> Patterns:
    """Of scores (n, p), NaN missing; answers without any score are left out.

    Raises TooFewRows when n ≤ p or a pair of items has fewer than three answers in common, ConstantItem, NotFinite.
    """
    table = table[~np.isnan(table).all(axis=1)]
    n, p = table.shape
    if n <= p:
        raise TooFewRows(f"{n} answers for {p} items – a factor model needs more answers than items")
    there = ~np.isnan(table)
    _require_known(table, there, names)
    # Scores enter as distances from their mean: the sums of squares then lose nothing.
    masks, which = np.unique(there, axis=0, return_inverse=True)
    which = which.reshape(-1)
    counts = np.bincount(which).astype(np.float64)
    mean, covariance = np.zeros(masks.shape), np.zeros((*masks.shape, p))
    for at, mask in enumerate(masks):
        own = np.where(mask, table[which == at], 0.0)
        mean[at] = own.mean(axis=0)
        apart = own - mean[at]
        covariance[at] = apart.T @ apart / len(own)
    return Patterns(masks, counts, mean, covariance)


def _require_known(table: NDArray[np.float64], there: NDArray[np.bool_], names: Sequence[str]) -> None:
    for at, name in enumerate(names):
        column = table[there[:, at], at]
        if not len(column):
            raise NotFinite(f"{name}: no scores at all – drop the item", (name,))
        if constant_columns(column[:, None])[0]:
            raise ConstantItem(f"{name}: the same score in all answers – drop it", (name,))
    common = there.T.astype(np.float64) @ there
    if common.min() < 3:
        i, j = (int(at) for at in np.unravel_index(common.argmin(), common.shape))
        pair = (names[i], names[j])
        raise TooFewRows(
            f"{' and '.join(pair)}: {int(common.min())} answers in common – their covariance is not told; drop one",
            pair,
        )


def _inverses(there: NDArray[np.bool_], sigma: NDArray[np.float64]):
    """Of each pattern Σ⁻¹ of the items it has, in its place among zeros (K, p, p), and ln det Σ (K,)."""
    both = there[:, :, None] & there[:, None, :]
    parts = np.where(both, sigma, 0.0) + (~there)[:, :, None] * np.eye(len(sigma))
    try:
        roots = np.linalg.cholesky(parts)
    except np.linalg.LinAlgError:
        return None
    logarithms = 2.0 * np.log(np.diagonal(roots, axis1=1, axis2=2)).sum(axis=1)
    inverses = np.where(both, np.linalg.inv(parts), 0.0)
    return inverses, logarithms


def misfit_of(
    seen: Patterns, mean: NDArray[np.float64], sigma: NDArray[np.float64]
) -> tuple[float, NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """−2 ln L / n without its constant; its slope by Σ (p, p) and by the mean (p,); Σ⁻¹ by pattern (K, p, p).

    Infinite where Σ is no covariance matrix.
    """
    found = _inverses(seen.there, sigma)
    if found is None:
        nothing = np.zeros_like(sigma)
        return np.inf, nothing, np.zeros(len(sigma)), nothing[None]
    inverses, logarithms = found
    share, (apart, about) = seen.share, seen.around(mean)
    part = inverses @ about
    value = float(share @ (logarithms + np.trace(part, axis1=1, axis2=2)))
    by_sigma = np.tensordot(share, inverses - part @ inverses, axes=1)
    by_mean = -2.0 * np.einsum("k,kij,kj->i", share, inverses, apart)
    return value, by_sigma, by_mean, inverses


def saturated(
    seen: Patterns, names: Sequence[str], progress: Callable[[str], object] | None = None
) -> Saturated:
    """Mean and covariance of greatest likelihood, by EM where there are gaps (Dempster, Laird and Rubin 1977).

    progress: called with what is done next. Raises DependentItems, NotConverged.
    """
    if seen.whole:
        mean, sigma = seen.mean[0], seen.covariance[0]
    else:
        mean, sigma = _expected(seen, progress or (lambda _: None))
    spread = np.sqrt(np.diag(sigma))
    r = sigma / np.outer(spread, spread)
    if np.linalg.eigvalsh(r)[0] < DEPENDENT:
        tied = [name for name, flag in zip(names, dependent_columns(r), strict=True) if flag]
        raise DependentItems(f"{', '.join(tied)}: one follows exactly from the others – drop one", tied)
    return Saturated(mean, sigma, misfit_of(seen, mean, sigma)[0])


def _expected(
    seen: Patterns, progress: Callable[[str], object]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    share = seen.share
    weight = share[:, None] * seen.there
    mean = (weight * seen.mean).sum(axis=0) / weight.sum(axis=0)
    apart = np.where(seen.there, seen.mean - mean, 0.0)
    variance = np.diagonal(seen.covariance, axis1=1, axis2=2) + apart**2
    sigma = np.diag((weight * variance).sum(axis=0) / weight.sum(axis=0))
    scale = np.sqrt(np.diag(sigma))
    for done in range(ROUNDS):
        progress(f"EM, round {done + 1}")
        value, by_sigma, by_mean, _ = misfit_of(seen, mean, sigma)
        if not np.isfinite(value):
            break
        # What is expected of the gaps moves Σ against the misfit's slope, turned by Σ itself on either side.
        shift = -0.5 * sigma @ by_mean
        change = -sigma @ by_sigma @ sigma - np.outer(shift, shift)
        moved = max(np.abs(shift / scale).max(), np.abs(change / np.outer(scale, scale)).max())
        mean, sigma = mean + shift, sigma + (change + change.T) / 2.0
        if moved < REST:
            return mean, sigma
    raise NotConverged("the covariances of answers with gaps do not come to rest – leave those answers out")


def correlate_likely(table: NDArray[np.float64], names: Sequence[str]) -> Correlation:
    """Of scores (n, p), NaN missing: the correlations of one normal distribution that all scores make likeliest.

    Right where gaps depend on nothing but what was answered. There is no honest single n for such a matrix; counts are
    the answers that have both items of a pair, so that tests err on the careful side.
    Raises what `patterns_of` and `saturated` raise.
    """
    seen = patterns_of(table, names)
    sigma = saturated(seen, names).covariance
    spread = np.sqrt(np.diag(sigma))
    r = np.clip(sigma / np.outer(spread, spread), -1.0, 1.0)
    np.fill_diagonal(r, 1.0)
    there = (~np.isnan(table)).astype(np.int64)
    counts = there.T @ there
    return Correlation(r, two_tailed(r, counts), counts)
