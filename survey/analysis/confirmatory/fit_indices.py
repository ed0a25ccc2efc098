"""How well a model fits: χ² with its probability, CFI, TLI, RMSEA with its interval, SRMR (Hu and Bentler 1999)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from scipy.optimize import brentq
from scipy.special import chdtr, chdtrc, chndtr  # scipy.stats takes a quarter of a second to import

__all__ = ["CLOSE", "Fit", "Tested", "fit_of"]

LEVEL, CLOSE = 0.90, 0.05


@dataclass(frozen=True)
class Tested:
    """A χ² with its degrees of freedom."""

    chi2: float
    df: int


@dataclass(frozen=True)
class Fit:
    """p, RMSEA and what belongs to it are None where there is no degree of freedom to test with.

    rmsea_low, rmsea_high: 90 %. close: probability of this χ² or more where RMSEA is .05 (a close fit).
    base: the model without any correlation.
    """

    chi2: float
    df: int
    p: float | None
    cfi: float
    tli: float
    rmsea: float
    rmsea_low: float
    rmsea_high: float
    close: float | None
    srmr: float
    base: Tested


def fit_of(tested: Tested, base: Tested, n: float, srmr: float) -> Fit:
    """n: what the population's misfit is multiplied by to make χ²: the answers, of weighted least squares less one."""
    value, df = max(tested.chi2, 0.0), tested.df
    over, over_base = max(value - df, 0.0), max(base.chi2 - base.df, 0.0)
    most = max(over, over_base)
    cfi = 1.0 - over / most if most > 0.0 else 1.0
    if df == 0:
        return Fit(
            value, 0, p=None, cfi=cfi, tli=1.0, rmsea=0.0, rmsea_low=0.0, rmsea_high=0.0, close=None, srmr=srmr,
            base=base,
        )  # fmt: skip
    slack = base.chi2 - base.df
    tli = 1.0 - (value - df) * base.df / (df * slack) if slack != 0.0 else 1.0
    low, high = (_noncentrality(value, df, level) for level in ((1.0 + LEVEL) / 2, (1.0 - LEVEL) / 2))
    rmsea, low, high = ((part / (df * n)) ** 0.5 for part in (over, low, high))
    return Fit(
        value, df, p=float(chdtrc(df, value)), cfi=cfi, tli=tli, rmsea=rmsea, rmsea_low=low, rmsea_high=high,
        close=1.0 - float(chndtr(value, df, n * df * CLOSE**2)), srmr=srmr, base=base,
    )  # fmt: skip


def _noncentrality(value: float, df: int, level: float) -> float:
    """λ at which χ²(df, λ) stays below the value with this probability; 0 where none does."""
    if chdtr(df, value) <= level:
        return 0.0
    high = max(value, 10.0)
    while chndtr(value, df, high) > level:
        high *= 2.0
    found: Any = brentq(lambda part: chndtr(value, df, part) - level, 1e-12, high, xtol=1e-10)
    return float(found)
