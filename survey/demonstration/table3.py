"""The paper's Table 3 and a population that has it: correlations with its loadings and the printed KMO and χ².

Nothing here uses `survey.analysis`, so the samples owe nothing to what they test.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, least_squares

__all__ = [
    "ALPHA",
    "CHI2",
    "CLOSE",
    "KMO",
    "N",
    "TABLE_3",
    "TABLE_3_ITEMS",
    "correlation_of_ten",
    "correlation_of_twelve",
    "deviations",
    "kmo_of",
]

# Rows and columns in the paper's order.
TABLE_3_ITEMS = (
    "fabric_texture", "fabric_colour", "fabric_lustre", "thickness_texture", "silhouette",
    "detail_structure", "pleat", "perspective", "dynamic_drape", "dynamic_swing",
)  # fmt: skip
TABLE_3 = np.array([
    [.937, .121, .025], [.918, .229, .239], [.854, .371, -.018], [.872, .144, .304], [.197, .813, .293],
    [.274, .852, .069], [.396, .859, .177], [.243, .764, .404], [.236, .112, .891], [.059, .301, .817],
])  # fmt: skip
# The two items that the paper drops, each with its twin and their correlation.
CLOSE = (("static_overall", "silhouette", 0.968), ("static_drape", "dynamic_drape", 0.930))
N, KMO, CHI2, ALPHA = 20, 0.824, 167.23, 0.911


def kmo_of(r: NDArray[np.float64]) -> float:
    """Overall KMO of a correlation matrix (p, p)."""
    inverse = np.linalg.inv(r)
    partial = inverse / np.sqrt(np.outer(np.diag(inverse), np.diag(inverse)))
    off = ~np.eye(len(r), dtype=bool)
    return float((r[off] ** 2).sum() / ((r[off] ** 2).sum() + (partial[off] ** 2).sum()))


@lru_cache(maxsize=1)
def correlation_of_ten() -> NDArray[np.float64]:
    """R (10, 10) with Table 3's loadings as its first three components' space, and the printed KMO and χ².

    R = ΛΛᵀ + Q L Lᵀ Qᵀ with Q a basis of Λ's orthogonal complement and L lower triangular (28 numbers), solved
    for a unit diagonal, KMO and determinant from a seeded start. Raises ArithmeticError where that fails.
    """
    p = len(TABLE_3)
    basis = np.linalg.svd(TABLE_3)[0][:, 3:]
    lower = np.tril_indices(p - 3)
    log_det = -CHI2 / (N - 1 - (2 * p + 5) / 6)

    def matrix(numbers: NDArray[np.float64]) -> NDArray[np.float64]:
        root = np.zeros((p - 3, p - 3))
        root[lower] = numbers
        return TABLE_3 @ TABLE_3.T + basis @ root @ root.T @ basis.T

    def misfit(numbers: NDArray[np.float64]) -> list[float]:
        r = matrix(numbers)
        return [*(np.diag(r) - 1.0), kmo_of(r) - KMO, np.linalg.slogdet(r)[1] - log_det]

    start = np.random.default_rng(7).normal(scale=0.3, size=len(lower[0]))
    start[lower[0] == lower[1]] = 0.45
    found = least_squares(misfit, start, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=4000)
    if found.cost > 1e-20:
        raise ArithmeticError(f"no such correlation matrix: residual {found.cost:.3g}")
    r = matrix(found.x)
    np.fill_diagonal(r, 1.0)
    return r


def correlation_of_twelve() -> NDArray[np.float64]:
    """R (12, 12): the ten, and the two static items, each close to its twin and to the others through it alone."""
    p = len(TABLE_3)
    r = np.eye(p + 2)
    r[:p, :p] = correlation_of_ten()
    for row, (_, twin, close) in enumerate(CLOSE, start=p):
        r[row, :row] = close * r[TABLE_3_ITEMS.index(twin), :row]
        r[:row, row] = r[row, :row]
    return r


def deviations() -> NDArray[np.float64]:
    """Standard deviations (12,) around 1 that bring the raw α of the ten items to the printed .911."""
    r, p = correlation_of_ten(), len(TABLE_3)
    tilt = np.linspace(-1.0, 1.0, p)[np.random.default_rng(3).permutation(p)]

    def excess(size: float) -> float:
        sd = np.exp(size * tilt)
        c = r * np.outer(sd, sd)
        return float(p / (p - 1) * (1 - np.trace(c) / c.sum()) - ALPHA)

    size = brentq(excess, 0.0, 2.0)
    return np.concatenate([np.exp(float(size) * tilt), [1.0, 1.0]])  # type: ignore[arg-type]
