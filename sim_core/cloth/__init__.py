"""Cloth: an explicit edge-tension solver with contact, friction and self-contact. See README.md."""

from sim_core.cloth.air import Air
from sim_core.cloth.collider import Box, Capsule, Cylinder, GridSdf, HalfSpace, Solid, Union
from sim_core.cloth.draping import Contact, Drape, Phase, drape
from sim_core.cloth.holding import Holds
from sim_core.cloth.live import Live
from sim_core.cloth.material import Material
from sim_core.cloth.moving import MovingGrid, moving_mesh
from sim_core.cloth.precision import Pace
from sim_core.cloth.sheet import Sheet

__all__ = [
    "Air",
    "Box",
    "Capsule",
    "Contact",
    "Cylinder",
    "Drape",
    "GridSdf",
    "HalfSpace",
    "Holds",
    "Live",
    "Material",
    "MovingGrid",
    "Pace",
    "Phase",
    "Sheet",
    "Solid",
    "Union",
    "drape",
    "moving_mesh",
]
