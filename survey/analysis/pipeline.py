"""The paper's procedure in its order, from a table of scores to one `Analysis`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.analysis.adequacy import Adequacy, adequacy
from survey.analysis.checks import any_row, constant_columns, finite_scores
from survey.analysis.components import Components, principal_components
from survey.analysis.correlation import Correlation, correlate
from survey.analysis.errors import AllEqual, AnalysisError, NotFinite, TooFewRows
from survey.analysis.reliability import Reliability, reliability

__all__ = ["Analysis", "Note", "analyse"]

PAIR_R, PAIR_P = 0.93, 0.01  # the paper's second pair stands at exactly .930, so r ≥ .93 at three decimals


@dataclass(frozen=True)
class Note:
    """Something the reader must know beside the numbers."""

    code: str
    items: tuple[str, ...]
    message: str


@dataclass(frozen=True)
class Analysis:
    """Everything that was computed; a part that could not be is None, and a note says why.

    mean, sd, answered: (p,) over all items, from every score that is there. correlation: over the items
    `correlated`. adequacy, components, reliability: over the items `factored`. n: complete answers used.
    """

    n: int
    items: tuple[str, ...]
    dropped: tuple[str, ...]
    mean: NDArray[np.float64]
    sd: NDArray[np.float64]
    answered: NDArray[np.int64]
    correlated: tuple[str, ...]
    correlation: Correlation | None
    factored: tuple[str, ...]
    adequacy: Adequacy | None
    components: Components | None
    reliability: Reliability | None
    notes: tuple[Note, ...] = field(default=())


def analyse(
    scores: ArrayLike,
    items: Sequence[str] | None = None,
    *,
    drop: Sequence[str] = (),
    keep: int | None = None,
) -> Analysis:
    """Run the whole procedure on scores (n, p); NaN is a missing score, and such an answer is left out whole.

    drop: items to leave out of KMO, Bartlett, components and α. keep: number of components, None for Kaiser's.
    Raises NotFinite for infinite scores or an item without any, TooFewRows below two complete answers,
    AllEqual when nothing varies, AnalysisError for an unknown item in `drop`. What stops a single step only
    (a constant item, dependent items, n ≤ p) becomes a note and leaves that step None.
    """
    table, names, notes = _complete_rows(scores, items)
    unknown = [name for name in drop if name not in names]
    if unknown:
        raise AnalysisError(
            f"{', '.join(unknown)}: no such item to drop – the items are {', '.join(names)}", unknown
        )
    complete = table[~np.isnan(table).any(axis=1)]
    varying = ~constant_columns(complete)
    if not varying.any():
        raise AllEqual("every item has the same score in all answers – nothing can be correlated", names)
    if not varying.all():
        still = _named(names, ~varying)
        notes.append(Note("constant_item", still, "the same score in all answers; kept in the means only"))
    correlated = _named(names, varying)
    correlation = _step(notes, lambda: correlate(complete[:, varying], correlated))
    if correlation is not None:
        notes += _close_pairs(correlation, correlated)
    used = varying & ~np.isin(names, list(drop))
    factored = _named(names, used)
    fit, components, alpha = _factor(complete[:, used], factored, keep, notes)
    mean, sd, answered = _descriptives(table)
    dropped = tuple(name for name in names if name in drop)
    return Analysis(
        len(complete), names, dropped, mean, sd, answered, correlated, correlation, factored, fit, components, alpha,
        tuple(notes),
    )  # fmt: skip


def _complete_rows(
    scores: ArrayLike, items: Sequence[str] | None
) -> tuple[NDArray[np.float64], tuple[str, ...], list[Note]]:
    table = np.asarray(scores, dtype=np.float64)
    _, names = finite_scores(np.nan_to_num(table, nan=0.0, posinf=0.0, neginf=0.0), items, rows=0)
    infinite = _named(names, any_row(np.isinf(table)))
    if infinite:
        raise NotFinite(f"{', '.join(infinite)}: infinite scores – correct them", infinite)
    hollow = _named(names, ~any_row(~np.isnan(table))) if len(table) else ()
    if hollow:
        raise NotFinite(f"{', '.join(hollow)}: no scores at all – drop the item", hollow)
    gaps = np.isnan(table)
    complete = int((~gaps.any(axis=1)).sum())
    if complete < 2:
        raise TooFewRows(f"{complete} complete answers – an analysis needs at least two")
    notes = []
    if gaps.any():
        message = (
            f"{len(table) - complete} of {len(table)} answers have gaps and are left out whole (listwise)"
        )
        notes.append(Note("missing", _named(names, any_row(gaps)), message))
    return table, names, notes


def _descriptives(table: NDArray[np.float64]) -> tuple[NDArray, NDArray, NDArray]:
    answered = (~np.isnan(table)).sum(axis=0)
    mean = np.nanmean(table, axis=0)
    spread = np.nansum((table - mean) ** 2, axis=0)
    return mean, np.sqrt(spread / np.maximum(answered - 1, 1)), answered


def _factor(
    table: NDArray[np.float64], names: tuple[str, ...], keep: int | None, notes: list[Note]
) -> tuple[Adequacy | None, Components | None, Reliability | None]:
    n, p = table.shape
    if p < 2:
        notes.append(Note("too_few_items", names, "fewer than two items are left; nothing to factor"))
        return None, None, None
    alpha = _step(notes, lambda: reliability(table, names))
    if n <= p:
        notes.append(Note("too_few_rows", (), f"{n} answers for {p} items: no KMO, Bartlett or components"))
        return None, None, alpha
    if n == p + 1:
        notes.append(
            Note("barely_enough_rows", (), f"{n} answers for {p} items: KMO and Bartlett mean little here")
        )
    if n < 50:
        message = f"with {n} answers loadings are uncertain by about ± .2, and the number of components is a coin toss"
        notes.append(Note("small_sample", (), message))
    fit = _step(notes, lambda: adequacy(table, names))
    components = _step(notes, lambda: principal_components(correlate(table, names).r, keep=keep))
    if components is not None and (components.communalities >= 1.0 - 1e-9).any() and components.kept < p:
        over = _named(names, components.communalities >= 1.0 - 1e-9)
        notes.append(Note("heywood", over, "a communality of 1: the components leave nothing of the item"))
    return fit, components, alpha


def _step(notes: list[Note], compute):
    """The result of one step, or None and a note that says why there is none."""
    try:
        return compute()
    except AnalysisError as error:
        notes.append(Note(error.code, error.items, str(error)))
        return None


def _close_pairs(correlation: Correlation, names: tuple[str, ...]) -> list[Note]:
    """Pairs that say nearly the same; a person chooses which of the two to drop."""
    return [
        Note(
            "close_pair",
            (names[i], names[j]),
            f"r = {correlation.r[i, j]:.3f}: consider dropping one of the two",
        )
        for i, j in combinations(range(len(names)), 2)
        if round(correlation.r[i, j], 3) >= PAIR_R and correlation.p[i, j] < PAIR_P
    ]


def _named(names: Sequence[str], flags: NDArray[np.bool_]) -> tuple[str, ...]:
    return tuple(name for name, flag in zip(names, flags, strict=True) if flag)
