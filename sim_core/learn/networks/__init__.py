"""Networks to be trained, with torch, which whoever imports this package has to have (the extra `learn`)."""

from sim_core.learn.networks.learned_steps import Glued, LearnedSteps, Moment
from sim_core.learn.networks.operators import Displaced, EdgeGap, Fitted, SpiralMix
from sim_core.learn.networks.training import Schedule, train

__all__ = [
    "Displaced",
    "EdgeGap",
    "Fitted",
    "Glued",
    "LearnedSteps",
    "Moment",
    "Schedule",
    "SpiralMix",
    "train",
]
