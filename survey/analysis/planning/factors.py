"""How often a factor analysis of n answers finds what the population holds: by drawing from it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.analysis.components import adequacy_of, eigenvalues, kaiser_count
from survey.analysis.correlation import correlate
from survey.analysis.errors import AnalysisError, OutOfReach

__all__ = ["Recovery", "factor_recovery"]

QUANTILES = (0.05, 0.5, 0.95)


@dataclass(frozen=True)
class Recovery:
    """Of `draws` samples of n answers, `used` of which could be analysed.

    found: share in which Kaiser keeps as many components as the population has. kmo: 5, 50 and 95 % of the samples.
    error: root mean square difference of the loadings from the population's, turned to it, 50 and 95 %.
    """

    n: int
    draws: int
    used: int
    found: float
    kmo: tuple[float, float, float]
    error: tuple[float, float]


def factor_recovery(
    loadings: NDArray[np.float64],
    draw: Callable[[int, np.random.Generator], NDArray[np.float64]],
    n: int,
    *,
    draws: int = 400,
    seed: int = 0,
    progress: Callable[[int], object] | None = None,
) -> Recovery:
    """Samples of n answers from `draw` (n, generator) → (n, p) against the population's loadings (p, k).

    The same seed gives the same samples. progress: called with the number of samples just analysed.
    Raises OutOfReach when n ≤ p or where no sample can be analysed.
    """
    p, k = loadings.shape
    if n <= p:
        raise OutOfReach(f"{n} answers for {p} items – a factor analysis needs more answers than items")
    rng = np.random.default_rng([seed, n])
    found, kmo, error = [], [], []
    for _ in range(draws):
        table = draw(n, rng)
        try:
            r = correlate(table).r
            kmo.append(adequacy_of(r, n, [str(at) for at in range(p)]).kmo)
        except AnalysisError:  # an item without variance, or one that follows from others
            pass
        else:
            found.append(kaiser_count(eigenvalues(r)) == k)
            error.append(_apart(r, loadings))
        if progress is not None:
            progress(1)
    if not found:
        raise OutOfReach(f"none of {draws} samples of {n} answers could be analysed – plan for more")
    share = float(np.mean(found))
    return Recovery(n, draws, len(found), share, _quantiles(kmo), _quantiles(error)[1:])


def _quantiles(values: list[float]) -> tuple[float, float, float]:
    low, middle, high = np.quantile(values, QUANTILES)
    return float(low), float(middle), float(high)


def _apart(r: NDArray[np.float64], loadings: NDArray[np.float64]) -> float:
    """Root mean square of the first k components' loadings less the population's, after Procrustes' rotation."""
    values, vectors = np.linalg.eigh(r)
    k = loadings.shape[1]
    own = vectors[:, -k:] * np.sqrt(values[-k:])
    left, _, right = np.linalg.svd(own.T @ loadings)
    return float(np.sqrt(((own @ left @ right - loadings) ** 2).mean()))
