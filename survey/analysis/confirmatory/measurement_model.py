"""A measurement model: which factor is measured by which items. Written as text in the syntax of R's lavaan.

    F1 =~ a + b + c        F1 is measured by a, b and c; the first one's loading is fixed to 1
    a ~~ b                 what a and b have in common beside their factors (a residual covariance)
    F1 ~~ 0*F2             F1 and F2 are not correlated

Lines, or parts between semicolons; # begins a comment.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from survey.analysis.components import Components
from survey.analysis.errors import BadModel, NotIdentified, TooFewItems, UnknownItem

__all__ = ["Measurement", "explored", "parsed", "require_identified"]

NAME = r"[^\W\d][\w.\-]*"
_SYNTAX = 'write it as in "F1 =~ a + b + c; F2 =~ d + e + f; a ~~ b"'


@dataclass(frozen=True)
class Measurement:
    """factors: (name, items) in their order, the first item's loading is 1. An item may stand in several factors.

    residuals: pairs of items with a residual covariance. apart: pairs of factors that are not correlated.
    """

    factors: tuple[tuple[str, tuple[str, ...]], ...]
    residuals: tuple[tuple[str, str], ...] = ()
    apart: tuple[tuple[str, str], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(name for name, _ in self.factors)

    @property
    def items(self) -> tuple[str, ...]:
        """Every item once, in the order in which the factors name them."""
        return tuple(dict.fromkeys(item for _, items in self.factors for item in items))

    @property
    def shared(self) -> tuple[str, ...]:
        """Items that measure more than one factor."""
        named = [item for _, items in self.factors for item in items]
        return tuple(item for item in self.items if named.count(item) > 1)

    @property
    def correlated(self) -> tuple[tuple[str, str], ...]:
        """Pairs of factors whose covariance is estimated."""
        none = {frozenset(pair) for pair in self.apart}
        return tuple(pair for pair in combinations(self.names, 2) if frozenset(pair) not in none)

    @property
    def text(self) -> str:
        """The model as `parsed` reads it, and lavaan."""
        parts = [f"{name} =~ {' + '.join(items)}" for name, items in self.factors]
        parts += [f"{a} ~~ {b}" for a, b in self.residuals] + [f"{a} ~~ 0*{b}" for a, b in self.apart]
        return "; ".join(parts)

    def freedom(self) -> int:
        """Degrees of freedom on covariances: p (p + 1) / 2 less the free parameters. Below 0: not identified."""
        p, k = len(self.items), len(self.factors)
        loadings = sum(len(items) - 1 for _, items in self.factors)
        return p * (p + 1) // 2 - (loadings + k + len(self.correlated) + p + len(self.residuals))

    def without(self, dropped: Sequence[str]) -> Measurement:
        """The model without some items, and without the factors that have none left."""
        left = tuple((name, tuple(i for i in items if i not in dropped)) for name, items in self.factors)
        factors = tuple((name, items) for name, items in left if items)
        names = {name for name, _ in factors}
        return Measurement(
            factors,
            tuple(pair for pair in self.residuals if not set(pair) & set(dropped)),
            tuple(pair for pair in self.apart if set(pair) <= names),
        )


def parsed(text: str) -> Measurement:
    """The model that a text states. Raises BadModel naming the part that is wrong."""
    factors: dict[str, list[str]] = {}
    covariances: list[tuple[str, str, str]] = []
    lines = [line.split("#")[0] for line in text.splitlines()]
    for part in (part.strip() for line in lines for part in line.split(";")):
        if not part:
            continue
        if found := re.fullmatch(rf"({NAME})\s*=~\s*(.+)", part):
            factors.setdefault(found[1], []).extend(_listed(part, found[2]))
        elif found := re.fullmatch(rf"({NAME})\s*~~\s*(0\s*\*\s*)?({NAME})", part):
            covariances.append((found[1], "0" if found[2] else "", found[3]))
        else:
            raise BadModel(f"{part[:60]!r}: neither =~ nor ~~ between names – {_SYNTAX}")
    if not factors:
        raise BadModel(f"the model names no factor – {_SYNTAX}")
    return _put_together({name: tuple(items) for name, items in factors.items()}, covariances)


def explored(components: Components, items: Sequence[str]) -> Measurement:
    """Each item with the component on which it loads most, as an exploratory analysis found them.

    Raises TooFewItems where a component is left with fewer than two items.
    """
    home = np.abs(components.loadings).argmax(axis=1)
    factors = []
    for at in range(components.kept):
        own = [item for row, item in enumerate(items) if home[row] == at]
        if len(own) < 2:
            raise TooFewItems(
                f"component {at + 1} is the first choice of {len(own)} items – ask for fewer components", own
            )
        factors.append((f"F{at + 1}", tuple(own)))
    return Measurement(tuple(factors))


def require_identified(model: Measurement, known: Sequence[str]) -> None:
    """Counts before anything is fitted.

    Raises UnknownItem, NotIdentified: a factor of one item, a factor of two that nothing else is tied to, or more
    parameters than the items have covariances.
    """
    unknown = [item for item in model.items if item not in known]
    if unknown:
        raise UnknownItem(
            f"{', '.join(unknown)}: no such item for the model – the items are {', '.join(known)}", unknown
        )
    tied = {name for pair in model.correlated for name in pair}
    for name, items in model.factors:
        others = {item for other, theirs in model.factors if other != name for item in theirs}
        need = 2 if name in tied or others & set(items) else 3
        if len(items) < need:
            why = "that is correlated with another" if need == 2 else "that stands alone"
            raise NotIdentified(
                f"{name}: {len(items)} items, a factor {why} needs at least {need} – add items, or join factors",
                items,
            )
    if (freedom := model.freedom()) < 0:
        raise NotIdentified(
            f"the model has {-freedom} more parameters than {len(model.items)} items have variances and covariances"
            " – take out residual covariances or cross-loadings",
            model.items,
        )


def _listed(part: str, text: str) -> list[str]:
    names = [name.strip() for name in text.split("+")]
    for name in names:
        if not re.fullmatch(NAME, name):
            what = "fixed or labelled loadings are not taken" if "*" in name else f"{name[:30]!r} is no name"
            raise BadModel(f"{part[:60]!r}: {what} – {_SYNTAX}")
    return names


def _put_together(
    factors: dict[str, tuple[str, ...]], covariances: list[tuple[str, str, str]]
) -> Measurement:
    items = {item for own in factors.values() for item in own}
    if both := sorted(items & set(factors)):
        raise BadModel(f"{both[0]}: is a factor and an item at once – factors of factors are not taken")
    for name, own in factors.items():
        if twice := sorted({item for item in own if own.count(item) > 1}):
            raise BadModel(f"{name}: names {twice[0]} twice – name it once")
    residuals: list[tuple[str, str]] = []
    apart: list[tuple[str, str]] = []
    for a, fixed, b in covariances:
        told = f"{a} ~~ {fixed and '0*'}{b}"
        if a == b:
            raise BadModel(f"{told}: variances are always estimated – leave the line out")
        if a in items and b in items and not fixed:
            residuals.append((a, b))
        elif a in factors and b in factors:
            apart += [(a, b)] if fixed else []  # factors are correlated unless told otherwise
        else:
            raise BadModel(f"{told}: takes two items, or two factors (0* keeps those apart) – {_SYNTAX}")
    if len({frozenset(pair) for pair in residuals}) < len(residuals):
        raise BadModel("a residual covariance stands twice – name it once")
    return Measurement(tuple(factors.items()), tuple(residuals), tuple(apart))
