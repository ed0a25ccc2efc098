"""Percentile intervals from resampled answers (Efron 1979): means, α, eigenvalues and loadings.

No resampled table is ever made. A resample says how often each answer is drawn, and all figures follow from the sums of
the scores and of their products, weighted by these counts: for many resamples at once one matrix product. The counts
are drawn block by block of answers, first how many fall into each block, then which of its answers: the distribution
is that of drawing from all answers exactly, and a block's counts and products stay in the cache.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.analysis.components.extraction import Components

__all__ = ["Bootstrap", "bootstrap"]

BATCH = 4_000_000  # scores resampled at once, where the answers are few
RESAMPLES = 250  # at least so many at once: fewer make the products of the scores anew too often
BLOCK = 4096  # answers at once
SINGLE = 2.0**24  # whole numbers below it are exact in single precision
STILL = 1e-12  # a variance that counts as none
CELLS = 2_000_000  # numbers of one block: counts, or products of scores


@dataclass(frozen=True)
class Bootstrap:
    """Intervals that hold `level` of the resampled figures, as (2, …) low and high.

    means: (2, p) NaN for an item that is never answered; alpha: (2,) or None; eigenvalues: (2, p) or None;
    loadings: (2, p, k) or None. kaiser: share of the samples, (p + 1,), with 0, 1, … eigenvalues above 1.
    used: samples in which every item varied, the others say nothing on α, eigenvalues and loadings.
    """

    draws: int
    used: int
    level: float
    means: NDArray[np.float64]
    alpha: NDArray[np.float64] | None
    eigenvalues: NDArray[np.float64] | None
    loadings: NDArray[np.float64] | None
    kaiser: NDArray[np.float64] | None


def bootstrap(
    table: NDArray[np.float64],
    factored: NDArray[np.bool_],
    components: Components | None,
    rng: np.random.Generator,
    *,
    draws: int = 1000,
    level: float = 0.95,
    progress: Callable[[int], object] | None = None,
) -> Bootstrap:
    """Resample the rows of a table (n, p) with replacement.

    The means rest on every score that is there, as those that they are intervals of. factored: (p,) the items of α
    and the components, which rest on the rows without a gap (NaN) among these. Each sample's loadings are turned
    towards `components`' by Procrustes, orthogonal or oblique as they are (Milan and Whittaker 1995), since neither
    order nor sign nor turn is comparable otherwise.
    """
    means, alphas, values, loadings, used = [], [], [], [], 0
    there = np.isfinite(table)
    whole = there[:, factored].all(axis=1)
    complete = table[whole][:, factored]
    related = len(complete) > 1 and complete.shape[1] > 1
    # Without a gap one resample serves both; with gaps the whole answers are resampled for themselves.
    together = related and bool(there.all())
    for size in _batches(draws, table):
        covariance = None
        if together:
            found, covariance = _moments(table, size, rng)
            means.append(found)
            covariance = covariance[:, factored][:, :, factored]
        else:
            means.append(_means(table, there, size, rng))
            if related:
                covariance = _moments(complete, size, rng)[1]
        if covariance is not None:
            good = (np.diagonal(covariance, axis1=1, axis2=2) > STILL).all(axis=1)
            used += int(good.sum())
            covariance = covariance[good]
            alphas.append(_alphas(covariance))
            if components is not None:
                one_values, one_loadings = _loadings(covariance, components)
                values.append(one_values)
                loadings.append(one_loadings)
        if progress is not None:
            progress(size)
    edges = [(1.0 - level) / 2.0, (1.0 + level) / 2.0]
    return Bootstrap(
        draws, used, level, _quantiles(np.concatenate(means), edges), _stacked(alphas, edges), _stacked(values, edges),
        _stacked(loadings, edges), _kaiser(values),
    )  # fmt: skip


def _means(
    table: NDArray[np.float64], there: NDArray[np.bool_], draws: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """(draws, p); NaN where none of the drawn answers has the item."""
    p = table.shape[1]

    def columns(rows: slice) -> NDArray[np.float64]:
        return np.hstack([there[rows].astype(np.float64), np.where(there[rows], table[rows], 0.0)])

    sums = _sums(columns, 2 * p, _largest(np.where(there, table, 1.0)), len(table), draws, rng)
    answered, total = sums[:, :p], sums[:, p:]
    return np.where(answered > 0, total / np.maximum(answered, 1), np.nan)


def _moments(
    table: NDArray[np.float64], draws: int, rng: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Means (draws, p) and covariances (draws, p, p) of resampled complete scores (n, p)."""
    n, p = table.shape
    # Centred, so that the square of a mean takes no digits from a variance; whole scores stay whole.
    middle = table.mean(axis=0)
    if np.isfinite(_largest(table)):
        middle = np.rint(middle)
    centred = table - middle
    first, second = np.triu_indices(p)

    def columns(rows: slice) -> NDArray[np.float64]:
        some = centred[rows]
        return np.hstack([some, some[:, first] * some[:, second]])

    largest = _largest(centred)
    sums = _sums(columns, p + len(first), max(largest, largest**2), n, draws, rng)
    shift, square = sums[:, :p] / n, sums[:, p:] / n
    shared = square - shift[:, first] * shift[:, second]
    # What is left of an item that stands still is the rounding of its squares.
    shared[:, first == second] *= shared[:, first == second] > STILL * square[:, first == second]
    both = np.zeros((p, p), dtype=np.int64)
    both[first, second] = both[second, first] = np.arange(len(first))
    return middle + shift, shared[:, both] * (n / (n - 1))


