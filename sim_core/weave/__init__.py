"""Weaving: drafts -> relaxed yarns -> tileable maps and cloth parameters.

`draft` and `yarn` hold what is woven, `model` the `Weave` made of them (`weave_file` reads its TOML). `yarns` relaxes
it, `maps` draws it, `cloth` says how it behaves; `loom` remembers what was made of each weave. `files` reads and writes
drafts of other programs, `chart` draws drafts for weavers, `summary` and `command` tell it all to people.
"""

from sim_core.errors import WeaveError
from sim_core.weave.cloth import (
    ClothParameters,
    examined,
    measured,
    parameters_of,
)
from sim_core.weave.draft import Channels, Draft, plain, satin, twill
from sim_core.weave.loom import Loom
from sim_core.weave.maps import SurfaceMaps, lit_cloth, surface_maps
from sim_core.weave.model import Weave, draft_to_dict
from sim_core.weave.summary import facts_of, summary_of
from sim_core.weave.yarn import Yarn
from sim_core.weave.yarns import ParticleCell, YarnGeometry, relax, relax_particles, solve

__all__ = [
    "Channels",
    "ClothParameters",
    "Draft",
    "Loom",
    "ParticleCell",
    "SurfaceMaps",
    "Weave",
    "WeaveError",
    "Yarn",
    "YarnGeometry",
    "examined",
    "draft_to_dict",
    "facts_of",
    "lit_cloth",
    "measured",
    "parameters_of",
    "plain",
    "relax",
    "relax_particles",
    "satin",
    "solve",
    "summary_of",
    "surface_maps",
    "twill",
]
