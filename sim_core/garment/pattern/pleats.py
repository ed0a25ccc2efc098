"""Knife pleats: folds across a panel, how much cloth they take up, and which ply lies over which."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from scipy import ndimage
from scipy.spatial import KDTree

from sim_core.errors import OutlineError

__all__ = ["Opened", "Pleat", "Plies", "chords", "creased", "latches"]

Way = Literal["end", "begin"]
NEAR = 1e-6  # [m] from a fold, that lies on it
BISECTIONS = 40
FINE, SPREAD = (
    0.001,
    0.03,
)  # [m] between points of what lies over pleats, and over which its bends are rounded


@dataclass(frozen=True)
class Pleat:
    """Cloth folded back on itself and on again, at right angles to x: three plies for one.

    at: x [m] where it begins; depth [m] of each fold, so that it takes 2 depth of cloth; towards: the end of the
    panel, in x, that the outer fold points to; crease: [rad] that its folds may open to, pi for any.
    """

    at: float
    depth: float
    towards: Way = "end"
    crease: float = np.pi

    def folds(self) -> tuple[float, float]:
        """x [m] of the outer fold and of the inner one."""
        middle, far = self.at + self.depth, self.at + 2 * self.depth
        return (self.at, middle) if self.towards == "end" else (far, middle)

    def to_list(self) -> list[Any]:
        """A plain list that JSON can hold; `Pleat(*…)` reads it."""
        return [self.at, self.depth, self.towards, self.crease]


@dataclass(frozen=True)
class Plies:
    """A panel's stretches between folds as they lie pleated. n stretches.

    bounds (n + 1,): x [m] where they begin and end; places (n + 1,): where those come to lie [m] along the pleated
    panel, from the x of its begin on; ramps (n, 2, 2): how high each lies, as lines a + b place (in gaps between plies,
    and in gaps a metre) of which the highest counts, and 0. Of each fold, between the stretches, whether it is an outer
    one: outer (n - 1,), and which group of pleats it belongs to: group (n - 1,).

    Pleats side by side lean on each other like shingles. All plies between the outermost rise with one slope, two gaps
    a step, so that no ply meets another wherever a mesh has its vertices.
    """

    bounds: np.ndarray
    places: np.ndarray
    ramps: np.ndarray
    outer: np.ndarray
    group: np.ndarray

    @staticmethod
    def of(low: float, high: float, pleats: Sequence[Pleat]) -> Plies:
        """Of a panel from x = low to high [m]."""
        bounds, places = [low], [low]
        ramps, outer, groups = [_LEVEL.copy()], [], []
        for number, group in enumerate(_groups(pleats)):
            first, begins = len(ramps) - 1, len(places)
            for pleat in group:
                here = places[-1] + pleat.at - bounds[-1]
                if pleat.towards == "end":
                    bounds += [pleat.at, pleat.at + pleat.depth]
                    places += [here, here - pleat.depth]
                else:  # its folds lie at the far end of what it takes up
                    bounds += [pleat.at + pleat.depth, pleat.at + 2 * pleat.depth]
                    places += [here + pleat.depth, here]
                ramps += [_LEVEL.copy(), _LEVEL.copy()]
                outer += [pleat.towards == "end", pleat.towards == "begin"]
                groups += [number, number]
            _lean(ramps[first:], places[begins:], group)
        places.append(places[-1] + high - bounds[-1])
        folds = np.array(outer, bool), np.array(groups, np.int64)
        return Plies(np.array([*bounds, high]), np.array(places), np.array(ramps), *folds)

    def laid(self, x: np.ndarray) -> np.ndarray:
        """Where points at x (n,) [m] lie along the pleated panel [m]."""
        return np.interp(x, self.bounds, self.places)

    def numbers(self, x: np.ndarray) -> np.ndarray:
        """Which stretch (n,) points at x (n,) [m] belong to; -1 those on a fold."""
        found = np.clip(np.searchsorted(self.bounds, x, side="right") - 1, 0, len(self.ramps) - 1)
        return np.where((np.abs(x[:, None] - self.bounds[1:-1]) < NEAR).any(1), -1, found)

    def stacked(self) -> list[tuple[int, int]]:
        """Neighbouring stretches, of which the first lies over the second where both lie."""
        pairs = [(k, k + 1) for k in range(len(self.ramps) - 1)]
        return [(a, b) if self._high(a, b) > self._high(b, b) else (b, a) for a, b in pairs]

    def _high(self, ply: int, bound: int) -> float:
        ramp = self.ramps[ply]
        return float((ramp[:, 0] + ramp[:, 1] * self.places[bound]).max())

    def heights(self, x: np.ndarray) -> np.ndarray:
        """How many gaps above the undermost ply points at x (n,) [m] lie; on a fold the mean of both its plies."""
        place, found = self.laid(x), np.zeros(len(x))
        for aside in (-NEAR, NEAR):
            found += 0.5 * self._leaning(self._ply(x + aside), place)
        return found

    def _leaning(self, ply: np.ndarray, place: np.ndarray) -> np.ndarray:
        ramp = self.ramps[ply]
        return np.maximum(0.0, (ramp[..., 0] + ramp[..., 1] * place[:, None]).max(1))

    def opened(self, rise: float, gap: float) -> Opened:
        """The same with its outer folds `rise` [m] above its inner ones, plies being `gap` [m] apart besides: creases
        stand open, and it goes further."""
        x, high = [self.bounds[0]], [0.0]
        for k in range(len(self.ramps)):
            begin, end = self.bounds[k : k + 2]
            before = k > 0 and bool(self.outer[k - 1])
            after = k < len(self.outer) and bool(self.outer[k])
            if (
                not 0 < k < len(self.outer) or self.group[k - 1] != self.group[k]
            ):  # beside pleats: level, then a slope
                down = begin + self._slope(k - 1) if before else begin
                up = end - self._slope(k) if after else end
                if down <= up or not (before and after):  # where both slopes have no room it stays up
                    x += [min(down, end)] if before else []
                    x += [max(up, begin)] if after else []
                    high += [0.0] * (before + after)
            x.append(end)
            high.append(rise if after else 0.0)
        knots, rises = np.array(x), np.array(high)
        closed, ply = self.laid(knots), self._ply(0.5 * (knots[1:] + knots[:-1]))
        leaning = gap * (self._leaning(ply, closed[1:]) - self._leaning(ply, closed[:-1]))
        climbs = np.diff(rises) + leaning
        steps = np.sign(np.diff(closed)) * np.sqrt(np.maximum(np.diff(knots) ** 2 - climbs**2, 0.0))
        return Opened(self, gap, knots, self.places[0] + np.r_[0.0, np.cumsum(steps)], rises)

    def _ply(self, x: np.ndarray) -> np.ndarray:
        return np.clip(np.searchsorted(self.bounds, x, side="right") - 1, 0, len(self.ramps) - 1)

    def _slope(self, fold: int) -> float:
        """Length [m] of the slope beside an outermost fold, which is no ply of its own: as long as its neighbours."""
        of = np.flatnonzero(self.group == self.group[fold])
        lengths = np.diff(self.bounds[1:-1])[of[:-1]]
        return max(float(lengths.max()), 1.5 * float(lengths.min()))

    def as_wide(self, width: float, most: float, gap: float) -> Opened:
        """Opened until it is `width` [m] wide, but its outer folds no more than `most` [m] high."""
        low, high = 0.0, most
        if self.opened(most, gap).width <= self.opened(0.0, gap).width:  # a fold beside a short door
            return self.opened(0.0, gap)
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            if self.opened(middle, gap).width < width:
                low = middle
            else:
                high = middle
        return self.opened(low, gap)


@dataclass(frozen=True)
class Opened:
    """Pleats whose creases stand open, plies `gap` [m] apart besides. x (k,) [m] of their folds and of where they begin
    to rise; places (k,) and rises (k,) [m]: where those lie along the panel, and how high they stand above plies that
    lie closed."""

    plies: Plies
    gap: float
    x: np.ndarray
    places: np.ndarray
    rises: np.ndarray

    @property
    def width(self) -> float:
        """[m]"""
        return float(self.places[-1] - self.places[0])

    def laid(self, x: np.ndarray) -> np.ndarray:
        """Where points at x (n,) [m] lie along the panel [m]."""
        return np.interp(x, self.x, self.places)

    def finer(self, step: float) -> Opened:
        """The same with points `step` [m] apart at most."""
        parts = np.maximum(1, np.ceil(np.diff(self.x) / step).astype(int))
        shares = np.concatenate([k + np.arange(count) / count for k, count in enumerate(parts)])
        x, places, rises = (
            np.interp(np.r_[shares, len(parts)], np.arange(len(parts) + 1), told)
            for told in (self.x, self.places, self.rises)
        )
        return replace(self, x=x, places=places, rises=rises)

    def scaled(self, along: np.ndarray, middle: float) -> Opened:
        """The same, its stretches between points so many times (k - 1,) as long along the panel; its middle at [m]."""
        places = np.r_[0.0, np.cumsum(along * np.diff(self.places))]
        return replace(self, places=places + middle - 0.5 * places[-1])

    def heights(self, x: np.ndarray) -> np.ndarray:
        """How high [m] points at x (n,) [m] lie above the undermost ply."""
        return self.gap * self.plies.heights(x) + np.interp(x, self.x, self.rises)

    def over(self, places: np.ndarray, apart: float) -> np.ndarray:
        """How high [m] cloth lies at places (n,) [m] along the panel that is spread over it, `apart` [m] off, without a
        sharp bend; 0 where it has come down again beside it."""
        low, high = self.places.min() - 2.5 * SPREAD, self.places.max() + 2.5 * SPREAD
        grid = np.linspace(low, high, int((high - low) / FINE) + 1)
        top, window = np.zeros(len(grid)), 2 * int(SPREAD / FINE) + 1
        x = np.linspace(
            self.x[0], self.x[-1], int(np.ptp(self.x) / (0.5 * FINE)) + 1
        )  # no point of the grid without one
        at = np.rint((self.laid(x) - low) / (grid[1] - low)).astype(int)
        np.maximum.at(top, at, apart + self.heights(x))
        spread = ndimage.uniform_filter1d(ndimage.maximum_filter1d(top, window), window)
        return np.interp(places, grid, spread, left=0.0, right=0.0)


_LEVEL = np.array([[0.0, 0.0], [-np.inf, 0.0]])  # of a ply that lies under all others


def _groups(pleats: Sequence[Pleat]) -> list[list[Pleat]]:
    """Pleats in the order of x, those together that point the same way and lie on each other."""
    groups: list[list[Pleat]] = []
    for pleat in sorted(pleats, key=lambda pleat: pleat.at):
        last = groups[-1][-1] if groups else None
        if last and last.towards == pleat.towards and pleat.at - last.at - 2 * last.depth < pleat.depth:
            groups[-1].append(pleat)
        else:
            groups.append([pleat])
    return groups


def _lean(ramps: list[np.ndarray], places: list[float], group: Sequence[Pleat]) -> None:
    """Sets the lines (2, 2) by which the 2 n + 1 plies of n pleats rise, whose folds come to lie at `places` [m]."""
    count, depth = len(group), max(pleat.depth for pleat in group)
    outer = np.array(places[0::2] if group[0].towards == "end" else places[1::2])
    step = float(np.diff(outer).min()) if count > 1 else depth
    slope = 2.0 / step
    if group[0].towards == "begin":  # the same seen from the other end
        ramps, outer, slope = ramps[::-1], outer[::-1], -slope
    high = 2.0 / step * depth + 2.0  # of the outermost ply at its fold
    for k, ramp in enumerate(ramps[:-1]):
        line = [high - k - slope * outer[0], slope]
        if k:
            ramp[:] = [line, _LEVEL[1]]
        else:  # it may lean on pleats at its other end, too
            ramp[int(np.isfinite(ramp[1, 0])) if ramp[0, 1] == 0.0 else 1] = line


def creased(x: np.ndarray, pairs: np.ndarray, pleats: Sequence[Pleat]) -> np.ndarray:
    """Of pairs (K, 2) of points at x (P,) [m] those that lie along one fold, as (k, 2) of the same numbers."""
    along = np.zeros(len(pairs), bool)
    for fold in (fold for pleat in pleats for fold in pleat.folds()):
        along |= (np.abs(x[pairs] - fold) < NEAR).all(1)
    return pairs[along]


def latches(points: np.ndarray, pleats: Sequence[Pleat], reach: float) -> tuple[np.ndarray, np.ndarray]:
    """What keeps creases from opening: pairs (K, 2) of points (P, 2) [m] of a panel about `reach` [m] to both sides of
    each fold, and how far apart (K,) [m] they may be at the angle a crease may open to."""
    pairs, ends = [np.zeros((0, 2), np.int64)], [np.zeros(0)]
    tree = KDTree(points)
    for pleat in pleats:
        if pleat.crease >= np.pi:
            continue
        aside = min(reach, 0.7 * pleat.depth)
        for fold in pleat.folds():
            on = points[np.abs(points[:, 0] - fold) < NEAR]
            sides = [tree.query(on + [way * aside, 0.0])[1] for way in (-1.0, 1.0)]
            found = np.unique(np.column_stack(sides), axis=0)
            (a, b), rise = np.abs(points[found, 0] - fold).T, np.diff(points[found, 1], axis=1)[:, 0]
            found, a, b, rise = (each[(a > NEAR) & (b > NEAR)] for each in (found, a, b, rise))
            pairs.append(found)
            ends.append(np.sqrt(a * a + b * b - 2 * a * b * np.cos(pleat.crease) + rise * rise))
    return np.concatenate(pairs), np.concatenate(ends)


def chords(outline: np.ndarray, pleats: Sequence[Pleat]) -> list[np.ndarray]:
    """The lines (2, 2) [m] of all folds across an outline (N, 2) [m].

    Raises OutlineError where one has no cloth, or crosses the outline elsewhere than above and below.
    """
    ahead = np.roll(outline, -1, axis=0)
    found = []
    for fold in (fold for pleat in pleats for fold in pleat.folds()):
        a, b = outline[:, 0] - fold, ahead[:, 0] - fold
        crossing = np.flatnonzero((a < 0) != (b < 0))
        if len(crossing) != 2:
            where = "outside the panel" if not len(crossing) else f"across its outline {len(crossing)} times"
            raise OutlineError(
                f"pleats: a fold at x = {1000 * fold:.1f} mm goes {where} – it must go through cloth once"
            )
        share = a[crossing] / (a[crossing] - b[crossing])
        y = outline[crossing, 1] + share * (ahead[crossing, 1] - outline[crossing, 1])
        found.append(np.column_stack([np.full(2, fold), np.sort(y)]))
    return found
