"""Pleated cloth round the wearer: panels laid in folds on a tent, narrow where they are held and wider below."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.spatial import ConvexHull

from sim_core.garment.pattern import Cloth, Opened, Pattern, Plies
from sim_core.mesh.geometry import tangent_line

__all__ = ["Folds", "Tent"]

ANGLES = 720  # directions in which a line about the wearer is told
ROUNDED = 60  # of them, to both sides, over which its corners are rounded
STANDING = 0.8  # of the angle a crease may open to, that one is laid open
FINER = 0.004  # [m] between points at which it is told how high pleated cloth lies
STEEPEST = 0.3  # of its way along, that cloth which climbs goes at least
ROUNDS = 8  # of fitting pleats to a ring that is longer where they lie higher
OVER = 1.5  # gaps that a panel lies over those beneath it


@dataclass(frozen=True)
class Tent:
    """Convex lines round the wearer, from the top down: of each its depth [m] below the top, and how far down (L,) [m]
    along the cloth it lies."""

    rings: tuple[_Ring, ...]
    depths: np.ndarray
    falls: np.ndarray

    @staticmethod
    def over(hulls: Sequence[np.ndarray], depths: np.ndarray, begin: float, away: float) -> Tent:
        """At least `away` [m] off convex hulls (m, 2) at depths (L,) [m], each about all those above, from the
        direction `begin` [rad] on. It widens ever less on the way down, so that plies that lie on each other there do
        not cut each other's chords."""
        centre = hulls[-1].mean(0)
        angle = begin + np.linspace(0.0, 2 * np.pi, ANGLES + 1)
        outward = np.stack([np.sin(angle), np.cos(angle)], axis=1)
        reach = np.array([(outward[:-1] @ (hull - centre).T).max(1) for hull in hulls])  # support functions
        window = np.hanning(2 * ROUNDED + 1)
        smooth = ndimage.convolve1d(reach, window / window.sum(), axis=1, mode="wrap")
        smooth += away + (reach - smooth).max(1, keepdims=True)
        growth = smooth[-1] - smooth[0]
        wanted = ((smooth - smooth[0]) / np.maximum(growth, 1e-6)).max(1)
        share = _concave(depths, np.clip(wanted, 0.0, 1.0))
        lines = smooth[0] + share[:, None] * growth
        rings = tuple(_Ring.of(line, outward, centre) for line in lines)
        steps = np.hypot(np.diff(depths), np.diff([ring.girth for ring in rings]) / (2 * np.pi))
        return Tent(rings, depths, np.r_[0.0, np.cumsum(steps)])

    def hung(self, folds: Folds, fall: np.ndarray, gap: float) -> np.ndarray:
        """Positions (P, 3) [m] of pleated cloth from the top down, which lies at y = 0; fall (P,) [m] down the cloth;
        gap [m] between plies."""
        last = len(self.rings) - 2
        where = np.clip(np.searchsorted(self.falls, fall, side="right") - 1, 0, last)
        share = (fall - self.falls[where]) / (self.falls[where + 1] - self.falls[where])
        out = np.zeros((len(fall), 3))
        for level, ring in enumerate(self.rings):
            weight = np.where(where == level, 1 - share, np.where(where == level - 1, share, 0.0))
            used = np.flatnonzero(weight)
            places, heights = folds.round(self.rings[0].girth, ring, gap)
            flat = ring.at(places[used], heights[used])
            down = np.full(len(used), -self.depths[level])
            out[used] += weight[used, None] * np.stack([flat[:, 0], down, flat[:, 1]], axis=1)
        return out


