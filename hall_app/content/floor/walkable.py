"""The hall's content as a floor to walk on, and which of its spots a visitor can come to."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from hall_app.content.floor.footprints import Footprint, solids_of
from hall_app.content.folder import Content, Exhibit
from hall_app.content.schema.plan import PlanFile

if TYPE_CHECKING:
    from hall_app.walk import Floor, Prism, Round

SEEN_OVER = 1.2  # [m] a visitor looks over what is lower than this


def walking_floor(plan: PlanFile, exhibits: Iterable[Exhibit]) -> Floor:
    """Outline, walls, solids and exhibits' bodies as a floor of hall_app.walk."""
    from hall_app.walk import Floor

    return Floor(plan.outline, tuple(walking_solid(footprint) for footprint in solids_of(plan, exhibits)))


def walking_solid(footprint: Footprint) -> Prism | Round:
    """One footprint as a solid of hall_app.walk."""
    from hall_app.walk import Prism, Round

    if footprint.round:
        return Round(*footprint.round, footprint.height)
    return Prism(footprint.polygon or (), footprint.height)


def reached_spots(content: Content) -> np.ndarray:
    """(N, 2) [m]: the spots [x, z] of the walking grid a visitor can reach on foot from the start."""
    return _reached(walking_floor(content.plan, content.exhibits), content.hall.start.x, content.hall.start.z)


@lru_cache(maxsize=2)
def _reached(floor: Floor, x: float, z: float) -> np.ndarray:
    from hall_app.walk import bake, flood

    grid = bake(floor)
    rows, columns = np.nonzero(flood(grid, (x, z)))
    return np.column_stack([grid.x0 + columns * grid.cell, grid.z0 + rows * grid.cell])


def facing_spots(content: Content, exhibit: Exhibit, spots: np.ndarray, *, within: float) -> np.ndarray:
    """Those of `spots` (N, 2) at most `within` [m] from the exhibit's body with a free view of its middle.

    What is lower than SEEN_OVER hides nothing, neither does the booth it stands on.
    """
    import shapely

    place = exhibit.file.place
    footprints = solids_of(content.plan, content.exhibits)
    body = next(f.shape() for f in footprints if f.kind == "exhibit" and f.id == exhibit.id)
    near = spots[shapely.distance(shapely.points(spots), body) <= within]
    if not len(near):
        return near
    hiding = [
        footprint.shape()
        for footprint in footprints
        if footprint.height > SEEN_OVER and footprint.id not in (exhibit.id, place.on)
    ]
    ends = np.broadcast_to([place.x, place.z], near.shape)
    views = shapely.linestrings(np.stack([near, ends], axis=1))
    return near[~shapely.intersects(views, shapely.union_all(hiding))]
