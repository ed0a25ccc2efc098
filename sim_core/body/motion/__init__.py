"""How figures move: poses keyed one after the other, and motions that loop, feet on the floor."""

from sim_core.body.motion.curves import Curve, minimum_jerk
from sim_core.body.motion.file import load_motion
from sim_core.body.motion.keys import RATE, Motion, eased
from sim_core.body.motion.loop import Key, Loop
from sim_core.body.motion.steps import Steps

__all__ = ["RATE", "Curve", "Key", "Loop", "Motion", "Steps", "eased", "load_motion", "minimum_jerk"]
