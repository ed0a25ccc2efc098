"""How a sheet lies in memory, in bands or in lanes, and the compiled passes over it."""

from sim_core.cloth.step.kernels.banded import band_air, band_bends, band_pulls, band_strains, band_tensions
from sim_core.cloth.step.kernels.bands import bands_of, ordered
from sim_core.cloth.step.kernels.laned import (
    lane_bends,
    lane_further,
    lane_leap,
    lane_odd_bends,
    lane_strains,
    lane_tensions,
)
from sim_core.cloth.step.kernels.lanes import SAME, lattice_lanes, plain_lanes

__all__ = [
    "SAME",
    "band_air",
    "band_bends",
    "band_pulls",
    "band_strains",
    "band_tensions",
    "bands_of",
    "lane_bends",
    "lane_further",
    "lane_leap",
    "lane_odd_bends",
    "lane_strains",
    "lane_tensions",
    "lattice_lanes",
    "ordered",
    "plain_lanes",
]
