"""What a confirmatory analysis finds, and how its estimates are standardised."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from survey.analysis.confirmatory.covariance_structure import Structure
from survey.analysis.confirmatory.fit_indices import Fit
from survey.analysis.confirmatory.measurement_model import Measurement
from survey.analysis.confirmatory.modification_indices import Hint
from survey.analysis.screening import Note

__all__ = ["LEVEL", "Confirmation", "Parameter", "Standard", "parameters_of", "standardised"]

LEVEL = 0.95
Op = Literal["=~", "~~", "~1", "|"]
STEP = 1e-30  # of the imaginary part: complex steps have no rounding error


@dataclass(frozen=True)
class Standard:
    """A standardised estimate, its standard error by the delta method (NaN: fixed) and 95 % interval."""

    estimate: float
    error: float
    low: float
    high: float


@dataclass(frozen=True)
class Parameter:
    """`left op right` as lavaan writes them: F =~ item, a ~~ b, item ~1, item | t1.

    error, z, p: NaN where the parameter is fixed or follows from others. standard: None for thresholds.
    """

    left: str
    op: Op
    right: str
    estimate: float
    error: float = np.nan
    standard: Standard | None = None

    @property
    def z(self) -> float:
        return self.estimate / self.error if self.error > 0.0 else np.nan

    @property
    def p(self) -> float:
        return float(2.0 * ndtr(-abs(self.z)))


@dataclass(frozen=True)
class Confirmation:
    """Of n answers to the items of a model.

    estimator: "ml", "fiml" (ML from answers with gaps) or "dwls". scaled: the robust fit beside the plain one of
    DWLS, χ² / factor + shift. loadings (p, k), factors (k, k): standardised. residual (p, p): observed less implied
    correlations. rows: the answers that were given, before any was left out.
    """

    model: Measurement
    estimator: Literal["ml", "fiml", "dwls"]
    n: int
    rows: int
    fit: Fit
    parameters: tuple[Parameter, ...]
    loadings: NDArray[np.float64]
    factors: NDArray[np.float64]
    residual: NDArray[np.float64]
    hints: tuple[Hint, ...]
    notes: tuple[Note, ...]
    scaled: Fit | None = None
    factor: float | None = None
    shift: float | None = None

    @property
    def items(self) -> tuple[str, ...]:
        return self.model.items

    @property
    def judged(self) -> Fit:
        """The fit that the report goes by: the robust one where there is one."""
        return self.fit if self.scaled is None else self.scaled


def standardised(structure: Structure, theta: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Λ (p, k), Φ (k, k) and Θ (p, p) of items and factors with variance 1; Θ's covariances as correlations."""
    loads, spread, own = structure.matrices(theta)
    whole = _root(np.diag(loads @ spread @ loads.T + own))
    factor, rest = _root(np.diag(spread)), np.diag(own)
    scale = _root(rest)
    scale = np.where(np.abs(scale) > 0.0, scale, 1.0)
    correlated = own / np.outer(scale, scale)
    np.fill_diagonal(correlated, rest / whole**2)
    return loads * factor / whole[:, None], spread / np.outer(factor, factor), correlated


def _root(variance: NDArray) -> NDArray:
    """Of a variance that came out negative the root of its size: the fit is told to be improper elsewhere."""
    return np.sqrt(variance * np.where(np.real(variance) < 0.0, -1.0, 1.0))


def parameters_of(
    structure: Structure, theta: NDArray[np.float64], variance: NDArray[np.float64]
) -> list[Parameter]:
    """Loadings, covariances and variances with their standardised selves."""
    raw, made = structure.matrices(theta), standardised(structure, theta)
    slopes = _slopes(structure, theta)
    errors = np.sqrt(np.maximum(np.diag(variance), 0.0))
    places = [(0, cell) for cell in structure.loadings]
    places += [(1, cell) for cell in structure.factors] + [(2, cell) for cell in structure.residuals]
    free = dict(zip(places, errors, strict=True))
    out = []
    for one in _listed(structure):
        kind, (row, col) = one.matrix, one.cell
        moved = slopes[:, kind, row, col]
        error = float(np.sqrt(max(moved @ variance @ moved, 0.0)))
        value = float(made[kind][row, col])
        standard = Standard(value, error, *_interval(value, error)) if error > 1e-12 else None
        standard = standard or Standard(value, np.nan, np.nan, np.nan)
        estimate = float(raw[kind][row, col])
        out.append(
            Parameter(
                one.left, one.op, one.right, estimate, float(free.get((kind, (row, col)), np.nan)), standard
            )
        )
    return out


def _interval(value: float, error: float) -> tuple[float, float]:
    half = float(ndtri((1.0 + LEVEL) / 2.0)) * error
    return value - half, value + half


@dataclass(frozen=True)
class _Place:
    """Where `left op right` stands: matrix 0 is Λ, 1 Φ, 2 Θ; cell (row, column)."""

    matrix: int
    cell: tuple[int, int]
    left: str
    op: Op
    right: str


def _listed(structure: Structure) -> Iterator[_Place]:
    """Every parameter, fixed ones too, in the order in which people read them."""
    items, names = structure.items, structure.model.names
    place, order = ({name: at for at, name in enumerate(known)} for known in (items, names))
    for name, own in structure.model.factors:
        for item in own:
            yield _Place(0, (place[item], order[name]), name, "=~", item)
    for a, b in structure.model.correlated:
        yield _Place(1, (order[b], order[a]), a, "~~", b)
    for a, b in structure.model.residuals:
        yield _Place(2, (place[a], place[b]), a, "~~", b)
    for name, at in order.items():
        yield _Place(1, (at, at), name, "~~", name)
    for item, at in place.items():
        yield _Place(2, (at, at), item, "~~", item)


def _slopes(structure: Structure, theta: NDArray[np.float64]) -> NDArray[np.float64]:
    """(q, 3, most, most): the standardised matrices by each parameter."""
    p = len(structure.items)
    out = np.zeros((structure.size, 3, p, p))
    for at in range(structure.size):
        moved = theta.astype(np.complex128)
        moved[at] += 1j * STEP
        for kind, matrix in enumerate(standardised(structure, moved)):
            rows, cols = matrix.shape
            out[at, kind, :rows, :cols] = np.imag(matrix) / STEP
    return out
