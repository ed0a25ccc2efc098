"""Three ways to dress: a scarf on a stand, a robe on a figure, a scarf over a robe."""

from sim_core.garment.recipes.dressing import GAP, SAG, nape_pins, robe_holds, robe_materials, seam_gap
from sim_core.garment.recipes.halves import Half, half_sheet
from sim_core.garment.recipes.pibo import (
    FALLING,
    HELD,
    PiboSettings,
    field_under,
    laid_along,
    pibo_on_figure,
    solids_under,
)
from sim_core.garment.recipes.robe import robe_on_figure
from sim_core.garment.recipes.scarf import PHASES, scarf_on_stand
from sim_core.garment.recipes.schedule import Schedule
from sim_core.garment.recipes.worn_solid import capped

__all__ = [
    "FALLING",
    "GAP",
    "HELD",
    "Half",
    "PHASES",
    "PiboSettings",
    "SAG",
    "Schedule",
    "capped",
    "field_under",
    "half_sheet",
    "laid_along",
    "pibo_on_figure",
    "robe_materials",
    "robe_on_figure",
    "scarf_on_stand",
    "robe_holds",
    "nape_pins",
    "seam_gap",
    "solids_under",
]
