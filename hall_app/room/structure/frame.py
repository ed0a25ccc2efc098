"""The timber frame as the columns give it: which beams run where, and how high."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hall_app.room.structure.regions import Regions

if TYPE_CHECKING:
    from hall_app.content.schema import PlanFile, Solid

__all__ = ["JOIST", "Beam", "Column", "beams_of", "columns_of"]

JOIST = 0.12  # [m] depth of the joists under the ceiling's boards
ARCADE, CROSS = (0.30, 0.40), (0.28, 0.36)  # [m] width and depth of beams
_IN_LINE = 0.05  # [m] columns this far off one line still carry one beam
_LONGEST = 9.0
_BESIDE_WALL = 0.45  # [m] a beam nearer to a parallel edge of the floor is left out


@dataclass(frozen=True)
class Column:
    """A column of the plan: middle [x, z], half width or radius of its base, square base or round, its own height."""

    at: tuple[float, float]
    half: float
    square: bool
    facing: float
    height: float


@dataclass(frozen=True)
class Beam:
    """A beam from `start` to `end` [x, z]: underside and top [m], width [m]; arcade: it carries a higher wall;
    on_wall: its end goes into a wall it meets, not onto a column."""

    start: tuple[float, float]
    end: tuple[float, float]
    low: float
    high: float
    width: float
    arcade: bool
    on_wall: bool = False


def columns_of(plan: PlanFile) -> list[Column]:
    """The plan's columns; one given by a polygon counts as the square round its middle."""
    return [_column(solid) for solid in plan.solid if solid.kind == "column"]


def _column(solid: Solid) -> Column:
    if solid.round is not None:
        at = (solid.round.x, solid.round.z)
        return Column(at, solid.round.radius, False, 0.0, solid.height)
    if solid.size is not None and solid.at is not None:
        return Column(solid.at, min(solid.size) / 2, True, solid.facing, solid.height)
    ring = np.asarray(solid.polygon, float)
    middle = (ring.min(0) + ring.max(0)) / 2
    half = float((ring.max(0) - ring.min(0)).min() / 2) * 0.9
    return Column((float(middle[0]), float(middle[1])), half, True, 0.0, solid.height)


def beams_of(plan: PlanFile, regions: Regions) -> list[Beam]:
    """Beams between neighbouring columns in one line along x or z, and from the last of a line on to the wall."""
    spots = np.array([column.at for column in columns_of(plan)]).reshape(-1, 2)
    found: list[Beam] = []
    for axis in (0, 1):
        for line in _lines(spots, axis):
            for a, b in zip(line, line[1:], strict=False):
                found += _between(spots[a], spots[b], regions)
            if len(line) > 1:
                found += _to_wall(spots[line[-1]], spots[line[-2]], regions)
                found += _to_wall(spots[line[0]], spots[line[1]], regions)
    return found


def _lines(spots: NDArray[np.float64], axis: int) -> list[list[int]]:
    """Indices of the columns that stand in one line along `axis`, in order."""
    groups: dict[int, list[int]] = {}
    for index, spot in enumerate(spots):
        groups.setdefault(round(float(spot[1 - axis]) / _IN_LINE), []).append(index)
    return [sorted(group, key=lambda k: float(spots[k, axis])) for group in groups.values()]


def _between(a: NDArray[np.float64], b: NDArray[np.float64], regions: Regions) -> list[Beam]:
    length = float(np.linalg.norm(b - a))
    if not 0.5 < length < _LONGEST or _along_edge(a, b, regions):
        return []
    middle, along = (a + b) / 2, (b - a) / length
    beside = 0.3 * np.array([-along[1], along[0]])
    heights = [regions.height_at(*(middle + sign * beside)) for sign in (1, -1)]
    if None in heights:
        return []
    low, high = sorted(h for h in heights if h is not None)
    ends = (float(a[0]), float(a[1])), (float(b[0]), float(b[1]))
    if high - low > 0.05:
        return [Beam(*ends, low - ARCADE[1], low, ARCADE[0], True)]
    top = low - JOIST
    return [Beam(*ends, top - CROSS[1], top, CROSS[0], False)]


def _to_wall(a: NDArray[np.float64], before: NDArray[np.float64], regions: Regions) -> list[Beam]:
    """The beam that goes on from column `a`, away from `before`, to the edge of the floor."""
    import shapely

    along = (a - before) / np.linalg.norm(a - before)
    ray = shapely.LineString([a, a + _LONGEST * along])
    inside = [
        p for p in shapely.get_parts(regions.floor.intersection(ray)) if p.distance(shapely.Point(a)) < 0.01
    ]
    if not inside or inside[0].length > _LONGEST - 0.1:
        return []
    end = a + inside[0].length * along
    over = any(_runs_over(wall.start, wall.end, a, end) for wall in regions.plan.wall)
    return [replace(beam, on_wall=not over) for beam in _between(a, end, regions)]


def _runs_over(start: ArrayLike, finish: ArrayLike, a: ArrayLike, b: ArrayLike) -> bool:
    """Whether the wall start → finish carries the beam a → b on most of its length."""
    import shapely

    wall = shapely.LineString([np.asarray(start), np.asarray(finish)]).buffer(0.1, cap_style="flat")
    beam = shapely.LineString([np.asarray(a), np.asarray(b)])
    return beam.intersection(wall).length > 0.5 * beam.length


def _along_edge(a: NDArray[np.float64], b: NDArray[np.float64], regions: Regions) -> bool:
    import shapely

    line = shapely.LineString([a, b])
    edge = regions.floor.exterior
    return all(edge.distance(line.interpolate(t, normalized=True)) < _BESIDE_WALL for t in (0.25, 0.5, 0.75))
