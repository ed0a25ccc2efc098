"""GRIM (Brown and Heathers 2017): whether a published mean of whole numbers is possible at all."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from survey.analysis.errors import NotAMean

__all__ = ["grim", "least_n"]

MOST = 10_000  # answers, up to which one number is looked for that makes all means possible


def grim(mean: str, n: int, *, items: int = 1, half_up: bool = False) -> bool:
    """Whether n answers of `items` whole numbers each can have this mean, printed with its decimals ("4.46").

    A half may have been rounded either way, with half_up only upwards.
    Raises NotAMean for a text that is no mean, or n or items below 1.
    """
    if n < 1 or items < 1:
        raise NotAMean(f"n = {n}, items = {items} – both are at least 1")
    try:
        exact = Fraction(mean)
    except (ValueError, ZeroDivisionError):
        raise NotAMean(f"{mean!r} is no mean – write it as printed, such as 4.46") from None
    if "/" in mean or "e" in mean.lower():
        raise NotAMean(f"{mean!r} is no mean – write it as printed, such as 4.46")
    half = Fraction(1, 2 * 10 ** len(mean.partition(".")[2]))
    total = n * items
    least = -((half - exact) * total // 1)  # the smallest whole sum that is rounded up to the mean
    nearest = Fraction(least, total)
    return nearest < exact + half or (nearest == exact + half and not half_up)


def least_n(means: Sequence[str], *, items: int = 1, half_up: bool = False) -> int | None:
    """The smallest number of answers with which all the means are possible, None where there is none up to MOST."""
    fits = (
        n for n in range(1, MOST + 1) if all(grim(mean, n, items=items, half_up=half_up) for mean in means)
    )
    return next(fits, None)
