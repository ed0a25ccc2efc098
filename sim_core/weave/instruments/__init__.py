"""A laboratory for cloth: the tests of Kawabata's evaluation system, done on relaxed cells.

`specimen` tests one cell under one set of assumptions, `laboratory` all that are varied; `set_beams` is the cell under
load, `held_filaments` how its yarns bend, `hysteresis` the loop of what slides, `readings` the units.
"""

from sim_core.weave.instruments.held_filaments import Assumed
from sim_core.weave.instruments.hysteresis import Sliding
from sim_core.weave.instruments.laboratory import Laboratory
from sim_core.weave.instruments.readings import Reading, mean_reading
from sim_core.weave.instruments.set_beams import Load, SetBeams
from sim_core.weave.instruments.specimen import Specimen

__all__ = ["Assumed", "Laboratory", "Load", "Reading", "SetBeams", "Sliding", "Specimen", "mean_reading"]
