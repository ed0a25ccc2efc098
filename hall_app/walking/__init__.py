"""Walking: solids, the body among them, the mover, the clearance grid, the authority over a visitor's pose."""

from hall_app.walking.body import BODY, Body, World, world_of
from hall_app.walking.grid import (
    CELL,
    GRID_VERSION,
    Grid,
    UnreachableError,
    bake,
    cached_grid,
    flood,
    grid_key,
)
from hall_app.walking.mover import SPEED, Keys, Pose, step
from hall_app.walking.session import EYE_MAX, EYE_MIN, MAX_INPUT_DT, Moved, WalkReply, WalkSession
from hall_app.walking.solids import Floor, Prism, Round, Solid, SolidError, wall

__all__ = [
    "BODY",
    "CELL",
    "EYE_MAX",
    "EYE_MIN",
    "GRID_VERSION",
    "MAX_INPUT_DT",
    "SPEED",
    "Body",
    "Floor",
    "Grid",
    "Keys",
    "Moved",
    "Pose",
    "Prism",
    "Round",
    "Solid",
    "SolidError",
    "UnreachableError",
    "WalkReply",
    "WalkSession",
    "World",
    "bake",
    "cached_grid",
    "flood",
    "grid_key",
    "step",
    "wall",
    "world_of",
]
