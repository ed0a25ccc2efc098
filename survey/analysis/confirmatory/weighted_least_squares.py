"""Diagonally weighted least squares on polychoric correlations (Muthén, du Toit and Spisic 1997), as lavaan's WLSMV.

The thresholds are free, so they fit exactly and the misfit is Σ w (r − ρ)² over the pairs, w one over the variance of
each correlation. Standard errors and the scaled-shifted χ² (Asparouhov and Muthén 2010) come from the whole
covariance of the correlations' errors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.analysis.confirmatory.covariance_structure import Structure, start_of, structure_of
from survey.analysis.confirmatory.fisher_scoring import scored, solved
from survey.analysis.confirmatory.fit_indices import Fit, Tested, fit_of
from survey.analysis.confirmatory.measurement_model import Measurement
from survey.analysis.confirmatory.modification_indices import Hint, hints_of
from survey.analysis.confirmatory.thresholds import Polychorics, polychorics

__all__ = ["Weighted", "weighted", "weighted_of"]


@dataclass(frozen=True)
class Weighted:
    """theta (q,) in marker metric with its robust covariance (q, q). fit: of the plain χ²; scaled: of the robust one.

    factor, shift: scaled χ² = χ² / factor + shift. hints: of the plain χ².
    """

    structure: Structure
    theta: NDArray[np.float64]
    variance: NDArray[np.float64]
    fit: Fit
    scaled: Fit
    factor: float
    shift: float
    seen: Polychorics
    hints: tuple[Hint, ...]


def weighted(table: NDArray[np.float64], names: Sequence[str], model: Measurement) -> Weighted:
    """Of complete scores (n, p), items in the model's order. Raises what `polychorics` raises, NotConverged."""
    return weighted_of(polychorics(table, names), names, model)


def weighted_of(seen: Polychorics, names: Sequence[str], model: Measurement) -> Weighted:
    """The same from the correlations and their errors."""
    pairs = np.tril_indices(len(names), -1)
    weight, r = 1.0 / np.diag(seen.error), seen.r[pairs]
    unit = structure_of(model, tuple(names), "unit", ordinal=True)
    marker = structure_of(model, tuple(names), "marker", ordinal=True)

    def misfit(theta: NDArray[np.float64]):
        rest = r - unit.implied(theta)[pairs]
        slopes = unit.slopes(theta)[:, *pairs]
        steep = slopes * weight
        return float(weight @ rest**2), -2.0 * steep @ rest, 2.0 * steep @ slopes.T

    theta = unit.converted(scored(misfit, start_of(unit, seen.r)), marker)
    slopes = marker.slopes(theta)[:, *pairs]
    steep = slopes * weight
    rest = r - marker.implied(theta)[pairs]
    inner = solved(steep @ slopes.T, np.eye(marker.size))
    n = seen.n - 1  # as lavaan counts them for least squares
    variance = inner @ steep @ seen.error @ steep.T @ inner / n
    plain = Tested(n * float(weight @ rest**2), model.freedom())
    base = Tested(n * float(weight @ r**2), len(r))
    residual = np.diag(weight) - steep.T @ inner @ steep
    robust, factor, shift = _scaled(plain, residual @ seen.error)
    robust_base, _, _ = _scaled(base, weight[:, None] * seen.error)
    p = len(names)
    srmr = float(
        np.sqrt((rest**2).sum() / (p * (p + 1) / 2))
    )  # the diagonal fits and counts, as in maximum likelihood
    slope = np.zeros_like(seen.r)
    slope[pairs] = -weight * rest
    hints = hints_of(
        marker, theta, slope + slope.T, lambda by: 2.0 * (by[:, *pairs] * weight) @ by[:, *pairs].T, seen.n
    )
    return Weighted(
        marker, theta, variance, fit=fit_of(plain, base, n, srmr), scaled=fit_of(robust, robust_base, n, srmr),
        factor=factor, shift=shift, seen=seen, hints=hints,
    )  # fmt: skip


def _scaled(plain: Tested, both: NDArray[np.float64]) -> tuple[Tested, float, float]:
    """χ² brought to the mean and variance of its distribution. both: U Γ (m, m)."""
    if plain.df == 0:
        return plain, 1.0, 0.0
    trace, squares = float(np.trace(both)), float((both * both.T).sum())
    factor = (squares / plain.df) ** 0.5
    shift = plain.df - trace / factor
    return Tested(plain.chi2 / factor + shift, plain.df), factor, shift
