"""A garment as it is cut: panels, seams, pattern files and GarmentCode, and the cloth they are meshed to."""

from sim_core.garment.pattern.cloth import SIDES, Cloth, both_halves, creases_of, cut_cloth, unsided
from sim_core.garment.pattern.measures import measured
from sim_core.garment.pattern.panels import Panel, Path, Seam, Spot, Tie
from sim_core.garment.pattern.pattern import Pattern
from sim_core.garment.pattern.pleats import Opened, Pleat, Plies, latches
from sim_core.garment.pattern.transfer import Transfer

__all__ = [
    "SIDES",
    "Cloth",
    "Panel",
    "Path",
    "Pattern",
    "Opened",
    "Pleat",
    "Plies",
    "Seam",
    "Spot",
    "Tie",
    "Transfer",
    "both_halves",
    "creases_of",
    "cut_cloth",
    "latches",
    "measured",
    "unsided",
]
