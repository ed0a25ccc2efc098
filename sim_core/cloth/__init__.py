"""Cloth: an explicit edge-tension solver with contact, friction and self-contact. See README.md.

What needs scipy's geometry is handed out when it is asked for (PEP 562), so that a run starts at once.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from sim_core.cloth.contact import Box, Capsule, Cylinder, GridSdf, HalfSpace, Holds, Solid, Union
from sim_core.cloth.run import Certificate, Checkpoint, Drape, Live, drape
from sim_core.cloth.sheet import Material, Sheet
from sim_core.cloth.step import Air, Contact, Pace, Phase

if TYPE_CHECKING:
    from sim_core.cloth.contact import DistanceField, MovingGrid, field_of, moving_mesh
    from sim_core.cloth.scenes import Alternative, Choice, Scene, choose, scene

__all__ = [
    "Air",
    "Alternative",
    "Box",
    "Capsule",
    "Certificate",
    "Checkpoint",
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
    "Alternative": "scenes",
    "Choice": "scenes",
    "DistanceField": "contact",
    "MovingGrid": "contact",
    "Scene": "scenes",
    "choose": "scenes",
    "field_of": "contact",
    "moving_mesh": "contact",
    "scene": "scenes",
}


def __getattr__(name: str) -> object:
    if name not in _LATE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_LATE[name]}"), name)
