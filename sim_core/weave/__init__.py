"""Weaving: drafts -> relaxed yarns -> tileable maps and cloth parameters."""

from sim_core.errors import WeaveError
from sim_core.weave.cloth import cloth_parameters
from sim_core.weave.draft.draft import Channels, Draft, plain, satin, twill
from sim_core.weave.maps.surface import SurfaceMaps, lit_cloth, surface_maps
from sim_core.weave.model import Weave
from sim_core.weave.summary import parameters_of
from sim_core.weave.yarn import Yarn
from sim_core.weave.yarns.beams import relax
from sim_core.weave.yarns.geometry import ClothParameters, YarnGeometry
from sim_core.weave.yarns.particles.cell import ParticleCell, relax_particles
from sim_core.weave.yarns.solver import solve

__all__ = [
    "Channels",
    "ClothParameters",
    "Draft",
    "ParticleCell",
    "SurfaceMaps",
    "Weave",
    "WeaveError",
    "Yarn",
    "YarnGeometry",
    "cloth_parameters",
    "lit_cloth",
    "parameters_of",
    "plain",
    "relax",
    "relax_particles",
    "satin",
    "solve",
    "surface_maps",
    "twill",
]
