"""What is measured on a mesh, and what must hold of it.

`triangles` has areas, angles and shapes; `verification` refuses what is no manifold that fills its contours; `report`
sums up.
"""

from sim_core.mesh.measures.report import MeshReport, deviation
from sim_core.mesh.measures.triangles import quality, stars, triangle_areas
from sim_core.mesh.measures.verification import mesh_fault, open_edges

__all__ = ["MeshReport", "deviation", "mesh_fault", "open_edges", "quality", "stars", "triangle_areas"]
