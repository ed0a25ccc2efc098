"""One frame: its time loop, the implicit scheme, how long a step may be and whether the frame is to be believed."""

from sim_core.cloth.step.air import Air
from sim_core.cloth.step.engine import MOST_PINNED, Engine, Stride
from sim_core.cloth.step.factor import Factored
from sim_core.cloth.step.frame import FRAME, Contact, Frame, Phase, State, schedule
from sim_core.cloth.step.precision import Pace
from sim_core.cloth.step.stability import first_mode, stiffness_times, tensions_at

__all__ = [
    "Air",
    "Contact",
    "Engine",
    "FRAME",
    "Factored",
    "Frame",
    "MOST_PINNED",
    "Pace",
    "Phase",
    "State",
    "Stride",
    "first_mode",
    "schedule",
    "stiffness_times",
    "tensions_at",
]
