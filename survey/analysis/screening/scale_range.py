"""Scores that the questionnaire's scale does not have: a slip of the hand, or a code that means "no score"."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from survey.analysis.screening.preparation import Note, named
from survey.questionnaire import UNSEEN

__all__ = ["off_scale"]

SHOWN = 6  # different values that a note spells out


def off_scale(table: NDArray[np.float64], names: Sequence[str], points: int) -> list[Note]:
    """Notes on scores (n, p) that are not one of 1, 2, … points; NaN is a gap and none of them.

    Items whose only such value is the code for "not seen" of our own .sav stand in a note of their own.
    """
    beside = ~np.isnan(table) & ((table < 1) | (table > points) | (table != np.rint(table)))
    code = beside & (table == UNSEEN)
    touched = beside.any(axis=0)
    coded = touched & (beside == code).all(axis=0)
    notes = []
    if (wrong := touched & ~coded).any():
        found = table[:, wrong][beside[:, wrong]]
        values = np.unique(found)
        shown = ", ".join(f"{value:.6g}" for value in values[:SHOWN]) + (" …" if len(values) > SHOWN else "")
        text = (
            f"{len(found)} scores off the scale of 1 to {points} ({shown}); they count as they stand – correct them,"
            " and empty the cells where there is no score"
        )
        told = {"count": len(found), "points": points, "values": shown}
        notes.append(Note("off_scale", named(names, wrong), text, told))
    if coded.any():
        count = int(code[:, coded].sum())
        text = (
            f"{count} times {UNSEEN}, off the scale of 1 to {points}: the code of our SPSS export for 'not seen',"
            " which counts as a score here – leave it out: empty those cells, or before SPSS writes the CSV"
            f" RECODE {named(names, coded)[0]} … ({UNSEEN} = SYSMIS)"
        )
        told = {"count": count, "points": points, "unseen": UNSEEN, "item": named(names, coded)[0]}
        notes.append(Note("off_scale", named(names, coded), text, told, "unseen"))
    return notes
