"""Who wears a garment: a figure with joints and weights, its poses, and the moving solid that cloth meets."""

from sim_core.body.beneath import Beneath, Surface
from sim_core.body.mannequin import BONES, Mannequin, turn_between
from sim_core.body.pose import Pose
from sim_core.body.stand import Stand
from sim_core.body.wearer import Figure

__all__ = [
    "BONES",
    "Beneath",
    "Figure",
    "Mannequin",
    "Pose",
    "Stand",
    "Surface",
    "turn_between",
]
