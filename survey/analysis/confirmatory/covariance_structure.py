"""What a measurement model implies: Σ = Λ Φ Λᵀ + Θ as a function of its free parameters, its derivatives, and a start.

A fit starts from each factor's first component among its own items, and from how these components are correlated.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from survey.analysis.confirmatory.measurement_model import Measurement

__all__ = ["Metric", "Structure", "start_of", "structure_of"]

Metric = Literal["marker", "unit"]
START_MOST = 0.85  # of a correlation of two factors at the start

Cells = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Structure:
    """Which cells of Λ (p, k), Φ (k, k) and Θ (p, p) are free, in the order of the parameters θ (q,).

    metric: "marker" fixes each factor's first loading to 1, "unit" its variance. Of ordinal items the variances of Θ
    are no parameters: they fill Σ's diagonal up to 1.
    """

    model: Measurement
    items: tuple[str, ...]
    loadings: Cells
    factors: Cells
    residuals: Cells
    fixed: Cells
    ordinal: bool

    @property
    def size(self) -> int:
        return len(self.loadings) + len(self.factors) + len(self.residuals)

    @property
    def metric(self) -> Metric:
        return "marker" if self.fixed else "unit"

    def matrices(self, theta: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Λ, Φ, Θ of parameters θ (q,), real or complex."""
        p, k = len(self.items), len(self.model.factors)
        loads = np.zeros((p, k), dtype=theta.dtype)
        spread = np.zeros((k, k), dtype=theta.dtype)
        own = np.zeros((p, p), dtype=theta.dtype)
        if self.metric == "unit":
            np.fill_diagonal(spread, 1.0)
        for cell in self.fixed:
            loads[cell] = 1.0
        first, second = len(self.loadings), len(self.loadings) + len(self.factors)
        for cell, value in zip(self.loadings, theta[:first], strict=True):
            loads[cell] = value
        for matrix, cells, values in (
            (spread, self.factors, theta[first:second]),
            (own, self.residuals, theta[second:]),
        ):
            for (row, col), value in zip(cells, values, strict=True):
                matrix[row, col] = matrix[col, row] = value
        if self.ordinal:
            np.fill_diagonal(own, 1.0 - np.diag(loads @ spread @ loads.T))
        return loads, spread, own

    def parameters(self, loads: NDArray, spread: NDArray, own: NDArray) -> NDArray[np.float64]:
        """θ (q,) read from the matrices."""
        parts = ((loads, self.loadings), (spread, self.factors), (own, self.residuals))
        return np.array([matrix[cell] for matrix, cells in parts for cell in cells], dtype=np.float64)

    def implied(self, theta: NDArray) -> NDArray:
        """Σ (p, p)."""
        loads, spread, own = self.matrices(theta)
        return loads @ spread @ loads.T + own

    def slopes(self, theta: NDArray[np.float64]) -> NDArray[np.float64]:
        """∂Σ / ∂θ (q, p, p); of ordinal items the diagonals are to be left alone."""
        loads, spread, _ = self.matrices(theta)
        return self.slopes_at(loads, spread, self.loadings, self.factors, self.residuals)

    @staticmethod
    def slopes_at(
        loads: NDArray[np.float64],
        spread: NDArray[np.float64],
        loadings: Cells,
        factors: Cells,
        residuals: Cells,
    ) -> NDArray[np.float64]:
        """∂Σ by any cells of Λ, Φ and Θ, free ones or not."""
        p = len(loads)
        out = np.zeros((len(loadings) + len(factors) + len(residuals), p, p))
        across = loads @ spread
        at = 0
        for row, col in loadings:
            out[at, row] += across[:, col]
            out[at, :, row] += across[:, col]
            at += 1
        for row, col in factors:
            outer = np.outer(loads[:, row], loads[:, col])
            out[at] = outer if row == col else outer + outer.T
            at += 1
        for row, col in residuals:
            out[at, row, col] = out[at, col, row] = 1.0
            at += 1
        return out

    def converted(self, theta: NDArray[np.float64], to: Structure) -> NDArray[np.float64]:
        """The same Σ from "unit" into "marker" metric."""
        loads, spread, own = self.matrices(theta)
        scale = np.array([loads[cell] for cell in to.fixed])
        return to.parameters(loads / scale, spread * np.outer(scale, scale), own)


def structure_of(
    model: Measurement, items: tuple[str, ...], metric: Metric, *, ordinal: bool = False
) -> Structure:
    """The free cells of a model over items (p,)."""
    place = {item: at for at, item in enumerate(items)}
    order = {name: at for at, name in enumerate(model.names)}
    cells = [(place[item], order[name]) for name, own in model.factors for item in own]
    markers = tuple((place[own[0]], order[name]) for name, own in model.factors)
    fixed = markers if metric == "marker" else ()
    spread = [(order[b], order[a]) for a, b in model.correlated]
    own = [(place[a], place[b]) for a, b in model.residuals]
    if metric == "marker":
        spread += [(at, at) for at in order.values()]
    if not ordinal:
        own += [(at, at) for at in range(len(items))]
    return Structure(
        model, items, tuple(cell for cell in cells if cell not in fixed), tuple(spread), tuple(own), fixed, ordinal
    )  # fmt: skip


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
    factors = np.clip(across / np.outer(spread, spread), -START_MOST, START_MOST)
    common = loads**2 @ np.ones(k)
    rest = np.diag(np.clip(1.0 - common, 0.2, 1.0))
    return unit.parameters(loads, factors, rest)
