"""How figures move: poses keyed one after the other, loops with feet on the floor, and figures from others' motion."""

from sim_core.body.motion.curves import Curve, minimum_jerk
from sim_core.body.motion.file import load_motion
from sim_core.body.motion.keys import RATE, Motion, eased
from sim_core.body.motion.loop import Key, Loop
from sim_core.body.motion.measure import Clearances, Ground, Seam, clearances, ground, seam
from sim_core.body.motion.retarget import Retargeted, figure_from
from sim_core.body.motion.steps import Steps

__all__ = [
    "RATE",
    "Clearances",
    "Curve",
    "Ground",
    "Key",
    "Loop",
    "Motion",
    "Retargeted",
    "Seam",
    "Steps",
    "clearances",
    "eased",
    "figure_from",
    "ground",
    "load_motion",
    "minimum_jerk",
    "seam",
]
