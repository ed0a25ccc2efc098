"""Networks at work, without torch: what a sheet brings along, weights, and a follower of its frames."""

from sim_core.learn.inference.follower import Follower
from sim_core.learn.inference.ground import Ground
from sim_core.learn.inference.settings import Settings, Shapes

__all__ = ["Follower", "Ground", "Settings", "Shapes"]
