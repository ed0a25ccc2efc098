"""What freeing one more parameter would take off χ²: Lagrange multipliers (Sörbom 1989). Hints, no advice."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from survey.analysis.confirmatory.covariance_structure import Structure
from survey.analysis.confirmatory.fisher_scoring import solved

__all__ = ["MOST", "Hint", "Information", "hints_of"]

# ∂Σ (q, p, p) by some parameters → their expected second derivative of the misfit (q, q).
Information = Callable[[NDArray[np.float64]], NDArray[np.float64]]
MOST = 40  # items, beyond which the candidates are too many to be looked through


@dataclass(frozen=True)
class Hint:
    """`left op right` (F =~ item, item ~~ item): χ² would fall by about chi2, the parameter become about value."""

    left: str
    op: str
    right: str
    chi2: float
    value: float


def hints_of(
    structure: Structure,
    theta: NDArray[np.float64],
    slope: NDArray[np.float64],
    information: Information,
    n: int,
) -> tuple[Hint, ...]:
    """Every parameter that the model leaves out, by what it would take off, most first. slope: (p, p) by Σ."""
    items, names = structure.items, structure.model.names
    p = len(items)
    if p > MOST:
        return ()
    taken = {*structure.loadings, *structure.fixed}
    loadings = tuple((row, col) for col in range(len(names)) for row in range(p) if (row, col) not in taken)
    tied = {frozenset(cell) for cell in structure.residuals}
    residuals = tuple(pair for pair in combinations(range(p), 2) if frozenset(pair) not in tied)
    loads, spread, _ = structure.matrices(theta)
    more = structure.slopes_at(loads, spread, loadings, (), residuals)
    q = structure.size
    whole = information(np.concatenate([structure.slopes(theta), more]))
    across = whole[:q, q:]
    left = np.diag(whole)[q:] - (across * solved(whole[:q, :q], across)).sum(axis=0)
    steep = np.einsum("cij,ij->c", more, slope)
    told = left > 1e-8 * np.diag(whole)[q:]  # others only repeat what is free already
    safe = np.where(told, left, 1.0)
    gain, value = n / 2.0 * steep**2 / safe, -steep / safe
    labels = [(names[col], "=~", items[row]) for row, col in loadings]
    labels += [(items[row], "~~", items[col]) for row, col in residuals]
    order = sorted(np.flatnonzero(told), key=lambda at: -gain[at])
    return tuple(Hint(*labels[at], float(gain[at]), float(value[at])) for at in order)
