"""Where flat panels are before they are sewn: folded over a straight shoulder line, front and back hanging as sheets.

A garment cut flat stays flat: this start has no strain but where its two bends are rounded, and only the side and
underarm seams are still open.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.garment.pattern import Cloth, Panel, Path, Pattern
from sim_core.garment.pattern.panels import arc_length
from sim_core.garment.placement.ground import Ground

__all__ = ["Flat", "Laying", "laid"]

OVER = 0.012  # [m] of the laid cloth above shoulders and arms
ON_BAR = 0.001  # [m] more than it keeps from it that cloth lies off a bar
ON_FLOOR = 0.002  # [m] more than it keeps from it that cloth lies above the floor
TRAIL = 0.02  # [m] radius of the bend where it comes to lie there
RISING = 0.07  # [m] of the shoulder fold over which a front that lies outside is raised to its height
BEYOND = 0.02  # [m] beyond the sides that a front which goes round them begins to turn
FINE = 0.002  # [m] between the points of the line it goes along


@dataclass(frozen=True)
class Flat:
    """Flat before and behind the wearer's outstretched arms, or a T-bar through both sleeves.

    over: the front, of the wearer, that lies outside where fronts overlap, lift [m] off the other from the shoulder
    on; what it has beyond the other side, of panels cut for it alone, goes on round the back, and round again, each
    turn so far outside the one before. front, back [m]: of the sheets before and behind the middle.
    """

    over: str = "left"
    lift: float = 0.012
    front: float = 0.17
    back: float = 0.15

    halves = True  # `start` takes the left half of a mirrored pattern

    def hanging(self, cloth: Cloth) -> float:
        """The longest free length [m]."""
        return float(np.abs(cloth.vertices[:, 1]).max())

    def start(self, pattern: Pattern, cloth: Cloth, ground: Ground, rng: np.random.Generator) -> np.ndarray:
        """Positions (P, 3) [m] of the pattern vertices, of a mirrored pattern those of its left half."""
        laying = self._laying(ground)
        return laid(pattern, cloth, laying)[0]

    def whole(self, pattern: Pattern, cloth: Cloth, ground: Ground) -> np.ndarray:
        """Positions (W, 3) [m] of the whole of a mirrored pattern, the outer front raised off the other.

        Raises SimCoreError where the inner front has panels that reach beyond the other side: only what lies outside
        can go on round the back.
        """
        laying = self._laying(ground)
        own, fall = laid(pattern, cloth, laying)
        both = np.stack([own, own * [-1.0, 1.0, 1.0]])
        share = np.clip(fall / RISING, 0.0, 1.0)
        amount = self.lift * share * share * (3 - 2 * share)
        outer = 0 if self.over == "left" else 1
        both[outer] += amount[:, None] * laying.normal(fall)
        if not pattern.alike:
            inner = "right" if self.over == "left" else "left"
            if np.isfinite(_sides(pattern, cloth, own, fall, inner)):
                raise SimCoreError(
                    f"over = {self.over!r}: a front of the {inner} reaches beyond the wearer's side, only an outer one "
                    f"goes on round the back – lay it over the other (over = {inner!r}), or cut it narrower"
                )
            across = np.array([1.0 if outer == 0 else -1.0, 1.0, 1.0])
            both[outer] = across * self._wound(pattern, cloth, laying, across * both[outer], fall)
        return both.reshape(-1, 3)[pattern.kept(cloth)]

    def _wound(
        self, pattern: Pattern, cloth: Cloth, laying: Laying, own: np.ndarray, fall: np.ndarray
    ) -> np.ndarray:
        """Positions (P, 3) [m] of the outer half, as if it were the left one: what lies beyond the sides in front is
        bent backwards and goes on behind."""
        turn = _sides(pattern, cloth, own, fall, self.over)
        beyond = -turn - own[:, 0]
        moved = (fall > 0) & (beyond > 0)
        if not moved.any():
            return own
        front = laying.front + self.lift
        line, outward = _spiral(turn, front, laying.back - self.lift, self.lift, float(beyond.max()))
        arc = arc_length(line)
        at, off = beyond[moved], own[moved, 2] - front
        out = own.copy()
        for axis, c in ((0, 0), (2, 1)):
            out[moved, axis] = np.interp(at, arc, line[:, c]) + off * np.interp(at, arc, outward[:, c])
        return out

    def _laying(self, ground: Ground) -> Laying:
        """Over a T-bar close to it, else over the highest point of arms and shoulders, the neck left out."""
        if ground.stand is not None:
            round_bar = ground.stand.bar_radius + ground.clearance + ON_BAR
            return Laying(
                top=ground.stand.height + round_bar,
                fold=0.0,
                front=round_bar,
                back=-round_bar,
                bend=round_bar,
                floor=ground.clearance + ON_FLOOR,
            )
        points = ground.points()
        top = float(points[np.abs(points[:, 0]) > 0.1, 1].max()) + OVER
        return Laying(top=top, front=self.front, back=-self.back, floor=ground.clearance + ON_FLOOR)


@dataclass(frozen=True)
class Laying:
    """Lengths in metres, y up, +z the figure's front. Cloth that is longer than the way down trails on the floor.

    top: height of the cloth over shoulders and arms; fold: z of the shoulder fold; front, back: z of the sheets;
    bend: radius of the two bends; turn: where, along the edge before the shoulder fold, a band begins to turn upright
    and where it has, before it meets the neck; floor: height of cloth that lies on it.
    """

    top: float
    fold: float = -0.015
    front: float = 0.17
    back: float = -0.15
    bend: float = 0.04
    turn: tuple[float, float] = (0.17, 0.075)
    floor: float = -np.inf

    def place(self, points: np.ndarray) -> np.ndarray:
        """Positions (N, 3) of points (N, 2) of the garment's plane: x outwards, y down in front, up in the back."""
        ahead = points[:, 1] >= 0
        reach = np.where(ahead, self.front - self.fold, self.fold - self.back)
        along = np.abs(points[:, 1])
        flat, quarter = reach - self.bend, self.bend * np.pi / 2
        angle = np.clip((along - flat) / self.bend, 0, np.pi / 2)
        out = np.minimum(along, flat) + self.bend * np.sin(angle)
        straight = np.maximum(along - flat - quarter, 0)
        fall = self.top - self.bend - self.floor - TRAIL
        trail = np.clip((straight - fall) / TRAIL, 0, np.pi / 2)
        down = self.bend * (1 - np.cos(angle)) + np.minimum(straight, fall) + TRAIL * np.sin(trail)
        out += TRAIL * (1 - np.cos(trail)) + np.maximum(straight - fall - TRAIL * np.pi / 2, 0)
        z = self.fold + np.where(ahead, out, -out)
        return np.stack([points[:, 0], self.top - down, z], axis=1)

    def normal(self, fall: np.ndarray) -> np.ndarray:
        """Outward unit vectors (N, 3) of the front sheet `fall` (N,) [m] below the shoulder fold."""
        flat = self.front - self.fold - self.bend
        angle = np.clip((fall - flat) / self.bend, 0, np.pi / 2)
        return np.stack([np.zeros(len(fall)), np.cos(angle), np.sin(angle)], axis=1)


