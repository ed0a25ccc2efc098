"""Cloth: an explicit edge-tension solver with contact, friction and self-contact. See README.md.

What needs scipy's geometry is handed out when it is asked for (PEP 562), so that a run starts at once.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from sim_core.cloth.air import Air
from sim_core.cloth.certificate import Certificate
from sim_core.cloth.collider import Box, Capsule, Cylinder, GridSdf, HalfSpace, Solid, Union
from sim_core.cloth.draping import Contact, Drape, Phase, drape
from sim_core.cloth.holding import Holds
from sim_core.cloth.live import Live
from sim_core.cloth.material import Material
from sim_core.cloth.moving import MovingGrid, moving_mesh
from sim_core.cloth.precision import Pace
from sim_core.cloth.sheet import Sheet

if TYPE_CHECKING:
    from sim_core.cloth.fidelity import Choice, choose
    from sim_core.cloth.field import DistanceField, field_of
    from sim_core.cloth.scenes import Scene, scene

__all__ = [
    "Air",
    "Box",
    "Capsule",
    "Certificate",
    "Choice",
    "Contact",
    "Cylinder",
    "DistanceField",
    "Drape",
    "GridSdf",
    "HalfSpace",
    "Holds",
    "Live",
    "Material",
    "MovingGrid",
    "Pace",
    "Phase",
    "Scene",
    "Sheet",
    "Solid",
    "Union",
    "choose",
    "drape",
    "field_of",
    "moving_mesh",
    "scene",
]

_LATE = {
    "Choice": "fidelity",
    "DistanceField": "field",
    "Scene": "scenes",
    "choose": "fidelity",
    "field_of": "field",
    "scene": "scenes",
}


def __getattr__(name: str) -> object:
    if name not in _LATE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_LATE[name]}"), name)
