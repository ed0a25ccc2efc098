"""Cases of a full matrix of which the suite runs some: the night runs the rest."""

from collections.abc import Iterable

import pytest

__all__ = ["by_day"]


def by_day(day: Iterable[object], values: Iterable[object]) -> list[object]:
    """`values` for parametrize or a fixture; those that are not among `day` are marked `nightly`."""
    chosen, found = list(day), list(values)
    assert all(value in found for value in chosen), "a case of the day that there is not"
    return [
        value
        if value in chosen
        else pytest.param(*(value if isinstance(value, tuple) else (value,)), marks=pytest.mark.nightly)
        for value in found
    ]
