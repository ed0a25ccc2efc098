"""Weaving: drafts -> periodic yarn geometry -> tileable texture maps and cloth parameters."""

from sim_core.errors import WeaveError
from sim_core.weave.draft import Channels, Draft, plain, satin, twill
from sim_core.weave.drawing import lit_picture
from sim_core.weave.geometry import ClothParameters, TextureMaps, YarnGeometry
from sim_core.weave.maps import texture_maps
from sim_core.weave.model import Weave
from sim_core.weave.parameters import cloth_parameters
from sim_core.weave.particles import ParticleCell, relax_particles
from sim_core.weave.relaxation import relax
from sim_core.weave.solve import solve
from sim_core.weave.surface import SurfaceMaps, lit_cloth, surface_maps
from sim_core.weave.yarn import Yarn

__all__ = [
    "Channels",
    "ClothParameters",
    "Draft",
    "ParticleCell",
    "SurfaceMaps",
    "TextureMaps",
    "Weave",
    "WeaveError",
    "Yarn",
    "YarnGeometry",
    "cloth_parameters",
    "lit_cloth",
    "lit_picture",
    "plain",
    "relax",
    "relax_particles",
    "satin",
    "solve",
    "surface_maps",
    "texture_maps",
    "twill",
]
