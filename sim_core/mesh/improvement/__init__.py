"""Meshes without small angles: `panel_mesh(…, quality="best")`.

`angles` finds the small ones; `smoothing` moves points, `repair` adds or removes one, `refinement` puts points in
where a feature is small; `best` is the order in which they are tried.
"""

from sim_core.mesh.improvement.angles import small_angles
from sim_core.mesh.improvement.best import BestFill, best_fill

__all__ = ["BestFill", "best_fill", "small_angles"]
