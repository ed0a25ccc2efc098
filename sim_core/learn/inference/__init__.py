"""Networks at work, without torch: what a sheet brings along, weights, and a follower of its frames."""

from sim_core.learn.inference.follower import Follower
from sim_core.learn.inference.ground import Ground
from sim_core.learn.inference.settings import PATCH, RIVALS, Rival, Settings, Shapes
from sim_core.learn.inference.weights import RivalTrained, Trained, read_weights, write_weights

__all__ = [
    "PATCH",
    "RIVALS",
    "Follower",
    "Ground",
    "Rival",
    "RivalTrained",
    "Settings",
    "Shapes",
    "Trained",
    "read_weights",
    "write_weights",
]
