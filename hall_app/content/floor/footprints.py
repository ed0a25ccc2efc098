"""Footprints on the hall's floor: what a visitor cannot walk through, as plain polygons and rounds."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from hall_app.content.folder import Exhibit
from hall_app.content.schema.exhibit import ExhibitFile
from hall_app.content.schema.plan import PlanFile, Solid, Wall
from hall_app.content.schema.values import Point

if TYPE_CHECKING:
    from shapely import Polygon

ROUND_SIDES = 32  # of the polygon that stands for a round in exact tests, per quarter circle


@dataclass(frozen=True)
class Footprint:
    """A solid's outline on the floor, [x, z] in metres: either a polygon (N, 2) or a round (x, z, radius)."""

    kind: str
    id: str
    height: float
    polygon: tuple[Point, ...] | None = None
    round: tuple[float, float, float] | None = None

    def as_json(self) -> dict[str, Any]:
        """The footprint as the page reads it."""
        shape = (
            {"round": list(self.round)} if self.round else {"polygon": [list(p) for p in self.polygon or ()]}
        )
        return {"kind": self.kind, "id": self.id, "height": self.height, **shape}

    def shape(self) -> Polygon:
        """The footprint as a shapely polygon."""
        from shapely import Point as Spot
        from shapely import Polygon

        if self.round:
            return Spot(self.round[:2]).buffer(self.round[2], quad_segs=ROUND_SIDES)
        return Polygon(self.polygon)


def turned(points: Iterable[Point], facing: float, at: Point) -> tuple[Point, ...]:
    """Points [x, z] turned by `facing` degrees about +y (0 = +z) and moved to `at`."""
    sine, cosine = math.sin(math.radians(facing)), math.cos(math.radians(facing))
    return tuple(
        (round(at[0] + x * cosine + z * sine, 9), round(at[1] - x * sine + z * cosine, 9)) for x, z in points
    )


def rectangle(size: Point, facing: float, at: Point) -> tuple[Point, ...]:
    """Corners of a rectangle [width, depth] round `at`."""
    half_width, half_depth = size[0] / 2, size[1] / 2
    corners = [(-half_width, -half_depth), (half_width, -half_depth), (half_width, half_depth)]
    return turned([*corners, (-half_width, half_depth)], facing, at)


def wall_footprint(wall: Wall, number: int) -> Footprint:
    """A wall's rectangle; `number` counts from 1."""
    (x0, z0), (x1, z1) = wall.start, wall.end
    size = (wall.thickness, math.hypot(x1 - x0, z1 - z0))
    facing = math.degrees(math.atan2(x1 - x0, z1 - z0))
    polygon = rectangle(size, facing, ((x0 + x1) / 2, (z0 + z1) / 2))
    return Footprint("wall", f"wall-{number}", wall.height, polygon)


def solid_footprint(solid: Solid) -> Footprint:
    """A booth's, bench's, stand's or column's footprint."""
    if solid.round:
        circle = (solid.round.x, solid.round.z, solid.round.radius)
        return Footprint(solid.kind, solid.id, solid.height, round=circle)
    if solid.polygon:
        return Footprint(solid.kind, solid.id, solid.height, solid.polygon)
    assert solid.size is not None
    assert solid.at is not None  # the schema holds that both are given
    return Footprint(solid.kind, solid.id, solid.height, rectangle(solid.size, solid.facing, solid.at))


def body_footprint(identity: str, file: ExhibitFile) -> Footprint:
    """An exhibit's rigid body where it stands."""
    body, place = file.body, file.place
    if body.radius is not None:
        return Footprint("exhibit", identity, body.height, round=(place.x, place.z, body.radius))
    assert body.size is not None  # the schema holds that a box has a size
    polygon = rectangle(body.size, place.facing, (place.x, place.z))
    return Footprint("exhibit", identity, body.height, polygon)


def plan_footprints(plan: PlanFile) -> tuple[Footprint, ...]:
    """Walls and solids of the plan."""
    walls = [wall_footprint(wall, number) for number, wall in enumerate(plan.wall, start=1)]
    return (*walls, *(solid_footprint(solid) for solid in plan.solid))


def solids_of(plan: PlanFile, exhibits: Iterable[Exhibit]) -> tuple[Footprint, ...]:
    """All a visitor cannot walk through: walls, solids of the plan, the exhibits' bodies."""
    return (*plan_footprints(plan), *(body_footprint(exhibit.id, exhibit.file) for exhibit in exhibits))


def foot_height(plan: PlanFile, file: ExhibitFile) -> float:
    """Height [m] of the exhibit's foot: place.y, else the top of what it stands on, else the floor."""
    if file.place.y is not None:
        return file.place.y
    return next((solid.height for solid in plan.solid if solid.id == file.place.on), 0.0)
