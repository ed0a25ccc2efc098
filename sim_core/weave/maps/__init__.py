"""What one sees of a relaxed cloth.

`samples` says which yarn is on top at each place (by numba; `gl_samples` by OpenGL where that is, never imported
here), `filaments` draws what shines on them, `surface` averages them into tileable maps, `averages` says how those look
from afar, `dyed` how they are coloured near and afar, `figured_maps` puts those of a figured cloth together, `tubes`
writes yarns as meshes, `figure1` is the paper's Fig. 1 as code.
"""

from sim_core.weave.maps.averages import FarLook, MapsLike, far_look, line_angle
from sim_core.weave.maps.dyed import (
    SHEER,
    coarser_direction,
    coloured,
    coverage,
    dyed,
    linear,
    mean_colour,
    seen_afar,
    srgb,
)
from sim_core.weave.maps.figure1 import figure_one, figure_one_picture
from sim_core.weave.maps.figured_maps import FiguredMaps, drawn_maps, figured_maps
from sim_core.weave.maps.surface import SurfaceMaps, highlight, lit_cloth, surface_maps
from sim_core.weave.maps.tubes import coloured_stretches, tube_mesh, write_yarns

__all__ = [
    "SHEER",
    "FarLook",
    "FiguredMaps",
    "MapsLike",
    "SurfaceMaps",
    "coarser_direction",
    "coloured",
    "coloured_stretches",
    "coverage",
    "drawn_maps",
    "dyed",
    "far_look",
    "figure_one",
    "figure_one_picture",
    "figured_maps",
    "highlight",
    "line_angle",
    "linear",
    "lit_cloth",
    "mean_colour",
    "seen_afar",
    "srgb",
    "surface_maps",
    "tube_mesh",
    "write_yarns",
]
