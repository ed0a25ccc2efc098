"""From a raw table to the rows and items that each step may use, with a note for everything left out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.analysis.checks import any_row, constant_columns, finite_scores
from survey.analysis.errors import AllEqual, NotFinite, TooFewItems, TooFewRows, UnknownItem
from survey.analysis.screening.careless import duplicates, hasty, straight_liners

__all__ = ["Flags", "Note", "Prepared", "asking", "flagged", "left_out", "likely_gaps", "named", "prepare"]

SHOWN = 12  # numbers of answers that a note spells out
LARGEST, SMALLEST = 1e100, 1e-100  # squares and their sums beyond leave what a float64 holds


@dataclass(frozen=True)
class Note:
    """Something the reader must know beside the numbers.

    message: in English. told: the figures in it, from which another language says the same, or None where the
    message is an error's. form: which of several sentences of the code it is.
    """

    code: str
    items: tuple[str, ...]
    message: str
    told: Mapping[str, object] | None = None
    form: str = ""


@dataclass(frozen=True)
class Flags:
    """Answers worth a second look, 0-based rows of the table; `hasty` is None where no times were given."""

    straight: NDArray[np.int64]
    duplicates: tuple[NDArray[np.int64], ...]
    hasty: NDArray[np.int64] | None


@dataclass(frozen=True)
class Prepared:
    """table: (n, p) as given. correlated, factored: (p,) items that vary, and of these the ones not dropped.

    pairwise: answers with gaps count with what they have; likely: by the correlations of greatest likelihood.
    """

    table: NDArray[np.float64]
    names: tuple[str, ...]
    dropped: tuple[str, ...]
    correlated: NDArray[np.bool_]
    factored: NDArray[np.bool_]
    pairwise: bool
    likely: bool = False

    def rows_of(self, items: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Scores of some items: of complete answers, or with pairwise deletion of all that have any."""
        part = self.table[:, items]
        gaps = np.isnan(part)
        return part[~gaps.all(axis=1)] if self.pairwise else part[~gaps.any(axis=1)]


def prepare(
    scores: ArrayLike, items: Sequence[str] | None, drop: Sequence[str], *, pairwise: bool
) -> tuple[Prepared, list[Note]]:
    """Check a table (n, p), NaN a missing score.

    Raises NotFinite for infinite or absurd scores or a kept item without any, TooFewRows below two usable answers,
    AllEqual when nothing varies, UnknownItem in `drop`, TooFewItems when all are dropped.
    """
    table = np.asarray(scores, dtype=np.float64)
    _, names = finite_scores(np.nan_to_num(table, nan=0.0, posinf=0.0, neginf=0.0), items, rows=0)
    unknown = [name for name in drop if name not in names]
    if unknown:
        raise UnknownItem(
            f"{', '.join(unknown)}: no such item to drop – the items are {', '.join(names)}", unknown
        )
    infinite = named(names, any_row(np.isinf(table)))
    if infinite:
        raise NotFinite(f"{', '.join(infinite)}: infinite scores – correct them", infinite)
    size = np.abs(np.nan_to_num(table, nan=0.0)).max(axis=0, initial=0.0)
    beyond = named(names, (size > LARGEST) | ((size > 0.0) & (size < SMALLEST)))
    if beyond:
        raise NotFinite(f"{', '.join(beyond)}: scores beyond 1e±100 – correct them", beyond)
    wanted = ~np.isin(names, list(drop))
    hollow = ~any_row(~np.isnan(table)) if len(table) else np.zeros(len(names), dtype=np.bool_)
    if (hollow & wanted).any():
        empty = named(names, hollow & wanted)
        raise NotFinite(f"{', '.join(empty)}: no scores at all – drop the item", empty)
    notes = _missing(table, names, wanted, pairwise)
    varying = _varying(table, names, wanted, hollow, pairwise, notes)
    dropped = named(names, ~wanted)
    if dropped:
        notes.append(
            Note("dropped", dropped, "left out by choice of KMO, Bartlett, components and reliability", {})
        )
    return Prepared(table, names, dropped, varying, varying & wanted, pairwise), notes


def asking(unasked: Mapping[str, int], names: Sequence[str], n: int) -> list[Note]:
    """What was not asked in any of the n answers, and what in some of them. unasked: item -> in how many it was not."""
    nowhere = tuple(item for item in unasked if item not in names)
    partly = tuple(item for item in unasked if item in names)
    notes = []
    if nowhere:
        text = "asked in no answer (no column, or the mark for it throughout) and left out"
        notes.append(Note("not_asked", nowhere, text, {}))
    if partly:
        least = n - max(unasked[item] for item in partly)
        text = f"not asked in all {n} answers, in {least} at least; where it was not, there is a gap"
        notes.append(Note("partly_asked", partly, text, {"all": n, "least": least}))
    return notes


