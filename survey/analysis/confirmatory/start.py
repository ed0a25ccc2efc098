"""Where a fit begins: each factor's first component among its own items, and how these components are correlated."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from survey.analysis.confirmatory.covariance_structure import Structure

__all__ = ["start_of"]

MOST = 0.85  # of a correlation of two factors at the start


def start_of(unit: Structure, r: NDArray[np.float64]) -> NDArray[np.float64]:
    """θ (q,) in "unit" metric of items with correlations r (p, p)."""
    p, k = len(r), len(unit.model.factors)
    weights, loads = np.zeros((p, k)), np.zeros((p, k))
    for factor in range(k):
        own = [row for row, col in unit.loadings if col == factor]
        values, vectors = np.linalg.eigh(r[np.ix_(own, own)])
        leading = vectors[:, -1] * (1.0 if vectors[:, -1].sum() >= 0.0 else -1.0)
        weights[own, factor] = leading
        # What a component holds beside the common part would make every item look better than it is.
        share = np.sqrt(max((values[-1] - 1.0) / max(len(own) - 1, 1), 0.05))
        loads[own, factor] = np.clip(leading * np.sqrt(len(own)) * share, -0.9, 0.9)
    across = weights.T @ r @ weights
    spread = np.sqrt(np.diag(across))
    factors = np.clip(across / np.outer(spread, spread), -MOST, MOST)
    common = loads**2 @ np.ones(k)
    rest = np.diag(np.clip(1.0 - common, 0.2, 1.0))
    return unit.parameters(loads, factors, rest)
