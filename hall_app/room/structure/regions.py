"""Ceilings over the floor: which height is where, and along a wall."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from hall_app.content.schema import PlanFile

__all__ = ["Region", "Regions"]

Floats = NDArray[np.float64]
_HAIR = 1e-3  # [m]


@dataclass(frozen=True)
class Region:
    """Floor under one ceiling: shapely polygon(s) [x, z], height [m]."""

    shape: Any
    height: float


@dataclass(frozen=True)
class Regions:
    """The floor split by ceiling height; later bays yield to earlier ones."""

    plan: PlanFile

    @cached_property
    def floor(self) -> Any:
        """The outline as a shapely polygon, counter-clockwise in (x, z)."""
        import shapely

        return shapely.orient_polygons(shapely.Polygon(self.plan.outline))

    @cached_property
    def all(self) -> tuple[Region, ...]:
        """Regions of distinct height, lowest first; they share no floor and cover all of it."""
        import shapely

        left, by_height = self.floor, {}
        for bay in self.plan.bay:
            part = shapely.Polygon(bay.polygon).intersection(left)
            if not part.is_empty and part.area > 1e-6:
                by_height.setdefault(self.plan.height_over(bay), []).append(part)
                left = left.difference(part)
        if left.area > 1e-6:
            by_height.setdefault(self.plan.height, []).append(left)
        return tuple(Region(shapely.union_all(parts), height) for height, parts in sorted(by_height.items()))

    def height_at(self, x: float, z: float) -> float | None:
        """Ceiling height [m] over a spot, None outside the floor."""
        import shapely

        spot = shapely.Point(x, z)
        return next((region.height for region in self.all if region.shape.intersects(spot)), None)

    def along(self, start: ArrayLike, end: ArrayLike) -> list[tuple[float, float, float]]:
        """(from, to, ceiling height) [m] along the line start → end of [x, z] as far as it lies over the floor."""
        import shapely

        a, b = np.asarray(start, float), np.asarray(end, float)
        line, length = shapely.LineString([a, b]), float(np.linalg.norm(b - a))
        found = []
        for region in self.all:
            for piece in shapely.get_parts(region.shape.intersection(line)):
                if piece.geom_type == "LineString" and piece.length > 2 * _HAIR:
                    ends = sorted(float(line.project(shapely.Point(p))) for p in piece.coords)
                    found.append((max(0.0, ends[0] - _HAIR), min(length, ends[-1] + _HAIR), region.height))
        return sorted(found)

    def steps(self) -> list[tuple[Floats, Floats, float, float]]:
        """(start, end, low, high): where a higher ceiling meets a lower one, as [x, z] ends and heights [m]; the
        wall between them, start → end to the right, is seen from the higher side."""
        import shapely

        found = []
        for low in self.all:
            for high in self.all:
                if high.height <= low.height:
                    continue
                shared = shapely.line_merge(high.shape.boundary.intersection(low.shape.boundary)).simplify(
                    1e-6
                )
                for piece in shapely.get_parts(shared):
                    if piece.geom_type != "LineString":
                        continue
                    points = np.asarray(piece.coords)
                    for a, b in zip(points, points[1:], strict=False):
                        if np.linalg.norm(b - a) > 0.05:
                            found.append((*self._oriented(a, b, high), low.height, high.height))
        return found

    @staticmethod
    def _oriented(a: Floats, b: Floats, high: Region) -> tuple[Floats, Floats]:
        import shapely

        along = (b - a) / np.linalg.norm(b - a)
        beside = (a + b) / 2 + 0.01 * np.array([-along[1], along[0]])
        return (a, b) if high.shape.contains(shapely.Point(beside)) else (b, a)
