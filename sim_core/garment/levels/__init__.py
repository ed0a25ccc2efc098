"""A garment as fine as it is looked at: levels of its own pattern, thinned meshes of what is worn beneath."""

from sim_core.garment.levels.coarser import choose_detail, detail, locate
from sim_core.garment.levels.figure import shown_figure
from sim_core.garment.levels.thinning import Thinning

__all__ = [
    "Thinning",
    "choose_detail",
    "detail",
    "locate",
    "shown_figure",
]
