"""Yarns of a weave brought to rest: as beams at the crossings (stage A), as particles between them (stage B).

`geometry` holds what comes out. `jam` refuses what cannot be woven; `beams` relaxes heights in force balance, satins
and twills by one pick (`shifts`), `compound` those of yarns that share a place; `particles` goes on in three
dimensions; `leno_brocade` lays what no grid of crossings holds. `paths` gives the axes of all yarns, whatever the
weave, and `solver` is the one call that chooses among these.
"""

from sim_core.weave.yarns.beams import beam_stiffness, relax
from sim_core.weave.yarns.geometry import FiguredGeometry, Strands, YarnGeometry
from sim_core.weave.yarns.jam import check_jam, jam_limits
from sim_core.weave.yarns.leno_brocade import lay_beams
from sim_core.weave.yarns.particles import NotAtRest, ParticleCell, relax_particles
from sim_core.weave.yarns.paths import main_picks, strands
from sim_core.weave.yarns.progress import progress_report
from sim_core.weave.yarns.shifts import draft_shift, turns_of
from sim_core.weave.yarns.solver import ground_of, solve
from sim_core.weave.yarns.splines import resampled

__all__ = [
    "FiguredGeometry",
    "NotAtRest",
    "ParticleCell",
    "Strands",
    "YarnGeometry",
    "beam_stiffness",
    "check_jam",
    "draft_shift",
    "ground_of",
    "jam_limits",
    "lay_beams",
    "main_picks",
    "progress_report",
    "relax",
    "relax_particles",
    "resampled",
    "solve",
    "strands",
    "turns_of",
]
