"""Which vertices of a sheet are meant by places of a pattern: what is pinned, what seams and ties draw together."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sim_core.garment.dressing.course import Course
from sim_core.garment.dressing.sewn_sheet import SewnSheet
from sim_core.garment.outfit import Layer
from sim_core.garment.pattern import SIDES, Cloth, Spot

__all__ = ["Places", "nearest"]


@dataclass(frozen=True)
class Places:
    """cut: the pattern's own cloth, one half of a mirrored one; cloth: what is dressed; sheet: as it is simulated."""

    layer: Layer
    cut: Cloth
    cloth: Cloth
    sheet: SewnSheet

    def vertices(self, what: Spot | str) -> tuple[int, ...]:
        """Vertices of the sheet that a pin holds: the nearest to its place and their neighbours, or a whole edge."""
        if what == "top":
            top = self.cloth.vertices[:, 1] < self.cloth.vertices[:, 1].min() + 1e-6
            return tuple(int(k) for k in np.unique(self.sheet.number[top]))
        points = [self._nape()] if what == "nape" else self._nearest(what)
        near = np.isin(self._edges, points).any(1)
        return tuple(int(k) for k in np.unique([*self._edges[near].ravel(), *points]) if k < self.sheet.real)

    def pairs(self, course: Course) -> tuple[np.ndarray, np.ndarray]:
        """Vertices (K, 2) that are drawn together in a run, and how far apart (K,) [m] they end."""
        pairs = np.zeros((0, 2), np.int32) if course.closed else self.cloth.pairs
        ends = np.zeros(len(pairs))
        for tie in course.ties:
            first, second = self._nearest(tie.a), self._nearest(tie.b)
            twins = [(a, b) for a, b in zip(first, second, strict=False) if a != b]
            if len(first) != len(second):
                twins = [(a, b) for a in first for b in second if a != b]
            pairs = np.concatenate([pairs, np.array(twins, np.int32).reshape(-1, 2)])
            ends = np.concatenate([ends, np.full(len(twins), tie.length)])
        return pairs.astype(np.int32), ends

    @cached_property
    def _edges(self) -> np.ndarray:
        return self.sheet.sheet.edges

    def _nape(self) -> int:
        """On the middle where the first panel comes nearest to the shoulder fold from behind."""
        middle = self.cut.middle[self.cut.panel_of[self.cut.middle] == 0]
        if not len(middle):  # cut whole: the point of the first panel nearest to it
            own = np.flatnonzero(self.cut.panel_of == 0)
            behind = own[self.cut.vertices[own, 1] <= 0]
            behind = behind if len(behind) else own
            near = np.abs(self.cut.vertices[behind, 0]) - self.cut.vertices[behind, 1]
            return int(self.sheet.number[behind[np.argmin(near)]])
        return int(self.sheet.number[middle[np.argmax(self.cut.vertices[middle, 1])]])

    def _nearest(self, spot: Spot | str) -> list[int]:
        """The vertex of the sheet nearest to a place, of both sides where none is named."""
        assert isinstance(spot, Spot)
        return [int(self.sheet.number[k]) for k in nearest(self.cloth, self.cut, spot)]


def nearest(cloth: Cloth, cut: Cloth, spot: Spot) -> list[int]:
    """The pattern vertex nearest to a place, one of each side where none is named; cut: the half the cloth was made
    from, or the cloth itself."""
    names = [spot.panel]
    if cloth is not cut:
        names = [spot.panel + side for side in SIDES if not spot.side or side.strip() == spot.side]
    found = []
    for name in names:
        own = np.flatnonzero(cloth.panel_of == cloth.names.index(name))
        x = -spot.place[0] if name.endswith(SIDES[1]) and name != spot.panel else spot.place[0]
        away = np.hypot(*(cloth.vertices[own] - [x, spot.place[1]]).T)
        found.append(int(own[np.argmin(away)]))
    return found
