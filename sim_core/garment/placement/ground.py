"""What a garment is placed on: the wearer's surface and landmarks in a pose, or a stand, and what is worn already."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from sim_core.body.stand import Stand
from sim_core.cloth.contact import DistanceField, field_of, united
from sim_core.errors import SimCoreError

__all__ = ["WORN", "Ground"]

WORN = 0.004  # [m] by which a garment beneath another reaches beyond its middle surface
CELL, REACH = 0.008, 0.08  # [m] of the field that lines are arranged in


@dataclass(frozen=True)
class Ground:
    """vertices (V, 3) [m], faces (F, 3): the wearer in the pose the garment is placed on; trunk (T,): its vertices
    that are not of the arms; marks: its landmarks (3,) [m]; worn: closed meshes of the garments it wears already;
    stand: instead of a wearer; clearance [m]: what the garment will keep from all of it; edge [m]: its mesh step."""

    vertices: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    faces: np.ndarray = field(default_factory=lambda: np.zeros((0, 3), np.int32))
    trunk: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int32))
    marks: Mapping[str, np.ndarray] = field(default_factory=dict)
    worn: tuple[tuple[np.ndarray, np.ndarray], ...] = ()
    stand: Stand | None = None
    clearance: float = 0.003
    edge: float = 0.015

    def mark(self, name: str) -> np.ndarray:
        """A landmark (3,) [m]; raises SimCoreError with the names there are."""
        if name not in self.marks:
            known = ", ".join(self.marks) or "none on a stand"
            raise SimCoreError(f"place: no landmark {name!r} – landmarks: {known}")
        return self.marks[name]

    def top(self, mark: str, rise: float, length: float, name: str) -> float:
        """Height [m] from which cloth of a `length` [m] hangs, `rise` above a landmark; raises SimCoreError naming the
        pattern where it reaches the floor."""
        top = float(self.mark(mark)[1]) + rise
        if top < length:
            raise SimCoreError(
                f"pattern {name}: {length:.2f} m long, {length - top:.2f} m more than there is from {mark!r} to the "
                "floor – cut it shorter or raise it"
            )
        return top

    def bar(self) -> Stand:
        """The stand; raises SimCoreError where there is a wearer instead."""
        if self.stand is None:
            raise SimCoreError("place: over a bar – give the outfit a [stand] instead of a wearer")
        return self.stand

    def points(self) -> np.ndarray:
        """Of everything (N, 3) [m]."""
        return np.concatenate([self.vertices, *(vertices for vertices, _ in self.worn)])

    @cached_property
    def distance(self) -> DistanceField:
        """min(wearer, garments - WORN) [m] far around them."""
        points = self.points()
        low, high = points.min(0) - [0.10, 0.05, 0.15], points.max(0) + [0.10, 0.06, 0.08]
        low[0] = CELL * np.floor(low[0] / CELL)  # mirror images meet in nodes
        box = low, high
        found = field_of(self.vertices, self.faces, cell=CELL, band=REACH, box=box)
        for mesh in self.worn:
            found = united(found, field_of(*mesh, cell=CELL, band=REACH, box=box), thicker=WORN)
        return found
