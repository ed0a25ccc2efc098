"""In which order a convolution reads the neighbourhood of a vertex, and the one that weighs channel by channel."""

from sim_core.learn.convolution.depthwise import FREE_ORDER, depthwise, depthwise_gradients
from sim_core.learn.convolution.spirals import STORAGE, check_storage, spirals

__all__ = ["FREE_ORDER", "STORAGE", "check_storage", "depthwise", "depthwise_gradients", "spirals"]
