"""One frame: its time loop, the implicit scheme, how long a step may be and whether the frame is to be believed."""

from sim_core.cloth.step.air import Air
from sim_core.cloth.step.conditions import Conditions
from sim_core.cloth.step.engine import MOST_PINNED, Engine
from sim_core.cloth.step.factor import Factored
from sim_core.cloth.step.implicit import Load
from sim_core.cloth.step.phases import FRAME, Contact, Phase, schedule
from sim_core.cloth.step.precision import Pace
from sim_core.cloth.step.stability import first_mode, stiffness_times, tensions_at

__all__ = [
    "Air",
    "Conditions",
    "Contact",
    "Engine",
    "FRAME",
    "Factored",
    "Load",
    "MOST_PINNED",
    "Pace",
    "Phase",
    "first_mode",
    "schedule",
    "stiffness_times",
    "tensions_at",
]
