"""In which order a convolution reads the neighbourhood of a vertex."""

from sim_core.learn.convolution.spirals import STORAGE, check_storage, spirals

__all__ = ["STORAGE", "check_storage", "spirals"]
