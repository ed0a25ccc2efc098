"""Polychoric correlations: the correlation of the normal variables behind two ordered scales (Olsson 1979).

Two steps: thresholds from each item's own frequencies, then for each pair the ρ of greatest likelihood. Empty cells
stay empty (psych's correct = 0). All pairs are solved together, so 25 items take a fraction of a second.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr, ndtri

from survey.analysis.checks import finite_scores, require_varying
from survey.analysis.correlation.pearson import Correlation, two_tailed
from survey.analysis.errors import TooManyScores

__all__ = ["CATEGORIES", "Ordered", "binormal", "density", "ordered", "polychoric", "solved_tables"]

CATEGORIES = 10  # more than these is no scale of answers
LIMIT = 0.9995  # |ρ| where the search ends; a perfect table has no maximum within
NODES, WEIGHTS = np.polynomial.legendre.leggauss(64)
INFINITY = 40.0  # [standard deviations], beyond the reach of a float64 tail


@dataclass(frozen=True)
class Ordered:
    """Complete scores as categories. codes (n, p) from 0 on; levels: the scores behind them, by item.

    cuts: (p, c + 1) thresholds between ±INFINITY, +INFINITY where an item has fewer categories than the most, c.
    counts: (m, c, c) of each pair in the order of np.tril_indices(p, -1).
    """

    codes: NDArray[np.int64]
    levels: tuple[NDArray[np.float64], ...]
    cuts: NDArray[np.float64]
    counts: NDArray[np.float64]


def polychoric(scores: ArrayLike, items: Sequence[str] | None = None) -> Correlation:
    """Matrix of complete scores (n, p) of a few categories each; p-values as those of Pearson's r, an approximation.

    The matrix need not be positive definite. Raises TooManyScores for an item with more than ten categories and
    what `correlate` raises.
    """
    found = ordered(scores, items)
    n, p = found.codes.shape
    rows, cols = np.tril_indices(p, -1)
    r = np.eye(p)
    r[rows, cols] = r[cols, rows] = solved_tables(found.counts, found.cuts[rows], found.cuts[cols])
    answers = np.full((p, p), n, dtype=np.int64)
    return Correlation(r, two_tailed(r, answers), answers)


def ordered(scores: ArrayLike, items: Sequence[str] | None = None) -> Ordered:
    """Categories of complete scores (n, p), their thresholds, the tables of all pairs. Raises as `polychoric`."""
    table, names = finite_scores(scores, items, rows=3)
    require_varying(table, names)
    codes, levels, thresholds = [], [], []
    for name, column in zip(names, table.T, strict=True):
        own, code = np.unique(column, return_inverse=True)
        if len(own) > CATEGORIES:
            raise TooManyScores(
                f"{name}: {len(own)} different scores – polychoric correlation takes up to {CATEGORIES};"
                " use Pearson's",
                (name,),
            )
        codes.append(code)
        levels.append(own)
        thresholds.append(ndtri(np.cumsum(np.bincount(code))[:-1] / len(table)))
    p = table.shape[1]
    most = max(len(own) for own in levels)
    rows, cols = np.tril_indices(p, -1)
    counts = np.zeros((len(rows), most, most))
    for pair, (i, j) in enumerate(zip(rows, cols, strict=True)):
        cells = np.bincount(codes[i] * most + codes[j], minlength=most * most)
        counts[pair] = cells.reshape(most, most)
    cuts = np.full((p, most + 1), INFINITY)
    cuts[:, 0] = -INFINITY
    for item, own in enumerate(thresholds):
        cuts[item, 1 : len(own) + 1] = own
    return Ordered(np.array(codes).T, tuple(levels), cuts, counts)


def binormal(h: NDArray[np.float64], k: NDArray[np.float64], rho: NDArray[np.float64]) -> NDArray[np.float64]:
    """P(X ≤ h, Y ≤ k) of a standard normal pair with correlation rho, |rho| < 1; shapes broadcast.

    Φ(h) Φ(k) + 1/2π ∫ exp(−(h² + k² − 2hk sin θ) / 2cos²θ) dθ from 0 to asin ρ, by Gauss–Legendre.
    """
    end = np.arcsin(rho)[..., None]
    angle = 0.5 * end * (NODES + 1.0)
    h, k = h[..., None], k[..., None]
    cosine = np.cos(angle)
    # (h − k)² + 2hk (1 − sin θ), the second term over cos²θ rewritten so that nothing cancels near ±π/2.
    exponent = -(((h - k) / cosine) ** 2) / 2.0 - h * k / (1.0 + np.sin(angle))
    area = (np.exp(exponent) * WEIGHTS).sum(axis=-1) * 0.5 * end[..., 0] / (2.0 * np.pi)
    return ndtr(h[..., 0]) * ndtr(k[..., 0]) + area


def density(h: NDArray[np.float64], k: NDArray[np.float64], rho: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of a standard normal pair with correlation rho at (h, k); shapes broadcast."""
    rest = 1.0 - rho**2
    return np.exp(-(h**2 + k**2 - 2.0 * rho * h * k) / (2.0 * rest)) / (2.0 * np.pi * np.sqrt(rest))


def solved_tables(
    counts: NDArray[np.float64], across: NDArray[np.float64], down: NDArray[np.float64]
) -> NDArray[np.float64]:
    """ρ (m,) of greatest likelihood of m tables; the slope falls from + to −, so its zero is bracketed and halved."""
    low, high = np.full(len(counts), -LIMIT), np.full(len(counts), LIMIT)
    rho = np.zeros(len(counts))
    for _ in range(60):
        slope, curvature = _slope(counts, across, down, rho)
        low, high = np.where(slope > 0.0, rho, low), np.where(slope > 0.0, high, rho)
        newton = rho + slope / curvature
        inside = (newton > low) & (newton < high)
        after = np.where(inside, newton, (low + high) / 2.0)
        if np.abs(after - rho).max(initial=0.0) < 1e-12:
            return after
        rho = after
    return rho


def _slope(
    counts: NDArray[np.float64],
    across: NDArray[np.float64],
    down: NDArray[np.float64],
    rho: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Derivative of the log-likelihood by ρ, and its expected negative second derivative (m,)."""
    h, k, at = across[:, :, None], down[:, None, :], rho[:, None, None]
    h, k, at = np.broadcast_arrays(h, k, at)
    cells = _cells(binormal(h, k, at))
    rise = _cells(density(h, k, at))
    probable = np.maximum(cells, 1e-300)
    slope = np.where(counts > 0, counts * rise / probable, 0.0).sum(axis=(1, 2))
    total = counts.sum(axis=(1, 2))
    information = np.where(cells > 1e-14, rise**2 / probable, 0.0).sum(axis=(1, 2))
    return slope, np.maximum(total * information, 1e-12)


def _cells(corner: NDArray[np.float64]) -> NDArray[np.float64]:
    """(m, c + 1, c + 1) values at corners → (m, c, c) of the cells between them."""
    return np.diff(np.diff(corner, axis=1), axis=2)
