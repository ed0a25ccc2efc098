"""What may be told of scores without telling one visitor's: the rule alone, without any store.

The attacker reads every figure there ever was, knows who answered between which of them, knows this rule, and gave up
to KNOWN of the answers himself, some of which he may have taken back. A figure moves on only over a window of at least
STEP scores that the last one does not hold, and only where, whichever KNOWN of them are his, the others differ among
themselves: then each of the others may be the one who gave the higher score. Whether that is so is looked at again only
after STEP further scores, whatever came of it: where one score alone turned the verdict, it would be known. What was
withdrawn since the last figure stands alone between the two, so the sums must leave it every point of the scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

__all__ = ["KNOWN", "STEP", "Figure", "Reason", "Scores", "Shown", "decimals_of", "moved_on"]

STEP = 10  # scores, or answers, by which anything public moves on at least
KNOWN = 4  # answers that one attacker may have given
# Scores unlike the commonest one. With KNOWN + 1 "withheld" would itself say that all others are alike.
UNLIKE = KNOWN + 2
ROOM = 2  # sums that the others' scores keep on either side, beyond what the withdrawn ones may have been

# few: too few new scores; telling: a figure could pin some of them, or what was withdrawn.
Reason = Literal["few", "telling"]


def decimals_of(n: int) -> int:
    """Decimals that a mean of n scores supports: 1 up to 100, 2 up to 10,000 – its standard error is about s / √n."""
    decimals = 1
    while 100**decimals < n:
        decimals += 1
    return decimals


@dataclass(frozen=True)
class Figure:
    """A published mean of n scores, `units` × 10 ** -decimals; the sum it was made from is not kept."""

    n: int
    units: int
    decimals: int

    @classmethod
    def of(cls, n: int, total: int) -> Figure:
        """The mean of n ≥ 1 scores with that sum, rounded half up."""
        decimals = decimals_of(n)
        return cls(n, (2 * total * 10**decimals + n) // (2 * n), decimals)

    @property
    def mean(self) -> float:
        return self.units / 10**self.decimals

    @property
    def totals(self) -> tuple[int, int]:
        """The least and the greatest sum that is rounded to it."""
        scale = 2 * 10**self.decimals
        middle = 2 * self.n * self.units
        return -((self.n - middle) // scale), -(-(middle + self.n) // scale) - 1


@dataclass(frozen=True)
class Shown:
    """What is public of one item.

    figure: the last that was ever given, None: none yet. step: at which it was given; judged: at which it was last
    looked at whether there could be another. withheld: why there is no figure to be seen now, None: it is seen.
    """

    figure: Figure | None = None
    step: int = 0
    judged: int = 0
    withheld: Reason | None = "few"


@dataclass(frozen=True)
class Scores:
    """All scores of an item that stand: how often each point of the scale, lowest first.

    held: those of the last figure; seen: later ones that were looked at in vain; new: those since.
    """

    held: Sequence[int]
    seen: Sequence[int]
    new: Sequence[int]

    @property
    def fresh(self) -> list[int]:
        """Those that the last figure does not hold."""
        return [seen + new for seen, new in zip(self.seen, self.new, strict=True)]

    @property
    def n(self) -> int:
        return sum(self.held) + sum(self.seen) + sum(self.new)

    @property
    def total(self) -> int:
        every = zip(self.held, self.seen, self.new, strict=True)
        return sum(point * sum(times) for point, times in enumerate(every, 1))


def moved_on(last: Shown, step: int, scores: Scores) -> Shown:
    """What is public of an item from this step on.

    A figure that cannot be moved on stays as it is, unless something it holds was withdrawn: then it is seen no more.
    """
    gone = 0 if last.figure is None else last.figure.n - sum(scores.held)
    if sum(scores.new) < STEP:
        return replace(last, withheld="few") if gone and not last.withheld else last
    now = Figure.of(scores.n, scores.total)
    if _telling(last.figure, now, scores.fresh, gone):
        return replace(last, judged=step, withheld="telling" if gone or last.withheld else None)
    return Shown(now, step, step, None)


def _telling(last: Figure | None, now: Figure, fresh: Sequence[int], gone: int) -> bool:
    if sum(fresh) - max(fresh) < UNLIKE:
        return True
    return last is not None and gone > 0 and not _covered(last, now, fresh, gone)


def _covered(last: Figure, now: Figure, fresh: Sequence[int], gone: int) -> bool:
    """Whether each of `gone` withdrawn scores may have been any point, by what the two figures say.

    The difference of their sums, as they are rounded, is that of the fresh scores less the withdrawn ones. This looks
    at nothing else: the withdrawn ones are erased, and by where a rule on the fresh ones alone ends one could tell
    what was withdrawn. Of the fresh ones KNOWN may be the attacker's, with any scores.
    """
    points, others = len(fresh), sum(fresh) - KNOWN
    least, most = now.totals[0] - last.totals[1], now.totals[1] - last.totals[0]
    low, high = least - points * KNOWN + gone, most - KNOWN + points * gone
    return others + ROOM <= low and high <= points * others - ROOM
