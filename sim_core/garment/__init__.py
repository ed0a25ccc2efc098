"""Garments: patterns, outfits, dressing, the drape as a value, levels of detail and GLB. See README.md."""

from sim_core.body import Stand
from sim_core.garment.clip import Clip
from sim_core.garment.dressing import Frame, check_fits, dress, layer_order, measured
from sim_core.garment.garment import Garment
from sim_core.garment.garment_sheet import garment_sheet
from sim_core.garment.glb import Clothed, opaque, write_glb
from sim_core.garment.levels import choose_detail
from sim_core.garment.outfit import Layer, Outfit, load_motion, load_outfit
from sim_core.garment.pattern import Pattern
from sim_core.garment.settled import Settled
from sim_core.garment.worn import Played, follow, move, moving_errors

__all__ = [
    "Clip",
    "Clothed",
    "Frame",
    "Garment",
    "Layer",
    "Outfit",
    "Pattern",
    "Played",
    "Settled",
    "Stand",
    "check_fits",
    "choose_detail",
    "dress",
    "follow",
    "garment_sheet",
    "layer_order",
    "load_motion",
    "load_outfit",
    "measured",
    "move",
    "moving_errors",
    "opaque",
    "write_glb",
]
