"""Garments: patterns, placing, the drape as a value, levels of detail and GLB. See README.md."""

from sim_core.body import Stand
from sim_core.garment.follow_body import follow, garment_sheet
from sim_core.garment.garment import Garment
from sim_core.garment.glb import write_glb
from sim_core.garment.levels import choose_detail, detail
from sim_core.garment.pattern import Pattern
from sim_core.garment.placement import Gathering
from sim_core.garment.recipes import robe_on_figure, scarf_on_stand

__all__ = [
    "Garment",
    "Gathering",
    "Pattern",
    "Stand",
    "choose_detail",
    "detail",
    "follow",
    "garment_sheet",
    "robe_on_figure",
    "scarf_on_stand",
    "write_glb",
]
