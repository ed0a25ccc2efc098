"""A cloth at rest: its material, the sheet with its stencils of stretch and bending, its masses and energies."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from sim_core.cloth.sheet.energies import edge_tensions, energies, vertex_forces
from sim_core.cloth.sheet.mass_lumping import evened
from sim_core.cloth.sheet.material import Material
from sim_core.cloth.sheet.sheet import Sheet

if TYPE_CHECKING:
    from sim_core.cloth.sheet.repair import mended

__all__ = [
    "Material",
    "Sheet",
    "edge_tensions",
    "energies",
    "evened",
    "mended",
    "vertex_forces",
]

_LATE = {
    "mended": "repair",
}


def __getattr__(name: str) -> object:
    if name not in _LATE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_LATE[name]}"), name)