def _sides(pattern: Pattern, cloth: Cloth, own: np.ndarray, fall: np.ndarray, half: str) -> float:
    """How far [m] from the middle a half, laid at own (P, 3) [m] as the left one is, turns round the sides: beyond all
    that both halves have at the height of its own panels that reach further, and below; inf where none does."""
    both = np.array([not panel.side for panel in pattern.panels])[cloth.panel_of]

    def side(low: float) -> float:
        return float(np.abs(own[both & (np.abs(fall) >= low), 0]).max(initial=0.0)) + BEYOND

    reaching = []
    for number, panel in enumerate(pattern.panels):
        mine = (cloth.panel_of == number) & (fall > 0)
        if panel.side == half and mine.any() and -own[mine, 0].min() > side(float(fall[mine].min())):
            reaching.append(float(fall[mine].min()))
    return side(min(reaching)) if reaching else np.inf


def _spiral(
    turn: float, front: float, back: float, gap: float, length: float
) -> tuple[np.ndarray, np.ndarray]:
    """A line (n, 2) in x and z [m] of at least `length` that begins at -turn in front and goes backwards round
    x = -turn and x = turn, `gap` further off each time it comes to the front or the back; its outward normals (n, 2).
    """
    points, outward = [np.array([[-turn, front]])], [np.array([[0.0, 1.0]])]
    ahead, side, here, done = 1.0, -1.0, front, 0.0  # on which sheet, towards which end, z of the sheet
    there = back
    while done < length:
        radius = 0.5 * abs(here - there)
        angle = np.linspace(0.0, np.pi, int(np.pi * radius / FINE) + 2)[1:]
        way = np.column_stack([side * np.sin(angle), ahead * np.cos(angle)])
        points.append(np.array([side * turn, 0.5 * (here + there)]) + radius * way)
        outward.append(way)
        points.append(np.array([[-side * turn, there]]))
        outward.append(np.array([[0.0, -ahead]]))
        done += np.pi * radius + 2 * turn
        here, there = there, here + ahead * gap
        ahead, side = -ahead, -side
    return np.concatenate(points), np.concatenate(outward)


