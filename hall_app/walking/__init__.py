"""Walking: solids, the body among them, the mover, the clearance grid, the authority over a visitor's pose."""

from .body import BODY, Body, World, world_of
from .grid import CELL, GRID_VERSION, Grid, UnreachableError, bake, cached_grid, flood, grid_key
from .mover import SPEED, Keys, Pose, step
from .session import EYE_MAX, EYE_MIN, MAX_INPUT_DT, Moved, WalkReply, WalkSession
from .solids import Floor, Prism, Round, Solid, SolidError, wall

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
