"""Points inside an outline, before anything joins them.

The staggered `lattice` of Eq. 1-8, the filter for redundant ones by `raycast`, a `layer` of points along the outline,
and lattices `graded` by a size field.
"""

from sim_core.mesh.points.graded import graded_points, lattice_near
from sim_core.mesh.points.lattice import staggered_points
from sim_core.mesh.points.raycast import distance_below, inside, keep_points

__all__ = ["distance_below", "graded_points", "inside", "keep_points", "lattice_near", "staggered_points"]
