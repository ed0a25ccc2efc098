"""The sample of the 25 primary indicators: 200 people who think as Table 3's population does.

Made anew on any machine it is the file, as the other drawn samples are: the opinions agree to rounding, none of them
is near enough to two scores for that to decide, and all that follows are whole numbers.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from survey.demonstration.indicators import primary
from survey.demonstration.table3 import CLOSE, TABLE_3_ITEMS, correlation_of_ten

__all__ = ["primary_opinions", "primary_sample"]

ROWS, SEED = 200, 25
MIDDLE = 3.2
PART = 0.9  # correlation of a part with the indicator that it is merged into
# What was deleted, as a mixture of intermediate indicators; the rest of its variance is its own.
DELETED = {
    "clothing_style": {"silhouette": 0.88},
    "drape": {"dynamic_drape": 0.75},
    "softness": {"fabric_texture": 0.25},
    "stiffness": {"thickness_texture": 0.7},
    "dynamic_overall_effect": {"dynamic_swing": 0.5, "dynamic_drape": 0.5},
}
# Share of people who judge a static item otherwise than its twin, by one point.
OTHERWISE = {"static_overall": 0.065, "static_drape": 0.135}


def primary_opinions() -> NDArray[np.float64]:
    """(ROWS, 25) what they think of each indicator, before it is made a whole score; the static two as their twins."""
    rng = np.random.default_rng(SEED)
    ten = rng.normal(size=(ROWS, len(TABLE_3_ITEMS))) @ np.linalg.cholesky(correlation_of_ten()).T
    own = rng.normal(size=(ROWS, len(primary())))
    twin = {item: other for item, other, _ in CLOSE}
    parts = [one.into for one in primary()]
    columns = []
    for at, one in enumerate(primary()):
        if one.into is None:
            mixture = DELETED[one.id]
        else:
            mixture = {twin.get(one.into, one.into): PART if parts.count(one.into) > 1 else 1.0}
        common = sum(weight * ten[:, TABLE_3_ITEMS.index(item)] for item, weight in mixture.items())
        rest = 1.0 - sum(weight**2 for weight in mixture.values())
        columns.append(MIDDLE + common + np.sqrt(rest) * own[:, at])
    return np.column_stack(columns)


def primary_sample() -> NDArray[np.float64]:
    """(ROWS, 25) whole scores 1–5, in the paper's order of the indicators."""
    scores = np.clip(np.rint(primary_opinions()), 1, 5)
    rng = np.random.default_rng([SEED, 1])
    for at, one in enumerate(primary()):
        if one.into in OTHERWISE:
            people = rng.permutation(ROWS)[: round(OTHERWISE[one.into] * ROWS)]
            step = np.where(rng.integers(2, size=len(people)) == 1, 1.0, -1.0)
            moved = scores[people, at] + step
            scores[people, at] = np.where((moved < 1) | (moved > 5), scores[people, at] - step, moved)
    return scores
