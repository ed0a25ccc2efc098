"""How cloth is put before it falls: flat before and behind, over a bar, along a path."""

from sim_core.garment.placement.along_path import Accordion, arranged_path, swept
from sim_core.garment.placement.flat import Laying, laid
from sim_core.garment.placement.over_bar import Gathering, gathered_strip

__all__ = [
    "Accordion",
    "Gathering",
    "Laying",
    "arranged_path",
    "gathered_strip",
    "laid",
    "swept",
]
