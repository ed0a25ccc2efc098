"""Growth triangulation (Eq. 9): exactly Delaunay, whole, the same in any order of the points.

`growth` drives a front of open edges and asks `apex` for the best point of each, which no one of the `walls` hides;
what would take too long goes to `incremental`, point by point with `flips`. `point_set` is the door for points alone.
"""

from sim_core.mesh.triangulation.growth import PATIENCE, grow_points
from sim_core.mesh.triangulation.incremental import inner_faces, joined_points
from sim_core.mesh.triangulation.point_set import triangulate

__all__ = ["PATIENCE", "grow_points", "inner_faces", "joined_points", "triangulate"]
