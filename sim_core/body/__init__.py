"""Who wears a garment: a figure with joints and weights, its poses, and the moving solid that cloth meets."""

from sim_core.body.beneath import HANDS, Beneath, Surface
from sim_core.body.cover import Cover, Petticoat, covered
from sim_core.body.joints import JOINTS, OTHER_SIDE, PARENTS
from sim_core.body.limits import LIMITS
from sim_core.body.mannequin import Mannequin
from sim_core.body.motion import Loop, Motion, load_motion
from sim_core.body.pose import POSES, Pose, pose_named
from sim_core.body.skeleton import Skeleton
from sim_core.body.skinning import LINEAR_JOINTS, SKINS, dual_quaternion_skin, linear_skin
from sim_core.body.stand import Stand, TBar, stand_of
from sim_core.body.wearer import Figure

__all__ = [
    "HANDS",
    "Beneath",
    "Cover",
    "Figure",
    "JOINTS",
    "LIMITS",
    "LINEAR_JOINTS",
    "Loop",
    "Mannequin",
    "Motion",
    "OTHER_SIDE",
    "PARENTS",
    "POSES",
    "Petticoat",
    "Pose",
    "SKINS",
    "Skeleton",
    "Stand",
    "Surface",
    "TBar",
    "covered",
    "dual_quaternion_skin",
    "linear_skin",
    "load_motion",
    "pose_named",
    "stand_of",
]
