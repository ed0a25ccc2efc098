"""Computational geometry that knows nothing of panels.

Exact `predicates`, points in `cells` of a grid, boxes within boxes for what is `nearest`, `curves` as polylines,
`convex_lines` round something, and closed surfaces from a sampled distance (`surface_nets`).
"""

from sim_core.mesh.geometry.cells import point_cells
from sim_core.mesh.geometry.convex_lines import hull_girth, line_girth, tangent_line
from sim_core.mesh.geometry.nearest import nearest_others, size_boxes
from sim_core.mesh.geometry.predicates import incircle, orient
from sim_core.mesh.geometry.surface_nets import split_quads, surface_net

__all__ = [
    "hull_girth",
    "incircle",
    "line_girth",
    "nearest_others",
    "orient",
    "point_cells",
    "size_boxes",
    "split_quads",
    "surface_net",
    "tangent_line",
]
