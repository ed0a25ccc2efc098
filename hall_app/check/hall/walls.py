"""Walls as what is fitted into them sees them: ends, bodies, how high they are drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hall_app.content.schema.plan import PlanFile, Wall
from hall_app.content.schema.values import Point
from hall_app.room.structure.regions import Regions

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

__all__ = ["INSIDE", "Fault", "Floats", "body", "ends", "height", "measured", "spot"]

Floats = NDArray[np.float64]
Fault = tuple[str, str, str]  # key, what is wrong, remedy
INSIDE = "move it inside the outline"


def ends(wall: Wall) -> Floats:
    """(2, 2) [m]: both ends of its middle line, [x, z]."""
    return np.array([wall.start, wall.end], float)


def body(wall: Wall) -> BaseGeometry:
    """The floor it stands on."""
    import shapely

    return shapely.LineString([wall.start, wall.end]).buffer(wall.thickness / 2, cap_style="flat")


def height(wall: Wall, plan: PlanFile, regions: Regions) -> float:
    """How high a wall is drawn [m]: one as high as the rooms goes up to the ceiling on either side."""
    if not plan.to_ceiling(wall):
        return wall.height
    line = ends(wall)
    along = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    out = np.array([-along[1], along[0]]) * (wall.thickness / 2 + 1e-3)
    beside = [span[2] for way in (out, -out) for span in regions.along(line[0] + way, line[1] + way)]
    return max(beside, default=wall.height)


def measured(points: Floats, line: Floats) -> tuple[Floats, Floats]:
    """(N,) [m] of points (N, 2): how far along the line from its first end, how far beside it."""
    along = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    away = points - line[0]
    return away @ along, away @ np.array([-along[1], along[0]])


def spot(point: Point) -> str:
    """A point as messages tell it."""
    return f"x = {point[0]:g}, z = {point[1]:g}"
