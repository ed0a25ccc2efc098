"""A cloth at rest: its material, the sheet with its stencils of stretch and bending, its masses and energies."""

from __future__ import annotations

from sim_core.cloth.sheet.energies import edge_tensions, energies, vertex_forces
from sim_core.cloth.sheet.mass_lumping import evened
from sim_core.cloth.sheet.material import Material
from sim_core.cloth.sheet.sheet import Sheet, mended

__all__ = [
    "Material",
    "Sheet",
    "edge_tensions",
    "energies",
    "evened",
    "mended",
    "vertex_forces",
]
