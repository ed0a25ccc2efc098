"""Percentile intervals from resampled answers (Efron 1979): means, α, eigenvalues and loadings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.analysis.components import Components

__all__ = ["Bootstrap", "bootstrap"]

BATCH = 4_000_000  # scores resampled at once


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
    n = len(table)
    means, alphas, values, loadings, used = [], [], [], [], 0
    whole = np.isfinite(table[:, factored]).all(axis=1)
    complete = table[whole][:, factored]
    for size in _batches(draws, table):
        rows = rng.integers(0, n, size=(size, n))
        means.append(_means(table, rows))
        if len(complete) > 1 and complete.shape[1] > 1:
            if len(complete) < n:
                rows = rng.integers(0, len(complete), size=(size, len(complete)))
            covariance = _covariances(complete, rows)
            good = (np.diagonal(covariance, axis1=1, axis2=2) > 1e-12).all(axis=1)
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


def _means(table: NDArray[np.float64], rows: NDArray[np.int64]) -> NDArray[np.float64]:
    """(draws, p) from how often each answer was drawn; NaN where none of the drawn ones has the item."""
    n = len(table)
    # One histogram over all samples: sample × answer → how often.
    flat = (rows + n * np.arange(len(rows))[:, None]).ravel()
    weight = np.bincount(flat, minlength=n * len(rows)).reshape(len(rows), n).astype(np.float64)
    there = np.isfinite(table)
    answered = weight @ there
    total = weight @ np.where(there, table, 0.0)
    return np.where(answered > 0, total / np.maximum(answered, 1), np.nan)


def _covariances(table: NDArray[np.float64], rows: NDArray[np.int64]) -> NDArray[np.float64]:
    sample = (table - table.mean(axis=0))[rows]
    sample -= sample.mean(axis=1, keepdims=True)
    return sample.transpose(0, 2, 1) @ sample / (len(table) - 1)


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
    most = max(1, BATCH // max(table.size, 1))
    return [min(most, draws - done) for done in range(0, draws, most)]
