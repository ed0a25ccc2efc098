"""How cloth lies before it is dressed: flat before and behind, wrapped, over a bar, along a path, folded, upright."""

from sim_core.garment.placement.along_path import Accordion, AlongPath, Knot, arranged_path, swept
from sim_core.garment.placement.flat import Flat
from sim_core.garment.placement.folded import Folded
from sim_core.garment.placement.ground import WORN, Ground
from sim_core.garment.placement.over_bar import OverBar
from sim_core.garment.placement.upright import Upright
from sim_core.garment.placement.wrapped import Wrapped

Placement = Flat | OverBar | AlongPath | Wrapped | Folded | Upright

__all__ = [
    "WORN",
    "Accordion",
    "AlongPath",
    "Flat",
    "Folded",
    "Ground",
    "Knot",
    "OverBar",
    "Placement",
    "Upright",
    "Wrapped",
    "arranged_path",
    "swept",
]
