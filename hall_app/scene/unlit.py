"""Coloured triangles as a GLB that is drawn without lights (KHR_materials_unlit)."""

from __future__ import annotations

from sim_core.garment.glb_file import GlbFile

from .room import Part

__all__ = ["unlit_glb"]

UNLIT = "KHR_materials_unlit"


def unlit_glb(parts: dict[str, Part], *, double_sided: bool = False) -> bytes:
    """One mesh node a part; colours are linear 0..1, kept as 16-bit fractions. Empty parts are left out."""
    glb = GlbFile()
    material = glb.material({"doubleSided": double_sided, "extensions": {UNLIT: {}}})
    for name, part in parts.items():
        if len(part.faces):
            glb.mesh(name, part.vertices, part.faces, material, colours=part.colours)
    return glb.bytes("hall", [UNLIT], "hall_app.scene")
