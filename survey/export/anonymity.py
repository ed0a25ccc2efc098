"""k-anonymity: what is known of a visitor beside the answers is made coarse until at least k share all of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from survey.errors import SurveyError
from survey.store.answers import ABSENT, Columns, Heads

__all__ = ["LEFT_OUT", "LEVELS", "Anonymity", "Hidden", "TooFew", "hide"]

LEFT_OUT = "left out"

# What could single somebody out who is known to have answered, each from fine to coarse. "asked" are the items that
# the place had nothing for at the time: by when a part opened they tell when somebody came.
LEVELS = {
    "received": ("hour", "day", "week", "month", LEFT_OUT),
    "exhibit": ("kept", LEFT_OUT),
    "language": ("kept", LEFT_OUT),
    "asked": ("kept", LEFT_OUT),
}
# What is lost with each level: times are made coarse first, whole items are left out last.
_LOSS = {"received": (0, 1, 2, 3, 4), "exhibit": (0, 5), "language": (0, 6), "asked": (0, 12)}
_MOST_SUPPRESSED = 100  # at most one answer in so many, and only where that keeps a column


class TooFew(SurveyError):
    """There are fewer answers than are to be alike."""


@dataclass(frozen=True)
class Anonymity:
    """What was done. levels: column → one of LEVELS; answers: before; suppressed: how many of them were left out."""

    k: int
    levels: dict[str, str]
    answers: int
    suppressed: int

    def told(self) -> str:
        """All of it in one line of ASCII, as the files and the header carry it."""
        columns = "; ".join(f"{column}: {level}" for column, level in self.levels.items())
        rows = f"suppressed: {self.suppressed} of {self.answers} answers"
        return f"k = {self.k}; {columns}; {rows}; submission and suggestions: {LEFT_OUT}; rows shuffled"


@dataclass(frozen=True)
class Hidden:
    """Which answers go out, in a random order: (m,) places in the columns; time: (m,) when, as coarse as told."""

    anonymity: Anonymity
    rows: NDArray[np.int64]
    time: NDArray[np.str_]


def hide(columns: Columns, heads: Heads, k: int, rng: np.random.Generator) -> Hidden:
    """Coarsen until every combination of what LEVELS names stands in at least k answers; then shuffle.

    A level holds for all answers alike. Answers are suppressed only where that keeps a column from being left out
    whole, and never more than one in a hundred. rng: draws the order of the rows. Raises TooFew below k answers.

    Scores are no part of what is made alike: who knows what somebody answered finds the row.
    Sweeney, k-anonymity: a model for protecting privacy, 2002 (full-domain generalisation).
    """
    n = len(columns.ids)
    if n < k:
        raise TooFew(f"{n} answers cannot be hidden among {k} – wait for more, or take a smaller k")
    codes = {column: list(_codes(column, columns, heads)) for column in LEVELS}
    levels, kept = _chosen(codes, n, k)
    named = {column: LEVELS[column][level] for column, level in levels.items()}
    rows = rng.permutation(np.flatnonzero(kept))
    time = coarse_time(heads.received[rows], named["received"])
    return Hidden(Anonymity(k, named, n, n - len(rows)), rows, time)


@dataclass(frozen=True)
class _Candidate:
    """Levels and the answers (n,) that stay with them. loss: how much is made coarse; gone: columns left out."""

    levels: dict[str, int]
    kept: NDArray[np.bool_]
    loss: int
    gone: int
    suppressed: int


def _chosen(
    codes: dict[str, list[NDArray[np.int64]]], n: int, k: int
) -> tuple[dict[str, int], NDArray[np.bool_]]:
    """The levels that lose least, and the answers (n,) that stay."""
    found = []
    for at in product(*(range(len(levels)) for levels in LEVELS.values())):
        chosen = dict(zip(LEVELS, at, strict=True))
        kept = _shared([codes[column][level] for column, level in chosen.items()], n, k)
        gone = sum(LEVELS[column][level] == LEFT_OUT for column, level in chosen.items())
        loss = sum(_LOSS[column][level] for column, level in chosen.items())
        found.append(_Candidate(chosen, kept, loss, gone, n - int(kept.sum())))
    best = min((one for one in found if one.suppressed == 0), key=lambda one: one.loss)
    rare = [one for one in found if 0 < one.suppressed <= n // _MOST_SUPPRESSED and one.gone < best.gone]
    taken = min(rare, key=lambda one: (one.gone, one.loss, one.suppressed), default=best)
    return taken.levels, taken.kept


def _shared(codes: list[NDArray[np.int64]], n: int, k: int) -> NDArray[np.bool_]:
    """(n,) whether at least k answers have the same codes."""
    group = np.zeros(n, dtype=np.int64)
    for code in codes:
        group = np.unique(group * (int(code.max(initial=0)) + 1) + code, return_inverse=True)[1].ravel()
    return np.bincount(group)[group] >= k


def _codes(column: str, columns: Columns, heads: Heads) -> Iterator[NDArray[np.int64]]:
    """(n,) whole numbers from 0 for each level of the column: equal where the level makes two answers alike."""
    n = len(columns.ids)
    for level in LEVELS[column]:
        if level == LEFT_OUT:
            yield np.zeros(n, dtype=np.int64)
            continue
        if column == "received":
            seen = _since(heads.received, level)
        elif column == "asked":
            packed = np.packbits(columns.scores != ABSENT, axis=1)
            yield np.unique(packed, axis=0, return_inverse=True)[1].ravel()
            continue
        else:
            seen = heads.exhibit if column == "exhibit" else heads.language
        yield np.unique(seen, return_inverse=True)[1].ravel()


def _since(received: NDArray[np.datetime64], level: str) -> NDArray[np.int64]:
    """(n,) hours, days, weeks from Monday on, or months since 1970, UTC."""
    if level == "week":
        return (received.astype("datetime64[D]").astype(np.int64) + 3) // 7  # 1970 began on a Thursday
    unit = {"hour": "h", "day": "D", "month": "M"}[level]
    return received.astype(f"datetime64[{unit}]").astype(np.int64)


def coarse_time(received: NDArray[np.datetime64], level: str) -> NDArray[np.str_]:
    """(m,) such as 2026-03-04T05, 2026-03-04, 2026-W10, 2026-03, or empty; UTC."""
    if level == LEFT_OUT:
        return np.full(len(received), "", dtype=np.str_)
    if level != "week":
        unit = {"hour": "h", "day": "D", "month": "M"}[level]
        return np.datetime_as_string(received.astype(f"datetime64[{unit}]"))
    days, at = np.unique(received.astype("datetime64[D]"), return_inverse=True)
    weeks = ["{}-W{:02}".format(*day.isocalendar()) for day in days.tolist()]
    return np.array(weeks, dtype=np.str_)[at.ravel()]
