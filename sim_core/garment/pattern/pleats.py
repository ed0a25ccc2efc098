"""Knife pleats: folds across a panel, how much cloth they take up, and which ply lies over which."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from scipy.spatial import KDTree

from sim_core.errors import OutlineError

__all__ = ["Pleat", "Plies", "chords", "creased", "latches"]

Way = Literal["end", "begin"]
NEAR = 1e-6  # [m] from a fold, that lies on it


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
    and in gaps a metre) of which the highest counts, and 0.

    Pleats side by side lean on each other like shingles. All plies between the outermost rise with one slope, two gaps
    a step, so that no ply meets another wherever a mesh has its vertices.
    """

    bounds: np.ndarray
    places: np.ndarray
    ramps: np.ndarray

    @staticmethod
    def of(low: float, high: float, pleats: Sequence[Pleat]) -> Plies:
        """Of a panel from x = low to high [m]."""
        bounds, places = [low], [low]
        ramps = [_LEVEL.copy()]
        for group in _groups(pleats):
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
            _lean(ramps[first:], places[begins:], group)
        places.append(places[-1] + high - bounds[-1])
        return Plies(np.array([*bounds, high]), np.array(places), np.array(ramps))

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
        place, last = self.laid(x), len(self.ramps) - 1
        found = np.zeros(len(x))
        for aside in (-NEAR, NEAR):
            ramp = self.ramps[np.clip(np.searchsorted(self.bounds, x + aside, side="right") - 1, 0, last)]
            found += 0.5 * np.maximum(0.0, (ramp[..., 0] + ramp[..., 1] * place[:, None]).max(1))
        return found

    def top(self, places: np.ndarray) -> np.ndarray:
        """How many gaps high the uppermost ply lies at places (n,) [m] along the pleated panel; 0 beside it."""
        found = np.zeros(len(places))
        for k, ramp in enumerate(self.ramps):
            low, high = sorted(self.places[k : k + 2])
            lines = (ramp[:, 0] + ramp[:, 1] * places[:, None]).max(1)
            found = np.where((places >= low) & (places <= high), np.maximum(found, lines), found)
        return found


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
