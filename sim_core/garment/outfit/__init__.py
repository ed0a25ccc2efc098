"""Outfits: what is dressed on whom, as data. `load_outfit` reads one, `sim_core.garment.dress` dresses it."""

from sim_core.body.motion import load_motion
from sim_core.garment.outfit.file import default_program, load_outfit
from sim_core.garment.outfit.outfit import Layer, Outfit, Program
from sim_core.garment.outfit.steps import GRAVITY, Belt, Step, Touch

__all__ = [
    "Belt",
    "GRAVITY",
    "Layer",
    "Outfit",
    "Program",
    "Step",
    "Touch",
    "default_program",
    "load_motion",
    "load_outfit",
]