def _concave(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The least concave line (n,) over y (n,) at ascending x (n,)."""
    low = min(float(y.min()), 0.0) - 1.0
    corners = np.concatenate([np.column_stack([x, y]), [[x[0], low], [x[-1], low]]])
    upper = np.unique([k for k in ConvexHull(corners).vertices if k < len(x)])
    return np.interp(x, x[upper], y[upper])


@dataclass(frozen=True)
class _Ring:
    """A line round the wearer at one height: points (n + 1, 2) [m], the way outwards (n + 1, 2) and how far [m] along
    it each is, the last as the first."""

    points: np.ndarray
    outward: np.ndarray
    arc: np.ndarray

    @staticmethod
    def of(reach: np.ndarray, outward: np.ndarray, centre: np.ndarray) -> _Ring:
        """The line about a centre (2,) [m] that reaches so far (n,) [m] in directions (n + 1, 2), the last as the
        first."""
        points = tangent_line(reach, outward[:-1], centre)
        points = np.concatenate([points, points[:1]])
        return _Ring(points, outward, np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])

    @property
    def girth(self) -> float:
        """[m]"""
        return float(self.arc[-1])

    def curvature(self, places: np.ndarray) -> np.ndarray:
        """How fast it turns (k,) [1/m] that far (k,) [m] along it."""
        turn = 2 * np.pi / (len(self.arc) - 1)
        return np.interp(
            places, 0.5 * (self.arc[1:] + self.arc[:-1]), turn / np.diff(self.arc), period=self.girth
        )

    def at(self, places: np.ndarray, out: np.ndarray) -> np.ndarray:
        """Points (k, 2) [m] that far (k,) along it, `out` (k,) [m] outside."""
        along = places % self.girth
        on, outward = (
            np.stack([np.interp(along, self.arc, values[:, c]) for c in range(2)], axis=1)
            for values in (self.points, self.outward)
        )
        return on + out[:, None] * outward / np.linalg.norm(outward, axis=1)[:, None]


@dataclass(frozen=True)
class Folds:
    """All panels pleated, round the wearer: x (P,) [m] of pattern vertices and their panel (P,); of each panel its
    plies, how high [m] its outer folds may stand and where its middle lies [m] from where everything begins; width [m]
    of everything."""

    x: np.ndarray
    panel: np.ndarray
    plies: tuple[Plies, ...]
    highest: tuple[float, ...]
    middles: np.ndarray
    width: float

    @staticmethod
    def of(pattern: Pattern, cloth: Cloth) -> Folds:
        panels = pattern.panels * (2 if pattern.mirror else 1)
        x, low = cloth.vertices[:, 0], float(cloth.vertices[:, 0].min())
        plies, highest = [], []
        there = np.unique(cloth.panel_of)  # without what one side alone has, in the other
        for number in there:
            panel, own = panels[number], x[cloth.panel_of == number]
            plies.append(Plies.of(float(own.min()), float(own.max()), panel.pleats))
            angles = [np.sin(min(STANDING * pleat.crease, 1.0)) * pleat.depth for pleat in panel.pleats]
            highest.append(float(min(angles, default=0.0)))
        ends = np.array([(folded.places.min(), folded.places.max()) for folded in plies]) - low
        return Folds(
            x,
            np.searchsorted(there, cloth.panel_of),
            tuple(plies),
            tuple(highest),
            ends.mean(1),
            float(ends[:, 1].max()),
        )

    def round(self, tight: float, ring: _Ring, gap: float) -> tuple[np.ndarray, np.ndarray]:
        """Where (P,) [m] vertices lie along a ring, of cloth laid to go round one of `tight` [m], and how high (P,) [m]
        above it, plies being `gap` [m] apart.

        Pleats open as far as they may, so that each panel goes as far round as it did; where they may not, it is as
        wide as they let it be, about its middle, and laps are less. Later panels, and what goes round a second time,
        lie over all beneath.
        """
        opened: list[Opened] = []
        places, heights = np.zeros(len(self.x)), np.zeros(len(self.x))
        for number in range(len(self.plies)):
            each = self._panel(opened, tight, ring, gap)
            own = np.flatnonzero(self.panel == number)
            places[own] = each.laid(self.x[own])
            heights[own] = each.heights(self.x[own]) + _beneath(places[own], (*opened, each), ring.girth, gap)
            opened.append(each)
        return places, heights

    def _panel(self, beneath: Sequence[Opened], tight: float, ring: _Ring, gap: float) -> Opened:
        """The next panel over those beneath, its places along the ring: what lies high goes further for the same cloth
        where the ring turns, and cloth goes less far where it climbs on what lies beneath."""
        number, wide = len(beneath), ring.girth
        plies, middle = self.plies[number], self.middles[number] * wide / tight
        wanted = float(np.ptp(plies.places[[0, -1]])) * wide / tight
        aim, found = wanted, None
        for _ in range(ROUNDS):
            flat = plies.as_wide(aim, self.highest[number], gap).finer(FINER)
            found = flat.scaled(np.ones(len(flat.x) - 1), middle) if found is None else found
            own = flat.heights(flat.x)
            under = _beneath(np.interp(flat.x, found.x, found.places), (*beneath, found), wide, gap)
            turns = ring.curvature(0.5 * (found.places[1:] + found.places[:-1]))
            longer = 1.0 + 0.5 * turns * (own + under)[1:] + 0.5 * turns * (own + under)[:-1]
            found = flat.scaled(_sloping(np.diff(flat.places), np.diff(own), np.diff(under)) / longer, middle)
            aim += wanted - found.width
        assert found is not None
        return found


def _sloping(along: np.ndarray, rises: np.ndarray, climbs: np.ndarray) -> np.ndarray:
    """How many times as far (n,) stretches of cloth that go `along` (n,) [m] and rise by so much [m] go where they
    climb besides by what they lie on [m]."""
    left = along**2 + rises**2 - (rises + climbs) ** 2
    return np.sqrt(np.maximum(left / np.maximum(along**2, 1e-18), STEEPEST**2))


def _beneath(places: np.ndarray, panels: Sequence[Opened], wide: float, gap: float) -> np.ndarray:
    """How high (n,) [m] the last of some panels lies at places (n,) [m] along a ring, for what it lies over: the
    others, and itself where it goes round again."""
    found = np.zeros(len(places))
    for panel in panels:
        for turn in (-wide,) if panel is panels[-1] else (-wide, 0.0, wide):
            found += panel.over(places + turn, OVER * gap)
    return found
