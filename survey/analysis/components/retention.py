"""How many components to keep: Horn's parallel analysis and Velicer's MAP, beside Kaiser's criterion.

The parallel draws need no table of n rows: the scatter matrix of n independent normal rows is Wishart, and
Bartlett's decomposition draws its triangular root from p χ² and p (p − 1) / 2 normal numbers (Bartlett 1933). So
10⁵ answers cost what 20 do, and the distribution is that of simulated tables exactly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.analysis.components.extraction import eigenvalues
from survey.analysis.errors import TooFewRows

__all__ = ["Average", "Parallel", "minimum_average_partial", "parallel_analysis", "random_correlations"]

BATCH = 2_000_000  # numbers drawn at once


@dataclass(frozen=True)
class Parallel:
    """Eigenvalues that chance reaches: mean and upper, (p,), the `level` quantile of `draws` random samples.

    kept: eigenvalues above `upper` before the first that is not. factors_…: the same with squared multiple
    correlations on the diagonal (common factors instead of components); None where the matrix has no inverse.
    """

    draws: int
    level: float
    mean: NDArray[np.float64]
    upper: NDArray[np.float64]
    kept: int
    factors: NDArray[np.float64] | None
    factors_upper: NDArray[np.float64]
    factors_kept: int | None


@dataclass(frozen=True)
class Average:
    """squared, fourth: (p − 1,) average power of the partial correlations after 0, 1, … components; kept: least."""

    squared: NDArray[np.float64]
    fourth: NDArray[np.float64]
    kept: int
    kept_fourth: int


def parallel_analysis(
    r: NDArray[np.float64], n: int, rng: np.random.Generator, *, draws: int = 1000, level: float = 0.95
) -> Parallel:
    """Horn (1965), with the quantile of Glorfeld (1995), of correlations (p, p) from n answers.

    Raises TooFewRows when n ≤ p.
    """
    p = len(r)
    if n <= p:
        raise TooFewRows(f"{n} answers for {p} items – parallel analysis needs more answers than items")
    chance, reduced = [], []
    for size in _batches(draws, p):
        drawn = random_correlations(n, p, size, rng)
        chance.append(np.linalg.eigvalsh(drawn)[:, ::-1])
        reduced.append(np.linalg.eigvalsh(_with_squared_multiples(drawn))[:, ::-1])
    all_values, all_reduced = np.concatenate(chance), np.concatenate(reduced)
    upper = np.quantile(all_values, level, axis=0)
    factors_upper = np.quantile(all_reduced, level, axis=0)
    values = eigenvalues(r)
    factors = None
    if values[-1] > 1e-10:
        factors = eigenvalues(_with_squared_multiples(r[None])[0])
    return Parallel(
        draws, level, all_values.mean(axis=0), upper, _leading(values > upper), factors, factors_upper,
        None if factors is None else _leading(factors > factors_upper),
    )  # fmt: skip


def random_correlations(n: int, p: int, draws: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """(draws, p, p) sample correlations of n answers to p unrelated normal items, n > p."""
    root = np.tril(rng.normal(size=(draws, p, p)), -1)
    diagonal = np.arange(p)
    root[:, diagonal, diagonal] = np.sqrt(rng.chisquare(n - 1 - diagonal, size=(draws, p)))
    # Rows of the root scaled to length 1 give the correlations directly.
    root /= np.sqrt((root**2).sum(axis=2, keepdims=True))
    return root @ root.transpose(0, 2, 1)


def minimum_average_partial(r: NDArray[np.float64]) -> Average:
    """Velicer (1976), and with fourth powers Velicer, Eaton and Fava (2000), of correlations (p, p).

    Takes out one principal component after the other and averages what partial correlation is left. Stops before
    an item is used up.
    """
    p = len(r)
    values, vectors = np.linalg.eigh(r)
    loadings = (vectors * np.sqrt(np.maximum(values, 0.0)))[:, ::-1]
    left, squared, fourth = r.copy(), [], []
    outside = ~np.eye(p, dtype=bool)
    for count in range(p - 1):
        variance = np.diag(left)
        if (variance <= 1e-12).any():
            break
        partial = left / np.sqrt(np.outer(variance, variance))
        squared.append(float((partial[outside] ** 2).mean()))
        fourth.append(float((partial[outside] ** 4).mean()))
        left = left - np.outer(loadings[:, count], loadings[:, count])
    return Average(np.array(squared), np.array(fourth), int(np.argmin(squared)), int(np.argmin(fourth)))


def _with_squared_multiples(r: NDArray[np.float64]) -> NDArray[np.float64]:
    """(…, p, p) with 1 − 1 / (R⁻¹)_ii on the diagonal."""
    diagonal = np.arange(r.shape[-1])
    reduced = r.copy()
    reduced[:, diagonal, diagonal] = 1.0 - 1.0 / np.linalg.inv(r)[:, diagonal, diagonal]
    return reduced


def _leading(above: NDArray[np.bool_]) -> int:
    return int(np.argmin(np.append(above, False)))


def _batches(draws: int, p: int) -> list[int]:
    most = max(1, BATCH // p**2)
    return [min(most, draws - done) for done in range(0, draws, most)]
