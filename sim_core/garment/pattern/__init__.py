"""A garment as it is cut: panels, seams, pattern files and GarmentCode, and the cloth they are meshed to."""

from sim_core.garment.pattern.cloth import SIDES, Cloth, cut_cloth, unsided
from sim_core.garment.pattern.measures import measured
from sim_core.garment.pattern.panels import Panel, Path, Seam, Spot, Tie
from sim_core.garment.pattern.pattern import Pattern
from sim_core.garment.pattern.transfer import Transfer

__all__ = [
    "SIDES",
    "Cloth",
    "Panel",
    "Path",
    "Pattern",
    "Seam",
    "Spot",
    "Tie",
    "Transfer",
    "cut_cloth",
    "measured",
    "unsided",
]