def _sums(
    columns: Callable[[slice], NDArray[np.float64]],
    width: int,
    largest: float,
    n: int,
    draws: int,
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """(draws, width) sums of `columns` (rows → (rows, width)) over n answers drawn from n with replacement.

    largest: see `_largest`, of the columns. Whole numbers are added in single precision where that is exact.
    """
    step = max(1, min(BLOCK, CELLS // max(draws, width)))
    starts = range(0, n, step)
    lengths = np.array([min(step, n - start) for start in starts])
    shares = rng.multinomial(n, lengths / n, size=draws)
    sums = np.zeros((draws, width))
    for start, length, share in zip(starts, lengths, shares.T, strict=True):
        precision = np.float32 if largest * share.max() < SINGLE else np.float64
        weights = _counts(share, length, rng).astype(precision)
        sums += weights @ columns(slice(start, start + length)).astype(precision, copy=False)
    return sums


def _largest(table: NDArray[np.float64]) -> float:
    """The largest absolute value; infinite where not all are whole numbers."""
    return float(np.abs(table).max()) if (table == np.rint(table)).all() else np.inf


def _counts(share: NDArray[np.int64], length: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """(draws, length) how often each answer of a block is drawn, `share` (draws,) answers in each resample."""
    draws = len(share)
    cell = np.repeat(np.arange(draws) * length, share)
    cell += rng.integers(0, length, size=len(cell), dtype=np.uint16)
    return np.bincount(cell, minlength=draws * length).reshape(draws, length)


def _alphas(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    parts, total, p = np.trace(covariance, axis1=1, axis2=2), covariance.sum(axis=(1, 2)), covariance.shape[1]
    varied = total > 1e-12 * parts
    return p / (p - 1) * (1.0 - parts[varied] / total[varied])


def _loadings(
    covariance: NDArray[np.float64], target: Components
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    deviation = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    values, vectors = np.linalg.eigh(covariance / (deviation[:, :, None] * deviation[:, None, :]))
    values, vectors = values[:, ::-1], vectors[:, :, ::-1]
    drawn = vectors[:, :, : target.kept] * np.sqrt(np.maximum(values[:, None, : target.kept], 0.0))
    across = drawn.transpose(0, 2, 1) @ target.loadings
    if target.rotation != "oblimin":
        left, _, right = np.linalg.svd(across)
        return values, drawn @ (left @ right)
    # Oblique: least squares towards the pattern, then components scaled to variance 1.
    turn = np.linalg.pinv(drawn.transpose(0, 2, 1) @ drawn) @ across
    variance = np.diagonal(np.linalg.pinv(turn.transpose(0, 2, 1) @ turn), axis1=1, axis2=2)
    return values, drawn @ turn * np.sqrt(variance)[:, None, :]


def _kaiser(values: list[NDArray[np.float64]]) -> NDArray[np.float64] | None:
    if not values or not sum(map(len, values)):
        return None
    drawn = np.concatenate(values)
    counts = (drawn > 1.0 + 1e-12).sum(axis=1)
    return np.bincount(counts, minlength=drawn.shape[1] + 1) / len(drawn)


def _stacked(parts: list[NDArray[np.float64]], edges: list[float]) -> NDArray[np.float64] | None:
    return _quantiles(np.concatenate(parts), edges) if parts and sum(map(len, parts)) else None


def _quantiles(drawn: NDArray[np.float64], edges: list[float]) -> NDArray[np.float64]:
    there = np.isfinite(drawn)
    if there.all():
        return np.quantile(drawn, edges, axis=0)
    columns = [
        np.quantile(column[fine], edges) if fine.any() else np.full(2, np.nan)
        for column, fine in zip(drawn.T, there.T, strict=True)
    ]
    return np.array(columns).T


def _batches(draws: int, table: NDArray[np.float64]) -> list[int]:
    most = max(RESAMPLES, BATCH // max(table.size, table.shape[1] ** 2, 1))
    return [min(most, draws - done) for done in range(0, draws, most)]
