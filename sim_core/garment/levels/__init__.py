"""A garment as fine as it is looked at: its drape thinned, and of who wears it what can be seen."""

from sim_core.garment.levels.coarser import choose_detail
from sim_core.garment.levels.figure import BASE, shown_figure
from sim_core.garment.levels.thinning import Thinning

__all__ = [
    "BASE",
    "Thinning",
    "choose_detail",
    "shown_figure",
]
