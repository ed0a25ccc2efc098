"""A coarse mesh's own picture: laid out flat (charts), painted with the scan's colours (colours)."""

from sim_core.mesh.scan.texture.charts import Layout, laid_out
from sim_core.mesh.scan.texture.colours import Colours, painted

__all__ = ["Colours", "Layout", "laid_out", "painted"]