def left_out(aside: Mapping[str, str]) -> list[Note]:
    """What of a foreign table was taken for no item. aside: column → "name", "scale" or "text", why."""
    said = {
        "name": "not taken for items, by what they are called",
        "scale": "not taken for items: most of their values lie beyond the scale of the others",
        "text": "not taken for items: they hold no numbers",
    }
    notes = []
    for why, text in said.items():
        columns = tuple(column for column, reason in aside.items() if reason == why)
        if columns:
            keep = (
                ""
                if why == "text"
                else f"; --keep {','.join(columns)} keeps them, --items names all that count"
            )
            notes.append(
                Note(
                    "no_item",
                    columns,
                    text + keep,
                    {"columns": ",".join(columns)},
                    "" if why == "name" else why,
                )
            )
    return notes


def _missing(
    table: NDArray[np.float64], names: tuple[str, ...], wanted: NDArray[np.bool_], pairwise: bool
) -> list[Note]:
    if not wanted.any():
        raise TooFewItems("every item is dropped – keep at least two")
    gaps = np.isnan(table[:, wanted])
    usable = int((~(gaps.all(axis=1) if pairwise else gaps.any(axis=1))).sum())
    if usable < 2:
        way = "answers" if pairwise else "complete answers"
        raise TooFewRows(f"{usable} {way} – an analysis needs at least two")
    if not gaps.any():
        return []
    touched = named(names, any_row(np.isnan(table)) & wanted)
    if pairwise:
        message = f"{int(gaps.sum())} gaps; each correlation uses the answers that have both items (pairwise)"
        return [Note("missing", touched, message, {"gaps": int(gaps.sum())}, "pairwise")]
    left = len(table) - usable
    message = f"{left} of {len(table)} answers have gaps and are left out whole (listwise)"
    return [Note("missing", touched, message, {"left": left, "all": len(table)})]


def _varying(
    table: NDArray[np.float64],
    names: tuple[str, ...],
    wanted: NDArray[np.bool_],
    hollow: NDArray[np.bool_],
    pairwise: bool,
    notes: list[Note],
) -> NDArray[np.bool_]:
    """(p,) items that vary among the answers used; a dropped item is judged by its own answers."""
    complete = ~np.isnan(table[:, wanted]).any(axis=1)
    varying = np.zeros(len(names), dtype=np.bool_)
    for item in np.flatnonzero(~hollow):
        column = table[complete, item] if wanted[item] and not pairwise else table[:, item]
        column = column[~np.isnan(column)]
        varying[item] = not constant_columns(column[:, None])[0]
    if not varying[wanted].any():
        raise AllEqual("every item has the same score in all answers – nothing can be correlated", names)
    still = named(names, ~varying & ~hollow)
    if still:
        notes.append(
            Note("constant_item", still, "the same score in all answers; kept in the means only", {})
        )
    return varying


def flagged(table: NDArray[np.float64], seconds: ArrayLike | None) -> tuple[Flags, list[Note]]:
    """Look for answers that nobody may have given with care; they stay in."""
    flags = Flags(
        straight_liners(table), tuple(duplicates(table)), None if seconds is None else hasty(table, seconds)
    )
    notes = []
    if len(flags.straight):
        text = f"{_numbers(flags.straight)}: the same score on every item; look at them, nothing is deleted"
        notes.append(Note("straight_line", (), text, _counted(flags.straight)))
    if flags.duplicates:
        groups = "; ".join(
            " = ".join(str(row + 1) for row in group[:SHOWN]) for group in flags.duplicates[:6]
        )
        more = " …" if len(flags.duplicates) > 6 else ""
        text = f"answers {groups}{more} agree in every score; look at them, nothing is deleted"
        notes.append(Note("duplicate_answer", (), text, {"groups": groups + more}))
    if flags.hasty is not None and len(flags.hasty):
        text = f"{_numbers(flags.hasty)}: less than 2 s an item; look at them, nothing is deleted"
        notes.append(Note("too_fast", (), text, _counted(flags.hasty)))
    return flags, notes


def _numbers(rows: NDArray[np.int64]) -> str:
    return "{count} answers (number {rows})".format(**_counted(rows))


def _counted(rows: NDArray[np.int64]) -> dict[str, object]:
    shown = ", ".join(str(row + 1) for row in rows[:SHOWN])
    return {"count": len(rows), "rows": shown + (" …" if len(rows) > SHOWN else "")}


def likely_gaps(note: Note) -> Note:
    """What the note on gaps says where the correlations are those of greatest likelihood; others as they are."""
    if note.code != "missing" or note.told is None:
        return note
    text = (
        "{gaps} gaps; the correlations are those that all scores make likeliest (EM). Right where gaps depend on"
        " nothing but what was answered; tests count the answers that have both items, and alpha and omega"
        " take each item's own standard deviation"
    )
    return Note("missing", note.items, text.format(**note.told), note.told, "em")


def named(names: Sequence[str], flags: NDArray[np.bool_]) -> tuple[str, ...]:
    """The names whose flag is set."""
    return tuple(name for name, flag in zip(names, flags, strict=True) if flag)
