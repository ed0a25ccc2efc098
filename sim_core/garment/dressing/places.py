"""Which vertices of a sheet are meant: what is pinned, what seams, ties and belts draw together."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.garment.dressing.course import Course
from sim_core.garment.dressing.sewn_sheet import SewnSheet
from sim_core.garment.outfit import Layer
from sim_core.garment.pattern import SIDES, Cloth, Spot, both_halves, latches
from sim_core.mesh.geometry import hull_girth
from sim_core.metrics import components

__all__ = ["Places", "belt_pairs", "girth_there", "nearest"]

OPEN = (
    np.pi / 2
)  # [rad] that cloth round the body may leave free; a sleeve beside it leaves more than twice that
LATCH = 1.0  # mesh steps from a fold to the cloth beside it that keeps it from opening
APART = 1.5  # mesh steps between two points of a belt


@dataclass(frozen=True)
class Places:
    """cut: the pattern's own cloth, one half of a mirrored one; cloth: what is dressed; sheet: as it is simulated;
    belted: vertices that belts go over which are laid already."""

    layer: Layer
    cut: Cloth
    cloth: Cloth
    sheet: SewnSheet
    belted: tuple[int, ...] = ()

    def vertices(self, what: Spot | str) -> tuple[int, ...]:
        """Vertices of the sheet that a pin holds: the nearest to its place and their neighbours, the
        whole top edge, its points on the middle, x = 0, or what lies under belts."""
        if what == "belt":
            return self.belted
        if what == "top":
            return tuple(int(k) for k in np.unique(self.sheet.number[self._top()]))
        if what == "middle":
            points = np.unique(self.sheet.number[self._top() & (np.abs(self.cloth.vertices[:, 0]) < 1e-6)])
        else:
            points = [self._nape()] if what == "nape" else self._nearest(what)
        near = np.isin(self._edges, points).any(1)
        return tuple(int(k) for k in np.unique([*self._edges[near].ravel(), *points]) if k < self.sheet.real)

    def _top(self) -> np.ndarray:
        """Which (P,) pattern vertices are of the top edge: of panels before and behind the body the fold, y = 0."""
        down = self.cloth.vertices[:, 1]
        down = np.abs(down) if down.min() < 0 < down.max() else down
        return down < down.min() + 1e-6

    def pairs(self, course: Course) -> tuple[np.ndarray, np.ndarray]:
        """Vertices (K, 2) that are drawn together in a run, and how far apart (K,) [m] they end."""
        pairs = np.zeros((0, 2), np.int32) if course.closed else self.cloth.pairs
        pairs, ends = self._latched(pairs)
        for tie in course.ties:
            first, second = self._nearest(tie.a), self._nearest(tie.b)
            twins = [(a, b) for a, b in zip(first, second, strict=False) if a != b]
            if len(first) != len(second):
                twins = [(a, b) for a in first for b in second if a != b]
            pairs = np.concatenate([pairs, np.array(twins, np.int32).reshape(-1, 2)])
            ends = np.concatenate([ends, np.full(len(twins), tie.length)])
        return pairs.astype(np.int32), ends

    def _latched(self, pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pairs that are sewn, and those that keep pleats from opening, with their distances [m]."""
        found, ends = [pairs], [np.zeros(len(pairs))]
        for number, panel, sign in both_halves(self.layer.pattern.panels):
            own = np.flatnonzero(self.cloth.panel_of == number)
            if panel.pleats and len(own):
                points = self.cloth.vertices[own] * [sign, 1.0]
                near, apart = latches(points, panel.pleats, LATCH * self.layer.edge)
                found.append(self.sheet.number[own[near]])
                ends.append(apart)
        return np.concatenate(found), np.concatenate(ends)

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
            return self._drawn(behind[np.argmin(near)])
        return self._drawn(middle[np.argmax(self.cut.vertices[middle, 1])])

    def _drawn(self, vertex: int) -> int:
        """The vertex of the sheet that is one of the cut; of a panel that the second half alone has, its image."""
        if self.cloth is not self.cut:
            kept = self.layer.pattern.kept(self.cut)
            vertex = vertex if kept[vertex] else vertex + len(self.cut.vertices)
            vertex = int(kept[:vertex].sum())
        return int(self.sheet.number[vertex])

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


def belt_pairs(
    x: np.ndarray, faces: np.ndarray, centre: np.ndarray, length: float, edge: float
) -> tuple[np.ndarray, np.ndarray]:
    """Neighbours (K, 2) on a closed line of vertices of x (V, 3) [m] about centre (3,) [m], at its height, and how far
    apart (K,) [m] they end, `length` [m] together. In every direction the line takes the outermost cloth.

    A belt longer than the line is as long as that. Raises SimCoreError where no cloth goes round there.
    """
    own = np.unique(_cut_round(x, faces, centre))
    if not len(own):
        raise SimCoreError(
            f"no cloth goes round the wearer {centre[1]:.2f} m above the floor – move the belt"
        )
    away = x[own][:, [0, 2]] - centre[[0, 2]]
    count = max(12, int(hull_girth(away) / (APART * edge)))
    sector = ((np.arctan2(away[:, 0], away[:, 1]) / (2 * np.pi) + 0.5) * count).astype(int) % count
    order = np.lexsort((np.linalg.norm(away, axis=1), sector))
    outermost = order[np.flatnonzero(np.diff(sector[order], append=-1))]
    ring = own[outermost]
    pairs = np.column_stack([ring, np.roll(ring, -1)]).astype(np.int32)
    apart = np.linalg.norm(x[pairs[:, 0]] - x[pairs[:, 1]], axis=1)
    return pairs, apart * min(1.0, length / float(apart.sum()))


def girth_there(x: np.ndarray, faces: np.ndarray, centre: np.ndarray) -> float:
    """How long [m] a string is that goes round a garment x (V, 3), faces (F, 3) at the height of `centre` (3,) and does
    not squeeze it; 0 where it does not go round there."""
    ends = x[_cut_round(x, faces, centre)][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2, 3)
    above = ends[:, :, 1] > centre[1]
    a, b = np.moveaxis(ends[above[:, 0] != above[:, 1]], 1, 0)
    share = (centre[1] - a[:, 1:2]) / (b[:, 1:2] - a[:, 1:2])
    return hull_girth((a + share * (b - a))[:, [0, 2]])


def _cut_round(x: np.ndarray, faces: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Faces (N, 3) at the height of `centre` of the cloth that goes round it, without sleeves beside."""
    above = x[faces, 1] > centre[1]
    cut = faces[above.any(1) & ~above.all(1)]
    number = np.arange(3 * len(cut)).reshape(-1, 3) // 3
    part = components(len(cut) + len(x), number.ravel(), len(cut) + cut.ravel())[: len(cut)]
    way = x[cut].mean(1) - centre
    direction = np.arctan2(way[:, 0], way[:, 2])
    own = [np.zeros((0, 3), np.int32)]
    for number in range(part.max(initial=-1) + 1):
        mine = part == number
        ahead = np.sort(direction[mine])
        if np.diff(ahead, append=ahead[0] + 2 * np.pi).max() < OPEN:
            own.append(cut[mine])
    return np.concatenate(own)
