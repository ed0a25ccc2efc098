"""Reliability scale by scale: of the items of each component, and of each module or dimension that is stated.

α over all items says little where they measure several things: each of these is a scale of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from survey.analysis.components import Components, homes
from survey.analysis.consistency import Omega, Reliability, omega_of, reliability_of
from survey.analysis.correlation import Correlation
from survey.analysis.procedure.factoring import step
from survey.analysis.screening import Note

__all__ = ["Group", "Kind", "Scale", "grouped", "running_against", "scales_of"]

Kind = Literal["component", "module", "dimension"]
AGAINST = 0.3  # loading on a stated scale's own first component from which its sign is more than chance


@dataclass(frozen=True)
class Group:
    """Items that a questionnaire states to belong together. key: id of the module or dimension."""

    kind: Kind
    key: str
    items: tuple[str, ...]


@dataclass(frozen=True)
class Scale:
    """A group's reliability over n answers, those of the whole analysis; arrays (m,) in the order of its items.

    reliability: None for a single item or where a note says why; omega: None below three items too.
    """

    kind: Kind
    key: str
    items: tuple[str, ...]
    n: int
    reliability: Reliability | None
    omega: Omega | None


def grouped(names: Sequence[str], components: Components | None, stated: Sequence[Group]) -> list[Group]:
    """The items (p,) of each component, in the order of their loadings, then what is left of the stated groups."""
    groups = []
    if components is not None:
        home, order = homes(components), components.sorted_items()
        for column in range(components.kept):
            items = tuple(names[row] for row in order if home[row] == column)
            groups.append(Group("component", f"component_{column + 1}", items))
    for group in stated:
        groups.append(Group(group.kind, group.key, tuple(item for item in group.items if item in names)))
    return [group for group in groups if group.items]


def scales_of(
    groups: Sequence[Group],
    names: Sequence[str],
    covariance: NDArray[np.float64],
    found: Correlation | None,
    notes: list[Note],
) -> tuple[Scale, ...]:
    """α, ω and item-total correlations of each group, from covariances (p, p) and the factored correlations.

    A figure that cannot be becomes None and a note.
    """
    scales = []
    for group in groups:
        at = [names.index(item) for item in group.items]
        part, omega = np.ix_(at, at), None
        n = 0 if found is None else int(found.counts[part].min())
        alpha = None
        if len(at) > 1:
            alpha = step(notes, lambda part=part, items=group.items: reliability_of(covariance[part], items))
        if len(at) > 2 and found is not None:
            spread = np.sqrt(np.diag(covariance)[at])
            r = found.r[part]
            omega = step(notes, lambda r=r, s=spread, n=n, items=group.items: omega_of(r, s, n, items))
        scales.append(Scale(group.kind, group.key, group.items, n, alpha, omega))
    return tuple(scales)


def running_against(
    groups: Sequence[Group], names: Sequence[str], r: NDArray[np.float64], components: Components | None
) -> list[Note]:
    """A note on items that point the other way than those beside them; none is ever turned unasked.

    Of a stated group, as psych's check.keys: the loading on the group's own first component is negative, by more than
    chance. Of a component, where nothing is stated of the item: its main loading is, most of the component's being
    positive. Without either: the correlations with all others sum to less than nothing.
    """
    against: set[str] = set()
    stated = [group for group in groups if group.kind != "component" and len(group.items) > 2]
    for group in stated:
        at = [names.index(item) for item in group.items]
        first = _first(r[np.ix_(at, at)])
        against |= {group.items[row] for row in np.flatnonzero(first < -AGAINST).tolist()}
    if components is not None:
        judged = {item for group in stated for item in group.items}
        home = np.array(homes(components))
        main = components.loadings[np.arange(len(names)), home]
        # A column's sign is that of its sum, cross-loadings too; what counts here are the items that are at home.
        main = main * np.array([-1.0 if main[home == column].sum() < 0.0 else 1.0 for column in home])
        against |= {names[row] for row in np.flatnonzero(main < 0.0).tolist()} - judged
    if not groups:
        rest = r.sum(axis=0) - 1.0
        against = {names[row] for row in np.flatnonzero(rest < -1e-9).tolist()} if rest.sum() > 0 else set()
    if not against:
        return []
    items = tuple(name for name in names if name in against)
    text = (
        "run against the items beside them, and nothing is turned unasked; if they are worded the other way round,"
        f" give --reverse {','.join(items)} (over HTTP reverse=…, in the questionnaire's file reverse = true):"
        " α, ω and item-total correlations are meant for items that point one way"
    )
    return [Note("reversed_item", items, text, {"items": ",".join(items)})]


def _first(r: NDArray[np.float64]) -> NDArray[np.float64]:
    """Loadings on the first principal component of correlations (m, m), most of them positive."""
    values, vectors = np.linalg.eigh(r)
    loadings = vectors[:, -1] * np.sqrt(max(float(values[-1]), 0.0))
    return loadings * (-1.0 if loadings.sum() < 0.0 else 1.0)
