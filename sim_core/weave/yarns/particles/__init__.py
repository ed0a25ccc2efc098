"""Stage B: yarns as particles in three dimensions, on one energy, brought to rest.

`scale` has the units, `forces` the kernels of bending, contact and friction, `closest_pairs` contact between the
particles. `nesterov` takes steps, which `preconditioner` divides by each yarn's own stiffness; large `figures` rest
by way of `common_waves`. `cell` is the call, and the relaxed repeat that it returns.
"""

from sim_core.weave.yarns.particles.cell import NotAtRest, ParticleCell, is_figure, relax_particles
from sim_core.weave.yarns.particles.closest_pairs import curve_gaps, curve_overlap, pin_forces
from sim_core.weave.yarns.particles.common_waves import CommonWaves, gathered
from sim_core.weave.yarns.particles.forces import contact_forces, side_forces, yarn_forces
from sim_core.weave.yarns.particles.preconditioner import advance, factored
from sim_core.weave.yarns.particles.scale import System, Units

__all__ = [
    "CommonWaves",
    "NotAtRest",
    "ParticleCell",
    "System",
    "Units",
    "advance",
    "contact_forces",
    "curve_gaps",
    "curve_overlap",
    "factored",
    "gathered",
    "is_figure",
    "pin_forces",
    "relax_particles",
    "side_forces",
    "yarn_forces",
]
