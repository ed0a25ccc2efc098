"""Meshing: outline -> staggered points -> redundant points out -> growth triangulation -> quality.

`geometry` knows nothing of panels; `outline` checks and samples contours, `points` fills them, `triangulation` joins
the points, `measures` says how good a mesh is and what must hold of it, `improvement` leaves no small angle. `panel`
meshes one panel so, `seams` several whose sides match vertex for vertex. `sheets` reads drawings of patterns, `files`
writes meshes, `command` is `simcore mesh`.
"""

from sim_core.errors import OutlineError
from sim_core.mesh.files import mesh_picture, write_mesh
from sim_core.mesh.geometry import split_quads, surface_net
from sim_core.mesh.measures import MeshReport, mesh_fault, quality, triangle_areas
from sim_core.mesh.outline import (
    SizeField,
    check_count,
    check_edge,
    clean_contours,
    read_size_field,
    sampled_contours,
    signed_area,
)
from sim_core.mesh.panel import PanelMesh, panel_mesh
from sim_core.mesh.points import inside, keep_points, staggered_points
from sim_core.mesh.seams import Seam, SeamFit, SeamSide, SewnPanel, sewn_meshes
from sim_core.mesh.triangulation import triangulate

__all__ = [
    "MeshReport",
    "OutlineError",
    "PanelMesh",
    "Seam",
    "SeamFit",
    "SeamSide",
    "SewnPanel",
    "SizeField",
    "check_count",
    "check_edge",
    "clean_contours",
    "inside",
    "keep_points",
    "mesh_fault",
    "mesh_picture",
    "sampled_contours",
    "panel_mesh",
    "quality",
    "read_size_field",
    "sewn_meshes",
    "signed_area",
    "split_quads",
    "staggered_points",
    "surface_net",
    "triangle_areas",
    "triangulate",
    "write_mesh",
]
