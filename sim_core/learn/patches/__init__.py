"""What a network is told of coarse vertices and says about them; what fine ones make of it, and lack to balance."""

from sim_core.learn.patches.imbalance import SAG, Imbalance, limited
from sim_core.learn.patches.patches import CUBIC, Patches
from sim_core.learn.patches.surroundings import SEEN, TWO_RINGS, Surroundings

__all__ = ["CUBIC", "SAG", "SEEN", "TWO_RINGS", "Imbalance", "Patches", "Surroundings", "limited"]
