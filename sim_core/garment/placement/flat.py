"""Where flat panels are before they are sewn: folded over a straight shoulder line, front and back hanging as sheets.

A garment cut flat stays flat: this start has no strain but where its two bends are rounded, and only the side and
underarm seams are still open.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.garment.pattern.cloth import Cloth
from sim_core.garment.pattern.panels import Panel
from sim_core.garment.pattern.pattern import Pattern

__all__ = ["Laying", "laid"]


@dataclass(frozen=True)
class Laying:
    """Lengths in metres, y up, +z the figure's front.

    top: height of the cloth over shoulders and arms; fold: z of the shoulder fold; front, back: z of the sheets;
    bend: radius of the two bends; turn: where, along the edge before the shoulder fold, a band begins to turn upright
    and where it has, before it meets the neck.
    """

    top: float
    fold: float = -0.015
    front: float = 0.17
    back: float = -0.15
    bend: float = 0.04
    turn: tuple[float, float] = (0.17, 0.075)

    def place(self, points: np.ndarray) -> np.ndarray:
        """Positions (N, 3) of points (N, 2) of the garment's plane: x outwards, y down in front, up in the back."""
        ahead = points[:, 1] >= 0
        reach = np.where(ahead, self.front - self.fold, self.fold - self.back)
        along = np.abs(points[:, 1])
        flat, quarter = reach - self.bend, self.bend * np.pi / 2
        angle = np.clip((along - flat) / self.bend, 0, np.pi / 2)
        out = np.minimum(along, flat) + self.bend * np.sin(angle)
        down = self.bend * (1 - np.cos(angle)) + np.maximum(along - flat - quarter, 0)
        z = self.fold + np.where(ahead, out, -out)
        return np.stack([points[:, 0], self.top - down, z], axis=1)


def laid(pattern: Pattern, cloth: Cloth, laying: Laying) -> np.ndarray:
    """Start positions (P, 3) of all pattern vertices of one half."""
    positions = np.zeros((len(cloth.vertices), 3))
    for number, panel in enumerate(pattern.panels):
        own = np.flatnonzero(cloth.panel_of == number)
        if panel.along is None:
            positions[own] = laying.place(cloth.vertices[own])
    for number, panel in enumerate(pattern.panels):
        if panel.along is not None:
            own = np.flatnonzero(cloth.panel_of == number)
            positions[own] = _beside(pattern, panel, cloth, own, laying)
    return positions


def _beside(pattern: Pattern, band: Panel, cloth: Cloth, own: np.ndarray, laying: Laying) -> np.ndarray:
    """A band beside the edge it is sewn to: towards the middle in front, turned upright before it meets the neck."""
    assert band.along is not None
    edge = cloth.along(band.along, pattern.panel(band.along.panel))
    sewn = _partner(pattern, band)
    mine = cloth.along(sewn, band) if sewn is not None else own[:1]
    points, arc = cloth.vertices[own], cloth.vertices[mine, 1]
    order = np.argsort(arc)
    down = cloth.vertices[edge, 1]  # y in the garment's plane: how far below the shoulder fold
    place = laying.place(cloth.vertices[edge])
    begin, end = laying.turn
    share = np.clip((begin - down) / (begin - end), 0, 1)
    rise = 0.5 * np.pi * share * share * (3 - 2 * share)

    def at(values: np.ndarray) -> np.ndarray:
        return np.interp(points[:, 1], arc[order], values[order])

    away = np.abs(points[:, 0] - cloth.vertices[mine, 0].mean())
    base = np.stack([at(place[:, c]) for c in range(3)], axis=1)
    lean = at(rise)
    return base + away[:, None] * np.stack([-np.cos(lean), np.sin(lean), np.zeros(len(lean))], axis=1)


def _partner(pattern: Pattern, band: Panel):
    """The band's own side of the seam it lies along."""
    for seam in pattern.seams:
        if seam.a == band.along and seam.b is not None and seam.b.panel == band.name:
            return seam.b
        if seam.b == band.along and seam.a.panel == band.name:
            return seam.a
    return None
