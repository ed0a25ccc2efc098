"""A lift by its factors: which picks and which ends are alike, and what each kind of pick does at each kind of end.

A treadled cloth of twenty thousand ends and picks has four hundred million crossings but only as many kinds of ends as
shafts and as many kinds of picks as treadles. What is counted here, is counted by those kinds.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.draft.algebra import Harness, drawdown, kinds_of, lift_plan, smallest_period

__all__ = ["Factors"]

MOST_CORE = 80_000_000  # different picks x different ends: 80 MB


@dataclass(frozen=True, eq=False)
class Factors:
    """lift[p, e] = core[pick[p], end[e]].

    core: (kinds of picks, kinds of ends) bool, True where the warp lies on top; no two rows or columns are equal.
    pick: (picks,) and end: (ends,) int, the kind of each, numbered as they first appear.
    """

    core: np.ndarray
    pick: np.ndarray
    end: np.ndarray

    @classmethod
    def of_lift(cls, lift: np.ndarray) -> Factors:
        """Of a lift matrix (picks, ends) bool."""
        rows, pick = kinds_of(np.asarray(lift, bool))
        columns, end = kinds_of(np.ascontiguousarray(rows.T))
        return cls(np.ascontiguousarray(columns.T), pick, end)

    @classmethod
    def of_harness(cls, harness: Harness) -> Factors:
        """Of threading, tie-up and treadling, without weaving them out.

        Raises WeaveError where there are more than 80 million crossings of different picks and ends.
        """
        treadled, pick = kinds_of(harness.treadling)
        threaded, end = kinds_of(harness.threading)
        if len(treadled) * len(threaded) > MOST_CORE:
            raise WeaveError(
                f"draft of {len(pick):,} picks by {len(end):,} ends: {len(treadled):,} different picks by "
                f"{len(threaded):,} different ends – at most {MOST_CORE:,} crossings of different yarns are counted; "
                "give a part of it"
            )
        core, kind = kinds_of(_lifted(lift_plan(harness.tieup, treadled), threaded))
        columns, other = kinds_of(np.ascontiguousarray(core.T))
        return cls(np.ascontiguousarray(columns.T), kind[pick], other[end])

    @property
    def picks(self) -> int:
        return len(self.pick)

    @property
    def ends(self) -> int:
        return len(self.end)

    def lift(self, picks: slice = slice(None), ends: slice = slice(None)) -> np.ndarray:
        """The lift of a part of the cloth, of all of it without arguments: (picks, ends) bool."""
        return self.core[self.pick[picks]][:, self.end[ends]]

    @cached_property
    def periods(self) -> tuple[int, int]:
        """After how many picks and after how many ends the lift repeats; the last repeat may be cut off."""
        return smallest_period(self.pick.tolist()), smallest_period(self.end.tolist())

    def repeat(self) -> Factors:
        """The smallest repeat of which the whole is a multiple."""
        picks, ends = (
            period if count % period == 0 else count
            for period, count in zip(self.periods, (self.picks, self.ends), strict=True)
        )
        return Factors(self.core, self.pick[:picks], self.end[:ends])

    def counts(self) -> tuple[np.ndarray, np.ndarray]:
        """How many picks and how many ends are of each kind."""
        rows, columns = self.core.shape
        return np.bincount(self.pick, minlength=rows), np.bincount(self.end, minlength=columns)

    def loose(self) -> tuple[np.ndarray, np.ndarray]:
        """Numbers from 0 of the picks and of the ends that never change side: they would fall out."""
        picks = self.core.all(axis=1) | ~self.core.any(axis=1)
        ends = self.core.all(axis=0) | ~self.core.any(axis=0)
        return np.flatnonzero(np.take(picks, self.pick)), np.flatnonzero(np.take(ends, self.end))

    def float_counts(self) -> tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]:
        """How many cyclic floats there are of each length: (face, back) of the warp, (face, back) of the weft.

        counts[n] is the number of floats over n crossings; each side of the cloth as seen by its own yarn.
        """
        picks, ends = self.counts()
        return (
            _runs(self.core.T, self.pick, ends),
            _runs(~self.core, self.end, picks),
        )

    def hangs_together(self) -> bool:
        """Whether no part of the cloth can be lifted off the rest (Clapham 1980, Enns 1984), by counting.

        s ends and t picks that lie over everything else have, together, s (picks - t) + t (ends - s) + s t points on
        top: no choice of s ends and t picks has more. So the cloth falls apart exactly if the s ends and the t picks
        that are on top most often reach that number, for some s and t other than none and all.
        """
        rows, columns = self.counts()
        over = np.sort((rows @ self.core)[self.end])[::-1]  # of each end: picks that it passes over
        above = np.sort(((~self.core) @ columns)[self.pick])[::-1]  # of each pick: ends that it passes over
        ends, picks = self.ends, self.picks
        tops, sums = np.append(0, np.cumsum(over)), np.append(0, np.cumsum(above))
        s = np.arange(ends + 1)
        # for given s the best t takes every pick that passes over more than the ends - s that are left
        few = picks - np.searchsorted(above[::-1], ends - s, side="right")
        many = picks - np.searchsorted(above[::-1], ends - s, side="left")
        for t in (few, many):
            proper = ~((s == 0) & (t == 0)) & ~((s == ends) & (t == picks))
            if (proper & (tops[s] + sums[t] == s * picks + t * ends - s * t)).any():
                return False
        return True


def _lifted(plan: np.ndarray, threaded: np.ndarray) -> np.ndarray:
    """Which kind of end each kind of pick lifts: (kinds of picks, kinds of ends) bool."""
    if threaded.sum(axis=1).max() > 1:
        return drawdown(threaded, plan)
    lifted = plan[:, threaded.argmax(axis=1)]
    return lifted & threaded.any(axis=1)


def _runs(core: np.ndarray, along: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cyclic runs of True and of False of core[k][along], each counted `times[k]` times."""
    size = len(along)
    made = np.zeros((2, size + 1), dtype=np.int64)
    for row, count in zip(core, times, strict=True):
        if not count:
            continue
        side = row.take(along)
        starts = np.flatnonzero(side[1:] != side[:-1]) + 1
        if not starts.size:
            made[0 if side[0] else 1, size] += count
            continue
        around = (
            starts[0] + size - starts[-1]
        )  # the run that goes on over the border, if the border does not end it
        lengths = np.diff(starts)
        if side[0] != side[-1]:
            around -= starts[0]
            lengths = np.append(starts[0], lengths)
            first = side[0]
        else:
            first = side[starts[0]]
        for k, some in ((0, lengths[::2]), (1, lengths[1::2])):  # runs alternate between the sides
            found = np.bincount(some)
            made[k if first else 1 - k, : len(found)] += count * found
        made[0 if side[-1] else 1, around] += count
    return made[0], made[1]
