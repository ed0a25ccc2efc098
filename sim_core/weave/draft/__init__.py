"""Drafts: what a loom is told, as arrays, before any yarn has a size.

`draft` holds the value and the three basic weaves; `notation` reads them by name or from a picture of a motif,
`generators` makes what is derived of them, `structures` what a 0/1 matrix cannot say, `figured` what a motif chooses
among. `algebra` turns threading, tie-up and treadling into the lift and back, `factors` counts by kinds of ends and
picks, `analysis` says what follows.
"""

from sim_core.weave.draft.algebra import Harness, drawdown, harness, lift_plan, tie_up
from sim_core.weave.draft.analysis import float_statistics, hangs_together, summary, summary_of_factors
from sim_core.weave.draft.draft import Channels, Draft, plain, satin, twill
from sim_core.weave.draft.factors import Factors
from sim_core.weave.draft.figured import Figure
from sim_core.weave.draft.generators import (
    basket,
    damask,
    diamond,
    herringbone,
    limit_floats,
    satin_of_six,
    weft_faced,
)
from sim_core.weave.draft.notation import draft_of_words, motif_of
from sim_core.weave.draft.structures import (
    brocade,
    four_end_gauze,
    gauze,
    tapestry,
    warp_compound,
    weft_compound,
)

__all__ = [
    "Channels",
    "Draft",
    "Factors",
    "Figure",
    "Harness",
    "basket",
    "brocade",
    "damask",
    "diamond",
    "draft_of_words",
    "drawdown",
    "float_statistics",
    "four_end_gauze",
    "gauze",
    "hangs_together",
    "harness",
    "herringbone",
    "lift_plan",
    "limit_floats",
    "motif_of",
    "plain",
    "satin",
    "satin_of_six",
    "summary",
    "summary_of_factors",
    "tapestry",
    "tie_up",
    "twill",
    "warp_compound",
    "weft_compound",
    "weft_faced",
]
