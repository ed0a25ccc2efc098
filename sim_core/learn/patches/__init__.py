"""What a network says about coarse vertices, what becomes of fine ones by it, and what is then missing to balance."""

from sim_core.learn.patches.imbalance import Imbalance
from sim_core.learn.patches.patches import CUBIC, Patches

__all__ = ["CUBIC", "Imbalance", "Patches"]
