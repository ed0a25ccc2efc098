"""Walking: solids, the body among them, the mover, the clearance grid, the authority over a visitor's pose.

README.md has the mathematics.
"""

from hall_app.walk.body import BODY, Body, World, world_of
from hall_app.walk.grid import (
    CELL,
    GRID_VERSION,
    Grid,
    UnreachableError,
    bake,
    cached_grid,
    flood,
    grid_key,
)
from hall_app.walk.mover import SLIDE, SPEED, STEEP, TOUCH, Keys, Pose, step
from hall_app.walk.session import (
    ARREARS,
    BUCKET,
    EYE_MAX,
    EYE_MIN,
    HOLD,
    MAX_INPUT_DT,
    Moved,
    WalkReply,
    WalkSession,
)
from hall_app.walk.solids import Floor, Prism, Round, Solid, SolidError, wall

__all__ = [
    "ARREARS",
    "BODY",
    "BUCKET",
    "CELL",
    "EYE_MAX",
    "EYE_MIN",
    "GRID_VERSION",
    "HOLD",
    "MAX_INPUT_DT",
    "SLIDE",
    "SPEED",
    "STEEP",
    "TOUCH",
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
