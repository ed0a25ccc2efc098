"""Power of the test of close fit by RMSEA (MacCallum, Browne and Sugawara 1996)."""

from __future__ import annotations

from scipy.stats import ncx2

from survey.analysis.errors import OutOfReach
from survey.analysis.planning.sizes import least

__all__ = ["fit_answers", "fit_power"]


def fit_power(n: int, df: int, null: float = 0.05, actual: float = 0.08, alpha: float = 0.05) -> float:
    """Chance to reject that RMSEA is `null` where it is `actual`, with n answers and df degrees of freedom.

    actual < null: the test of a fit that is not close is the one with that power. Raises OutOfReach.
    """
    if df < 1:
        raise OutOfReach(f"{df} degrees of freedom – a model needs one at least to be tested")
    if null < 0.0 or actual < 0.0 or null == actual:
        raise OutOfReach(f"RMSEA {null:g} against {actual:g} – give two different figures from 0 on")
    scale = (n - 1) * df
    there, here = scale * max(null, 1e-9) ** 2, scale * max(actual, 1e-9) ** 2
    if actual > null:
        return float(ncx2.sf(ncx2.ppf(1.0 - alpha, df, there), df, here))
    return float(ncx2.cdf(ncx2.ppf(alpha, df, there), df, here))


def fit_answers(
    df: int, power: float = 0.8, null: float = 0.05, actual: float = 0.08, alpha: float = 0.05
) -> int:
    """The smallest n with that power. Raises OutOfReach."""
    if not alpha < power < 1.0:
        raise OutOfReach(f"power {power:g} – give a figure between {alpha:g} and 1")
    return least(lambda n: fit_power(n, df, null, actual, alpha) >= power, 5)
