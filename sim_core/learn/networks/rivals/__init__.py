"""Networks to compare with, each of which mends the base frame by frame: spirals on the fine mesh, and images."""

from sim_core.learn.networks.rivals.image_net import ImageNet
from sim_core.learn.networks.rivals.sheet import Frames, RivalSheet
from sim_core.learn.networks.rivals.spiral_net import SpiralNet
from sim_core.learn.networks.rivals.training import RivalSchedule, made_of, network_of, train_rival

__all__ = [
    "Frames",
    "ImageNet",
    "RivalSchedule",
    "RivalSheet",
    "SpiralNet",
    "made_of",
    "network_of",
    "train_rival",
]