def laid(pattern: Pattern, cloth: Cloth, laying: Laying) -> tuple[np.ndarray, np.ndarray]:
    """Start positions (P, 3) [m] of all pattern vertices, and how far below the shoulder fold (P,) [m] each lies in
    front; behind it the figure is negative. Of a band it is that of the edge it lies along."""
    positions, fall = np.zeros((len(cloth.vertices), 3)), np.zeros(len(cloth.vertices))
    for number, panel in enumerate(pattern.panels):
        own = np.flatnonzero(cloth.panel_of == number)
        if panel.along is None:
            positions[own], fall[own] = laying.place(cloth.vertices[own]), cloth.vertices[own, 1]
    for number, panel in enumerate(pattern.panels):
        if panel.along is not None:
            own = np.flatnonzero(cloth.panel_of == number)
            positions[own], fall[own] = _beside(pattern, panel, cloth, own, laying)
    return positions, fall


def _beside(
    pattern: Pattern, band: Panel, cloth: Cloth, own: np.ndarray, laying: Laying
) -> tuple[np.ndarray, np.ndarray]:
    """A band beside the edge it is sewn to: towards the middle in front, turned upright before it meets the neck. Where
    its free edge is longer, as mitres are, it goes on straight."""
    assert band.along is not None
    edge = cloth.along(band.along, pattern.panel(band.along.panel))
    sewn = _partner(pattern, band)
    mine = cloth.along(sewn, band) if sewn is not None else own[:1]
    points, arc = cloth.vertices[own], cloth.vertices[mine, 1]
    order = np.argsort(arc)
    line = cloth.vertices[edge]  # in the garment's plane
    way = np.gradient(line, axis=0)
    inwards = np.stack([way[:, 1], -way[:, 0]], axis=1) / np.linalg.norm(way, axis=1)[:, None]
    inwards *= -np.sign(inwards[:, :1]) * np.ones(2)  # towards the middle of the front and beyond
    begin, end = laying.turn
    share = np.clip((begin - line[:, 1]) / (begin - end), 0, 1)
    rise = 0.5 * np.pi * share * share * (3 - 2 * share)

    def at(values: np.ndarray) -> np.ndarray:
        return np.interp(points[:, 1], arc[order], values[order])

    away = np.abs(points[:, 0] - cloth.vertices[mine, 0].mean())
    lean, fall = at(rise), at(line[:, 1])
    flat = np.stack([at(line[:, c]) + away * np.cos(lean) * at(inwards[:, c]) for c in range(2)], axis=1)
    beyond = points[:, 1] - np.clip(points[:, 1], arc.min(), arc.max())
    for end, inner in ((order[0], order[1 % len(order)]), (order[-1], order[-2 % len(order)])):
        own_end = (beyond * (arc[end] - arc[inner]) > 1e-9) & (len(order) > 1)
        flat[own_end] += beyond[own_end, None] * (line[end] - line[inner]) / (arc[end] - arc[inner])
    out = laying.place(flat) + (away * np.sin(lean))[:, None] * laying.normal(fall)
    return out, fall


def _partner(pattern: Pattern, band: Panel) -> Path | None:
    """The band's own side of the seam it lies along."""
    for seam in pattern.seams:
        if seam.a == band.along and seam.b is not None and seam.b.panel == band.name:
            return seam.b
        if seam.b == band.along and seam.a.panel == band.name:
            return seam.a
    return None
