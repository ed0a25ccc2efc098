"""Maximum likelihood of a measurement model, from complete answers or from all there are (Jöreskog 1969)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.analysis.confirmatory.covariance_structure import Structure, start_of, structure_of
from survey.analysis.confirmatory.fisher_scoring import scored, solved
from survey.analysis.confirmatory.fit_indices import Fit, Tested, fit_of
from survey.analysis.confirmatory.measurement_model import Measurement
from survey.analysis.confirmatory.modification_indices import Hint, hints_of
from survey.analysis.correlation import Patterns, Saturated, misfit_of, patterns_of, saturated

__all__ = ["Likelihood", "likelihood"]

WIDE = 40  # items, from which on the patterns are taken one by one


@dataclass(frozen=True)
class Likelihood:
    """theta (q,) in marker metric with its covariance (q, q); mean: (p,) of the items, with theirs (p, p).

    free: what the model is compared with. hints: from the expected information, with gaps too.
    """

    structure: Structure
    theta: NDArray[np.float64]
    variance: NDArray[np.float64]
    mean: NDArray[np.float64]
    mean_variance: NDArray[np.float64]
    fit: Fit
    free: Saturated
    seen: Patterns
    hints: tuple[Hint, ...]


def likelihood(
    table: NDArray[np.float64],
    names: Sequence[str],
    model: Measurement,
    progress: Callable[[str], object] | None = None,
) -> Likelihood:
    """Of scores (n, p), NaN missing; items in the model's order.

    Complete answers: expected information, as lavaan has it; with gaps: means are estimated too, and the information
    is the observed one (Kenward and Molenberghs 1998). progress: called with what is done next.
    Raises what `patterns_of` and `saturated` raise, NotConverged.
    """
    seen = patterns_of(table, names)
    free = saturated(seen, names, progress)
    unit = structure_of(model, tuple(names), "unit")
    spread = np.sqrt(np.diag(free.covariance))
    start = start_of(unit, free.covariance / np.outer(spread, spread))
    loads, factors, own = unit.matrices(start)
    begun = unit.parameters(loads * spread[:, None], factors, own * np.outer(spread, spread))
    best = scored(_Misfit(unit, seen, free.mean), _with_mean(begun, seen, free), progress)
    marker = structure_of(model, tuple(names), "marker")
    misfit = _Misfit(marker, seen, free.mean)
    theta = np.concatenate([unit.converted(best[: unit.size], marker), best[unit.size :]])
    q, n = marker.size, seen.n
    value, _, expected = misfit(theta)
    bend = expected if seen.whole else misfit.bend(theta, 1.0 / np.sqrt(np.diag(expected)[:q]))
    variance = solved(bend, np.eye(len(bend))) * 2.0 / n
    mean = free.mean if seen.whole else theta[q:]
    mean_variance = marker.implied(theta[:q]) / n if seen.whole else variance[q:, q:]
    hints = hints_of(marker, theta[:q], misfit.by_sigma(theta), misfit.information(theta), n)
    fit = fit_of(
        Tested(n * (value - free.misfit), model.freedom()),
        _independent(seen, free),
        n,
        _srmr(marker.implied(theta[:q]), mean, free, seen.whole),
    )
    return Likelihood(
        marker, theta[:q], variance[:q, :q], mean=mean, mean_variance=mean_variance, fit=fit, free=free, seen=seen,
        hints=hints,
    )  # fmt: skip


class _Misfit:
    """θ, and where there are gaps the means behind it → −2 ln L / n, its slope and expected second derivative."""

    def __init__(self, structure: Structure, seen: Patterns, mean: NDArray[np.float64]) -> None:
        self.structure, self.seen, self.mean = structure, seen, mean
        self.share = seen.share

    def _parts(self, theta: NDArray[np.float64]):
        q = self.structure.size
        mean = self.mean if self.seen.whole else theta[q:]
        return misfit_of(self.seen, mean, self.structure.implied(theta[:q]))

    def __call__(self, theta: NDArray[np.float64]):
        q, p = self.structure.size, len(self.mean)
        value, by_sigma, by_mean, inverses = self._parts(theta)
        slopes = self.structure.slopes(theta[:q])
        if not np.isfinite(value):
            return value, np.zeros(len(theta)), np.eye(len(theta))
        slope = np.tensordot(slopes, by_sigma, axes=2)
        bend = _information(slopes, inverses, inverses, self.share)
        if self.seen.whole:
            return value, slope, bend
        whole = np.zeros((q + p, q + p))
        whole[:q, :q] = bend
        whole[q:, q:] = 2.0 * np.tensordot(self.share, inverses, axes=1)
        return value, np.concatenate([slope, by_mean]), whole

    def bend(self, theta: NDArray[np.float64], steps: NDArray[np.float64]) -> NDArray[np.float64]:
        """The observed second derivative of a misfit with means. steps: (q,), how far each parameter reaches."""
        q = self.structure.size
        slopes = self.structure.slopes(theta[:q])
        _, by_sigma, _, inverses = self._parts(theta)
        apart, about = self.seen.around(theta[q:])
        held = 2.0 * inverses @ about @ inverses - inverses
        pulled = (inverses @ apart[:, :, None])[:, :, 0]
        tied = 2.0 * np.tensordot(self.share[:, None, None] * inverses, pulled, axes=(0, 0))  # (p, p, p)
        whole = np.zeros((len(theta), len(theta)))
        whole[:q, :q] = _information(slopes, inverses, held, self.share) + self._curved(
            theta[:q], steps, by_sigma
        )
        whole[:q, q:] = np.einsum("ijl,ajl->ai", tied, slopes)
        whole[q:, :q] = whole[:q, q:].T
        whole[q:, q:] = 2.0 * np.tensordot(self.share, inverses, axes=1)
        return (whole + whole.T) / 2.0

    def _curved(
        self, theta: NDArray[np.float64], steps: NDArray[np.float64], by_sigma: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """The misfit's slope by Σ times ∂²Σ (q, q). ∂Σ is quadratic in θ, so that its differences are exact."""
        rows = []
        for apart in np.diag(steps):
            moved = self.structure.slopes(theta + apart) - self.structure.slopes(theta - apart)
            rows.append(np.tensordot(moved, by_sigma, axes=2) / (2.0 * apart.sum()))
        return np.array(rows)

    def by_sigma(self, theta: NDArray[np.float64]) -> NDArray[np.float64]:
        return self._parts(theta)[1]

    def information(self, theta: NDArray[np.float64]):
        """∂Σ (q, p, p) by any parameters → the expected second derivative of the misfit by them."""
        inverses = self._parts(theta)[3]
        return lambda slopes: _information(slopes, inverses, inverses, self.share)


