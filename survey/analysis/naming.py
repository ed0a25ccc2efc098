"""A name for each component: the module from which most of its loading comes. A proposal, a person may say better."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from survey.analysis.components.extraction import Components

__all__ = ["homes", "proposed_modules"]


def homes(components: Components) -> list[int]:
    """(p,) the component on which each item loads most."""
    return np.abs(components.loadings).argmax(axis=1).tolist()


def proposed_modules(
    components: Components, items: Sequence[str], module_of: Mapping[str, str]
) -> list[str | None]:
    """(k,) per component the module with the most squared loading among the items at home there, or None.

    A module that would name two components names the one it fills more.
    """
    home, squares = homes(components), components.loadings**2
    weight: dict[tuple[int, str], float] = {}
    for row, item in enumerate(items):
        if item in module_of:
            key = (home[row], module_of[item])
            weight[key] = weight.get(key, 0.0) + float(squares[row, home[row]])
    names: list[str | None] = [None] * components.kept
    for (column, module), _ in sorted(weight.items(), key=lambda entry: -entry[1]):
        if names[column] is None and module not in names:
            names[column] = module
    return names
