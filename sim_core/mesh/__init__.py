"""Meshing: outline -> staggered points -> redundant points out -> growth triangulation -> quality."""

from sim_core.errors import OutlineError
from sim_core.mesh.measures.triangles import quality
from sim_core.mesh.model import MeshReport, PanelMesh
from sim_core.mesh.outline.contours import outline_samples
from sim_core.mesh.outline.size_field import SizeField
from sim_core.mesh.panel import panel_mesh
from sim_core.mesh.points.lattice import staggered_points
from sim_core.mesh.points.raycast import inside, keep_points
from sim_core.mesh.seams import Seam, SeamFit, SeamSide, sewn_meshes
from sim_core.mesh.triangulation.point_set import triangulate

__all__ = [
    "MeshReport",
    "OutlineError",
    "PanelMesh",
    "Seam",
    "SeamFit",
    "SeamSide",
    "SizeField",
    "inside",
    "keep_points",
    "outline_samples",
    "panel_mesh",
    "quality",
    "sewn_meshes",
    "staggered_points",
    "triangulate",
]