def _information(
    slopes: NDArray[np.float64],
    left: NDArray[np.float64],
    right: NDArray[np.float64],
    share: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Σ share · tr(left ∂Σ_a right ∂Σ_b) (q, q) over the patterns, symmetric matrices (K, p, p) on both sides."""
    q, p = slopes.shape[:2]
    if len(left) == 1 or p > WIDE:
        found = np.zeros((q, q))
        for part, one, other in zip(share, left, right, strict=True):
            found += part * (one @ slopes).reshape(q, -1) @ (other @ slopes).swapaxes(1, 2).reshape(q, -1).T
        return found
    # Σ share · left ⊗ right first: then many patterns cost as much as one.
    outer = (left.reshape(len(left), p * p) * share[:, None]).T @ right.reshape(len(right), p * p)
    middle = outer.reshape(p, p, p, p).transpose(0, 2, 1, 3).reshape(p * p, p * p)
    flat = slopes.reshape(q, p * p)
    return flat @ middle @ flat.T


def _with_mean(begun: NDArray[np.float64], seen: Patterns, free: Saturated) -> NDArray[np.float64]:
    return begun if seen.whole else np.concatenate([begun, free.mean])


def _independent(seen: Patterns, free: Saturated) -> Tested:
    """The model without any correlation, which CFI and TLI compare with."""
    weight = seen.share[:, None] * seen.there
    mean = (weight * seen.mean).sum(axis=0) / weight.sum(axis=0)
    apart = np.where(seen.there, seen.mean - mean, 0.0)
    spread = np.diagonal(seen.covariance, axis1=1, axis2=2) + apart**2
    variance = (weight * spread).sum(axis=0) / weight.sum(axis=0)
    misfit = float((weight.sum(axis=0) * (np.log(variance) + 1.0)).sum())
    p = len(mean)
    return Tested(seen.n * (misfit - free.misfit), p * (p - 1) // 2)


def _srmr(sigma: NDArray[np.float64], mean: NDArray[np.float64], free: Saturated, whole: bool) -> float:
    """Of covariances over the observed standard deviations (Bentler 1995), with gaps of the means as well."""
    spread = np.sqrt(np.diag(free.covariance))
    rest = ((free.covariance - sigma) / np.outer(spread, spread))[np.tril_indices(len(sigma))]
    if not whole:
        rest = np.concatenate([rest, (free.mean - mean) / spread])
    return float(np.sqrt((rest**2).mean()))
