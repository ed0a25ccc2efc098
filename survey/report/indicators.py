"""The way from 25 indicators to 12 and to 10 (III.B.1–3): what became of each, and what the scores say of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from survey.analysis import Analysis, correlate, reliability
from survey.demonstration import CLOSE, Primary, intermediate, merged, primary, sample_file, sample_name
from survey.scores import read_scores

__all__ = ["Evidence", "Pair", "Way", "evidence", "way_of"]


@dataclass(frozen=True)
class Evidence:
    """What the synthetic sample says of a primary indicator.

    beside: the intermediate indicator nearest to a deleted one, else what it was merged into; r: with that, for a
    merged one with the sum of the other parts (corrected item-total); None where it stands for itself.
    """

    beside: str
    r: float | None


@dataclass(frozen=True)
class Pair:
    """Two intermediate items too close to keep both. r: here, printed in the paper, in the synthetic sample."""

    items: tuple[str, str]
    r: float | None
    printed: float | None
    synthetic: float


@dataclass(frozen=True)
class Way:
    """lanes: the intermediate items, of each pair the second beside the first; final: those that are analysed."""

    primary: tuple[Primary, ...]
    lanes: tuple[str, ...]
    final: tuple[str, ...]
    pairs: tuple[Pair, ...]
    close: frozenset[tuple[str, str]]


def way_of(found: Analysis) -> Way | None:
    """The way of an analysis over the intermediate items; None where it is not over all of them."""
    if not set(intermediate()) <= set(found.items):
        return None
    close = [(note.items[0], note.items[1]) for note in found.notes if note.code == "close_pair"]
    lanes = list(found.items)
    for one, other in close:
        stays, goes = (other, one) if one in found.dropped and other not in found.dropped else (one, other)
        lanes.remove(goes)
        lanes.insert(lanes.index(stays) + 1, goes)
    printed = {frozenset((item, twin)): r for item, twin, r in CLOSE}
    known = [frozenset(pair) for pair in close]
    pairs = [*close, *((twin, item) for item, twin, _ in CLOSE if frozenset((item, twin)) not in known)]
    told = tuple(
        Pair(pair, _here(found, pair), printed.get(frozenset(pair)), _synthetic(pair)) for pair in pairs
    )
    return Way(primary(), tuple(lanes), found.factored, told, frozenset(close))


@lru_cache(maxsize=1)
def evidence() -> tuple[Evidence, ...]:
    """Of each primary indicator, computed from the synthetic sample."""
    table = read_scores(sample_file(sample_name()))
    parts, items = intermediate(), list(intermediate())
    twelve = merged(table.scores, table.items, items)
    told = []
    for at, one in enumerate(primary()):
        if one.into is None:
            r = correlate(np.column_stack([table.scores[:, at], twelve])).r[0, 1:]
            told.append(Evidence(items[int(r.argmax())], float(r.max())))
        elif len(parts[one.into]) == 1:
            told.append(Evidence(one.into, None))
        else:
            columns = [table.items.index(part) for part in parts[one.into]]
            total = reliability(table.scores[:, columns]).item_total
            told.append(Evidence(one.into, float(total[parts[one.into].index(one.id)])))
    return tuple(told)


def _here(found: Analysis, pair: tuple[str, str]) -> float | None:
    if found.correlation is None:
        return None
    i, j = (found.items.index(item) for item in pair)
    return float(found.correlation.r[i, j])


@lru_cache(maxsize=64)
def _synthetic(pair: tuple[str, str]) -> float:
    table = read_scores(sample_file(sample_name()))
    return float(correlate(merged(table.scores, table.items, pair)).r[0, 1])
