"""Our own GLB writer for garments and what bears them."""

from sim_core.garment.glb.model import (
    LACQUER,
    LINEN,
    Afar,
    Clothed,
    Part,
    Shown,
    opaque,
    write_glb,
)

__all__ = ["LACQUER", "LINEN", "Afar", "Clothed", "Part", "Shown", "opaque", "write_glb"]
