"""Fisher scoring: the one loop behind likelihood with and without gaps and behind weighted least squares."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from survey.analysis.errors import NotConverged

__all__ = ["Evaluation", "scored", "solved"]

# θ → misfit, its slope (q,), its expected second derivative (q, q); a misfit that does not exist is infinite.
Evaluation = Callable[[NDArray[np.float64]], tuple[float, NDArray[np.float64], NDArray[np.float64]]]
STEPS, HALVINGS = 2000, 40
REST = 1e-15  # of half the misfit that one more step would take away
ROUNDING = 1e-9


def scored(
    evaluate: Evaluation, start: NDArray[np.float64], progress: Callable[[str], object] | None = None
) -> NDArray[np.float64]:
    """θ of least misfit from a start (q,): steps against the slope, halved until they help.

    progress: called with what is done next. Raises NotConverged.
    """
    theta = start
    value, slope, curvature = evaluate(theta)
    if not np.isfinite(value):
        raise NotConverged("the fit has no likelihood at its start – look for items that repeat each other")
    for done in range(STEPS):
        if progress is not None:
            progress(f"fit, step {done + 1}")
        step = -solved(curvature, slope)
        gain = float(-slope @ step)
        if gain < REST:
            return theta
        found = _shortened(evaluate, theta, step, value)
        if found is None:
            if gain < ROUNDING:
                return theta
            break
        theta, value, slope, curvature = found
    raise NotConverged("the fit does not come to rest – take out a factor, or items with hardly any loading")


def _shortened(evaluate: Evaluation, theta: NDArray, step: NDArray, value: float):
    """The first of the step, its half, its quarter … that lowers the misfit."""
    for halving in range(HALVINGS):
        after = theta + step * 0.5**halving
        found = evaluate(after)
        if found[0] < value:
            return after, *found
    return None


def solved(matrix: NDArray[np.float64], right: NDArray[np.float64]) -> NDArray[np.float64]:
    """matrix⁻¹ right; of a singular matrix the shortest answer, so that an unidentified fit still comes to rest."""
    scale = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    values, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
    keep = values > 1e-12 * values[-1]
    inverse = (vectors[:, keep] / values[keep]) @ vectors[:, keep].T
    return ((inverse @ (right.T / scale).T).T / scale).T
