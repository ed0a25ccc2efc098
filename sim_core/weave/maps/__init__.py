"""What one sees of a relaxed cloth.

`samples` says which yarn is on top at each place (by numba; `gl_samples` by OpenGL where that is, never imported
here), `surface` averages them into tileable maps, `tubes` writes yarns as meshes, `figure1` is the paper's Fig. 1 as
code.
"""

from sim_core.weave.maps.figure1 import figure_one, figure_one_picture
from sim_core.weave.maps.surface import SurfaceMaps, lit_cloth, surface_maps
from sim_core.weave.maps.tubes import coloured_stretches, tube_mesh, write_yarns

__all__ = [
    "SurfaceMaps",
    "coloured_stretches",
    "figure_one",
    "figure_one_picture",
    "lit_cloth",
    "surface_maps",
    "tube_mesh",
    "write_yarns",
]
