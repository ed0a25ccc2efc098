"""Dressing: `dress` takes an outfit to garments, run by run, and measures what came of it."""

from sim_core.garment.dressing.course import courses
from sim_core.garment.dressing.dress import Frame, dress
from sim_core.garment.dressing.fitting import check_fits
from sim_core.garment.dressing.materials import materials_of, simplified
from sim_core.garment.dressing.order import layer_order, overlap
from sim_core.garment.dressing.places import belt_pairs
from sim_core.garment.dressing.quality import measured, seam_gap
from sim_core.garment.dressing.records import forget
from sim_core.garment.dressing.sewn_sheet import SewnSheet, sewn_sheet
from sim_core.garment.dressing.wearing import capped

__all__ = [
    "Frame",
    "SewnSheet",
    "belt_pairs",
    "capped",
    "check_fits",
    "courses",
    "dress",
    "forget",
    "layer_order",
    "materials_of",
    "measured",
    "overlap",
    "seam_gap",
    "sewn_sheet",
    "simplified",
]
