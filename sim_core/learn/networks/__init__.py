"""Networks to be trained, with torch, which whoever imports this package has to have (the extra `learn`)."""

from sim_core.learn.networks.compiled import Compiled
from sim_core.learn.networks.gathered import Gathered
from sim_core.learn.networks.learned_steps import Glued, LearnedSteps
from sim_core.learn.networks.moment import Moment
from sim_core.learn.networks.sheets import Sheets
from sim_core.learn.networks.training import Schedule, train

__all__ = ["Compiled", "Gathered", "Glued", "LearnedSteps", "Moment", "Schedule", "Sheets", "train"]
