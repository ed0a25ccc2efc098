"""Input checks in front of the formulas, so that none of them meets a case where it yields NaN."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.analysis.errors import (
    AllEqual,
    ConstantItem,
    DependentItems,
    NotFinite,
    NotPositiveDefinite,
    TooFewRows,
    WrongShape,
)

__all__ = [
    "any_row",
    "constant_columns",
    "dependent_columns",
    "finite_scores",
    "require_independent",
    "require_varying",
]

DEPENDENT = 1e-10  # smallest eigenvalue of a correlation matrix below which it counts as singular


def finite_scores(
    scores: ArrayLike, items: Sequence[str] | None = None, *, rows: int = 2
) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Scores as (n, p) float64 with the items' names.

    Raises NotFinite for a missing or infinite score, TooFewRows below `rows`, WrongShape.
    """
    table = np.asarray(scores, dtype=np.float64)
    if table.ndim != 2 or table.shape[1] == 0:
        raise WrongShape(
            f"scores have the shape {table.shape} – give one row per answer, one column per item"
        )
    names = (
        tuple(items) if items is not None else tuple(f"item_{column + 1}" for column in range(table.shape[1]))
    )
    if len(names) != table.shape[1]:
        raise WrongShape(f"{len(names)} names for {table.shape[1]} items – give one each")
    bad = any_row(~np.isfinite(table))
    if bad.any():
        worst = [name for name, flag in zip(names, bad, strict=True) if flag]
        raise NotFinite(f"{', '.join(worst)}: missing or infinite scores – complete or drop them", worst)
    if len(table) < rows:
        raise TooFewRows(f"{len(table)} complete answers – this needs at least {rows}")
    return table, names


def any_row(flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(p,) True where a column of flags (n, p) holds at least one."""
    return np.asarray(flags.any(axis=0), dtype=np.bool_)


def constant_columns(table: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(p,) True where a column holds one value only; exact, so rounding cannot hide or invent one."""
    return ~any_row(table != table[0])


def require_varying(table: NDArray[np.float64], names: Sequence[str]) -> None:
    """Raises AllEqual or ConstantItem."""
    constant = constant_columns(table)
    if constant.all():
        raise AllEqual("every item has the same score in all answers – nothing can be correlated", names)
    if constant.any():
        still = [name for name, flag in zip(names, constant, strict=True) if flag]
        raise ConstantItem(f"{', '.join(still)}: the same score in all answers – drop it", still)


def dependent_columns(correlation: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(p,) True for the items that take part in a linear dependency; all False where there is none."""
    values, vectors = np.linalg.eigh(correlation)
    null = vectors[:, values < DEPENDENT]
    return any_row((np.abs(null) > 1e-6).T)


def require_independent(correlation: NDArray[np.float64], names: Sequence[str]) -> None:
    """Raises DependentItems naming the items that follow from each other, or NotPositiveDefinite."""
    least = float(np.linalg.eigvalsh(correlation)[0])
    if least < -DEPENDENT:
        raise NotPositiveDefinite(
            f"the correlations contradict each other (smallest eigenvalue {least:.3g}), as those of differing answers"
            " may – use complete answers (listwise) and Pearson",
            names,
        )
    dependent = dependent_columns(correlation)
    if dependent.any():
        tied = [name for name, flag in zip(names, dependent, strict=True) if flag]
        raise DependentItems(f"{', '.join(tied)}: one follows exactly from the others – drop one", tied)
