"""A scan as coarse as it may be: rounds of collapses, and the level that measuring allows.

collapses: compiled; coarsening: falling numbers of triangles; deviation: measured both ways.
"""

from sim_core.mesh.scan.levels.coarsening import Level, coarsened
from sim_core.mesh.scan.levels.deviation import Chosen, Deviation, Fine, chosen_level

__all__ = ["Chosen", "Deviation", "Fine", "Level", "chosen_level", "coarsened"]
