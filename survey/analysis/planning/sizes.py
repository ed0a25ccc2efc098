"""Answers needed for a mean, a difference of two groups, a correlation, a reliability: by formula."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy import stats
from scipy.special import ndtri

from survey.analysis.errors import OutOfReach

__all__ = [
    "MOST",
    "correlation_answers",
    "correlation_margin_answers",
    "difference_answers",
    "difference_power",
    "least",
    "mean_answers",
    "mean_margin",
    "reliability_answers",
    "reliability_width_answers",
]

MOST = 10_000_000  # answers; beyond, the plan is called out of reach


def least(enough: Callable[[int], bool], start: int = 2) -> int:
    """The smallest n from `start` on that is enough, where more is never less. Raises OutOfReach beyond ten million."""
    if enough(start):
        return start
    low, high = start, start * 2
    while not enough(high):
        low, high = high, high * 2
        if low > MOST:
            raise OutOfReach(f"more than {MOST:,} answers – ask for less power, or for a larger effect")
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if enough(middle) else (middle, high)
    return high


def _between(name: str, value: float, low: float, high: float) -> None:
    if not low < value < high:
        raise OutOfReach(f"{name} = {value:g} – give a figure between {low:g} and {high:g}")


def mean_margin(sd: float, n: int, level: float = 0.95) -> float:
    """Half of a mean's interval (Student's t) over n answers of deviation sd."""
    return float(stats.t.ppf((1.0 + level) / 2.0, n - 1)) * sd / math.sqrt(n)


def mean_answers(margin: float, sd: float, level: float = 0.95) -> int:
    """Answers with which a mean's interval is ± margin at most. Raises OutOfReach."""
    _between("margin", margin, 0.0, 1e6)
    _between("sd", sd, 0.0, 1e6)
    _between("level", level, 0.0, 1.0)
    return least(lambda n: mean_margin(sd, n, level) <= margin)


def difference_power(g: float, first: int, second: int, alpha: float = 0.05) -> float:
    """Of the two-sided t test to find a difference of g standard deviations between groups of these sizes."""
    df = first + second - 2
    away = abs(g) * math.sqrt(first * second / (first + second))
    edge = float(stats.t.ppf(1.0 - alpha / 2.0, df))
    return float(stats.nct.sf(edge, df, away) + stats.nct.cdf(-edge, df, away))


def difference_answers(
    g: float, power: float = 0.8, alpha: float = 0.05, ratio: float = 1.0
) -> tuple[int, int]:
    """Answers in each of two groups, the second `ratio` times the first, ten at least. Raises OutOfReach."""
    _between("effect", abs(g), 0.0, 100.0)
    _between("power", power, alpha, 1.0)
    _between("alpha", alpha, 0.0, 1.0)
    _between("ratio", ratio, 0.001, 1000.0)
    first = least(lambda n: difference_power(g, n, max(2, math.ceil(n * ratio)), alpha) >= power)
    return first, max(2, math.ceil(first * ratio))


def correlation_answers(r: float, power: float = 0.8, alpha: float = 0.05) -> int:
    """Answers with which the two-sided test finds a correlation r, by Fisher's z. Raises OutOfReach."""
    _between("r", abs(r), 0.0, 1.0)
    _between("power", power, alpha, 1.0)
    both = float(ndtri(1.0 - alpha / 2.0) + ndtri(power))
    return math.ceil((both / math.atanh(abs(r))) ** 2 + 3.0 - 1e-9)


def correlation_margin_answers(r: float, margin: float, level: float = 0.95) -> int:
    """Answers with which the interval of a correlation r is 2 × margin wide at most, by Fisher's z."""
    _between("r", abs(r), -1e-9, 1.0)
    _between("margin", margin, 0.0, 1.0)
    z = float(ndtri((1.0 + level) / 2.0))

    def width(n: int) -> float:
        half = z / math.sqrt(n - 3)
        return math.tanh(math.atanh(r) + half) - math.tanh(math.atanh(r) - half)

    return least(lambda n: width(n) <= 2.0 * margin, 4)


def reliability_answers(
    alpha: float, least_alpha: float, items: int, power: float = 0.8, level: float = 0.05
) -> int:
    """Answers that show an α to be above `least_alpha` (two-sided at `level`), by Bonett 2002. Raises OutOfReach."""
    _reliable(alpha, items)
    _between("least α", least_alpha, -1.0, alpha)
    both = float(ndtri(1.0 - level / 2.0) + ndtri(power))
    ratio = math.log((1.0 - least_alpha) / (1.0 - alpha))
    return math.ceil(2.0 * items / (items - 1.0) * (both / ratio) ** 2 + 2.0 - 1e-9)


def reliability_width_answers(alpha: float, width: float, items: int, level: float = 0.95) -> int:
    """Answers with which α's interval is this wide at most, by Bonett 2002. Raises OutOfReach."""
    _reliable(alpha, items)
    _between("width", width, 0.0, 2.0)
    z = float(ndtri((1.0 + level) / 2.0))

    def wide(n: int) -> float:
        half = z * math.sqrt(2.0 * items / ((items - 1.0) * (n - 2.0)))
        return (1.0 - alpha) * float(np.exp(min(half, 700.0)) - np.exp(-half))

    return least(lambda n: wide(n) <= width, 3)


def _reliable(alpha: float, items: int) -> None:
    _between("α", alpha, 0.0, 1.0)
    if items < 2:
        raise OutOfReach(f"{items} items – α needs two at least")
