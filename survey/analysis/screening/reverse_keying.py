"""Reverse-keyed items: their scores turned to low + high − score, so that all items of a scale point one way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from survey.analysis.errors import UnknownItem
from survey.analysis.screening.preparation import Note, Prepared

__all__ = ["Turned", "turned", "turned_scores", "turned_table"]


@dataclass(frozen=True)
class Turned:
    """items: in the table's order; total: lowest + highest point, from which their scores were taken."""

    items: tuple[str, ...] = ()
    total: float = 0.0


def turned(
    ready: Prepared, reverse: Sequence[str], points: int | None, notes: list[Note]
) -> tuple[Prepared, Turned]:
    """The prepared table with the scores of `reverse` turned, and which these were. Raises UnknownItem."""
    used = [name not in ready.dropped for name in ready.names]
    table, found = turned_table(ready.table, ready.names, reverse, points, used, notes)
    return replace(ready, table=table), found


def turned_table(
    table: NDArray[np.float64],
    names: Sequence[str],
    reverse: Sequence[str],
    points: int | None,
    used: Sequence[bool],
    notes: list[Note],
) -> tuple[NDArray[np.float64], Turned]:
    """Scores (n, p) with those of `reverse` turned, and which these were.

    points: of the scale 1, 2, …; None takes the scale from the scores of the items that are `used` (p,), and the note
    says so. Raises UnknownItem.
    """
    unknown = [name for name in reverse if name not in names]
    if unknown:
        known = ", ".join(names)
        raise UnknownItem(f"{', '.join(unknown)}: no such item to reverse – the items are {known}", unknown)
    items = tuple(name for name in names if name in reverse)
    kept = table[:, list(used)]
    if not items or np.isnan(kept).all():
        return table, Turned()
    low, high = (1.0, float(points)) if points else (float(np.nanmin(kept)), float(np.nanmax(kept)))
    text = f"turned before everything else, their means too: {low + high:g} − score, on the scale {low:g} to {high:g}"
    if points is None:
        text += ", which is what the scores span – give --points if it has others"
    told = {"sum": f"{low + high:g}", "low": f"{low:g}", "high": f"{high:g}"}
    notes.append(Note("reversed", items, text, told, "" if points else "span"))
    return turned_scores(table, names, items, low + high), Turned(items, low + high)


def turned_scores(
    table: NDArray[np.float64], names: Sequence[str], reverse: Sequence[str], total: float
) -> NDArray[np.float64]:
    """Scores (n, p) with those of `reverse` turned to total − score; NaN stays."""
    return np.where(np.isin(list(names), list(reverse)), total - table, table)
