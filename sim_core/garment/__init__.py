"""Garments: patterns, placing, the drape as a value, levels of detail and GLB. See README.md."""

from sim_core.garment.detail import choose_detail, detail
from sim_core.garment.following import follow
from sim_core.garment.glb import write_glb
from sim_core.garment.model import Garment
from sim_core.garment.pattern import Pattern
from sim_core.garment.placing import Gathering
from sim_core.garment.robe import robe_on_figure
from sim_core.garment.scarf import scarf_on_stand
from sim_core.garment.stand import Stand

__all__ = [
    "Garment",
    "Gathering",
    "Pattern",
    "Stand",
    "choose_detail",
    "detail",
    "follow",
    "robe_on_figure",
    "scarf_on_stand",
    "write_glb",
]
