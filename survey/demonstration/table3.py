"""The paper's Table 3 and a population that has it: correlations with its loadings and the printed KMO and χ².

Nothing here uses `survey.analysis`, so the samples owe nothing to what they test. All of it is the same on every
machine to rounding.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

__all__ = [
    "ALPHA",
    "CHI2",
    "CLOSE",
    "KMO",
    "LOG_DET",
    "TABLE_3",
    "TABLE_3_ITEMS",
    "N",
    "correlation_of_ten",
    "correlation_of_twelve",
    "deviations",
    "kmo_of",
]

# Rows and columns in the paper's order.
TABLE_3_ITEMS = (
    "fabric_texture", "fabric_colour", "fabric_lustre", "thickness_texture", "silhouette",
    "detail_structure", "pleat", "perspective", "dynamic_drape", "dynamic_swing",
)  # fmt: skip
TABLE_3 = np.array([
    [.937, .121, .025], [.918, .229, .239], [.854, .371, -.018], [.872, .144, .304], [.197, .813, .293],
    [.274, .852, .069], [.396, .859, .177], [.243, .764, .404], [.236, .112, .891], [.059, .301, .817],
])  # fmt: skip
# The two items that the paper drops, each with its twin and their correlation.
CLOSE = (("static_overall", "silhouette", 0.968), ("static_drape", "dynamic_drape", 0.930))
N, KMO, CHI2, ALPHA = 20, 0.824, 167.23, 0.911
LOG_DET = -CHI2 / (N - 1 - (2 * len(TABLE_3) + 5) / 6)  # ln det R of the ten, from the printed χ²
POPULATION = Path(__file__).parent / "population.csv"


def kmo_of(r: NDArray[np.float64]) -> float:
    """Overall KMO of a correlation matrix (p, p)."""
    inverse = np.linalg.inv(r)
    partial = inverse / np.sqrt(np.outer(np.diag(inverse), np.diag(inverse)))
    off = ~np.eye(len(r), dtype=bool)
    return float((r[off] ** 2).sum() / ((r[off] ** 2).sum() + (partial[off] ** 2).sum()))


@lru_cache(maxsize=1)
def correlation_of_ten() -> NDArray[np.float64]:
    """R (10, 10) with Table 3's loadings as its first three components' space, and the printed KMO and χ².

    These are 12 conditions on 28 numbers, so there is not one such R but a family of sixteen dimensions, in which a
    solver ends where its machine's rounding leads it, up to 3e-6 apart. The member that the samples come from is
    therefore data, `population.csv`; `recipe.solved_population` is how it was found.
    """
    return np.loadtxt(POPULATION, delimiter=",", skiprows=1, encoding="utf-8")


def correlation_of_twelve() -> NDArray[np.float64]:
    """R (12, 12): the ten, and the two static items, each close to its twin and to the others through it alone."""
    p = len(TABLE_3)
    r = np.eye(p + 2)
    r[:p, :p] = correlation_of_ten()
    for row, (_, twin, close) in enumerate(CLOSE, start=p):
        r[row, :row] = close * r[TABLE_3_ITEMS.index(twin), :row]
        r[:row, row] = r[row, :row]
    return r


def deviations() -> NDArray[np.float64]:
    """Standard deviations (12,) around 1 that bring the raw α of the ten items to the printed .911."""
    r, p = correlation_of_ten(), len(TABLE_3)
    tilt = np.linspace(-1.0, 1.0, p)[np.random.default_rng(3).permutation(p)]

    def excess(size: float) -> float:
        sd = np.exp(size * tilt)
        c = r * np.outer(sd, sd)
        return float(p / (p - 1) * (1 - np.trace(c) / c.sum()) - ALPHA)

    # To rounding: brentq's own 2e-12 would leave the last digits to the machine.
    size = brentq(excess, 0.0, 2.0, xtol=1e-15)
    return np.concatenate([np.exp(float(size) * tilt), [1.0, 1.0]])  # type: ignore[arg-type]
