"""McDonald's ω from one common factor by maximum likelihood (McDonald 1999), as SPSS and JASP report it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from survey.analysis.checks import require_independent
from survey.analysis.errors import NotConverged, TooFewItems, TooFewRows

__all__ = ["HEYWOOD", "Omega", "omega_of", "one_factor"]

HEYWOOD = 0.005  # least uniqueness of the fit, R's factanal's too


@dataclass(frozen=True)
class Omega:
    """omega = (Σ λ_i s_i)² / ((Σ λ_i s_i)² + Σ ψ_i s_i²), the share of the sum's variance that is common.

    loadings, uniqueness: (p,) of the one factor, of standardised items; s: the items' standard deviations.
    """

    omega: float
    loadings: NDArray[np.float64]
    uniqueness: NDArray[np.float64]


def omega_of(r: NDArray[np.float64], deviation: NDArray[np.float64], n: int, names: Sequence[str]) -> Omega:
    """ω of items with correlations (p, p) and standard deviations (p,), from n answers.

    Raises TooFewItems below three items, TooFewRows when n ≤ p, DependentItems, NotPositiveDefinite, NotConverged.
    """
    p = len(r)
    if p < 3:
        raise TooFewItems(f"{p} items – ω needs at least three to tell a common factor", names)
    if n <= p:
        raise TooFewRows(f"{n} answers for {p} items – ω needs more answers than items")
    require_independent(r, names)
    loadings, uniqueness = one_factor(r)
    common = float((loadings * deviation).sum()) ** 2
    own = float((uniqueness * deviation**2).sum())
    return Omega(common / (common + own), loadings, uniqueness)


def one_factor(r: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Loadings and uniquenesses (p,) of one maximum-likelihood factor of correlations (p, p).

    Jöreskog's (1967) function of the uniquenesses alone, minimised within [.005, 1]. Raises NotConverged.
    """
    inverse_diagonal = np.diag(np.linalg.inv(r))
    start = np.clip(0.5 / inverse_diagonal, HEYWOOD, 1.0)
    found = minimize(
        _misfit, start, args=(r,), jac=True, method="L-BFGS-B", bounds=[(HEYWOOD, 1.0)] * len(r),
        options={"ftol": 1e-15, "gtol": 1e-9, "maxiter": 2000, "maxcor": 20},
    )  # fmt: skip
    if not np.isfinite(found.fun):
        raise NotConverged("the one-factor fit behind ω does not come to rest – look for odd items")
    uniqueness = np.asarray(found.x, dtype=np.float64)
    value, vector = _largest(r, uniqueness)
    loadings = np.sqrt(uniqueness) * vector * np.sqrt(max(value - 1.0, 0.0))
    return loadings * (-1.0 if loadings.sum() < 0.0 else 1.0), uniqueness


def _largest(r: NDArray[np.float64], uniqueness: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
    scale = 1.0 / np.sqrt(uniqueness)
    values, vectors = np.linalg.eigh(r * np.outer(scale, scale))
    return float(values[-1]), vectors[:, -1]


def _misfit(uniqueness: NDArray[np.float64], r: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
    scale = 1.0 / np.sqrt(uniqueness)
    values, vectors = np.linalg.eigh(r * np.outer(scale, scale))
    rest = np.maximum(values[:-1], 1e-300)
    value = float((rest - np.log(rest)).sum()) - (len(r) - 1)
    loadings = np.sqrt(uniqueness) * vectors[:, -1] * np.sqrt(max(float(values[-1]) - 1.0, 0.0))
    return value, (loadings**2 + uniqueness - np.diag(r)) / uniqueness**2
