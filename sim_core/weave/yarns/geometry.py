"""The values that come out of the weave room: yarn geometry, yarn paths and cloth parameters."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from sim_core.weave.yarn import Yarn

__all__ = ["FiguredGeometry", "Strands", "YarnGeometry"]


@dataclass(frozen=True, eq=False)
class YarnGeometry:
    """Heights of the yarn axes at the crossings of one repeat, in force balance and periodic.

    warp_height, weft_height: (picks, ends) float64 [m] above the middle plane.
    force: (picks, ends) float64 [N] with which the two yarns press on each other, >= 0.
    warp_crimp: (ends,), weft_crimp: (picks,): excess length of the yarn over its straight distance (small slope).
    residual: largest net vertical force on a crossing / largest crossing force.
    penetration: largest overlap [m] of two yarns at a crossing; complementarity: largest force x gap / (V D).
    """

    warp_height: np.ndarray
    weft_height: np.ndarray
    force: np.ndarray
    warp_crimp: np.ndarray
    weft_crimp: np.ndarray
    residual: float
    penetration: float
    complementarity: float
    iterations: int

    def crest_to_trough(self) -> tuple[float, float]:
        """h1 of the warp and h2 of the weft [m]: the largest crest-to-trough distance of any yarn."""
        return float(np.ptp(self.warp_height, axis=0).max()), float(np.ptp(self.weft_height, axis=1).max())


@dataclass(frozen=True, eq=False)
class Strands:
    """All yarns of one kind in one repeat, as graphs along the warp (up the cloth) or along the weft (to the right).

    along: "warp" or "weft".  place: (yarns,) [m] where each lies across.  side, height: (yarns, n) [m] sideways from
    there and above the middle plane, n places a repeat length apart by length / n, the first at crossing 0.
    colour: (yarns, n) int, index into palette, -1 where the yarn is not there.  palette: (colours, 3) sRGB.
    yarn: its size.  length, across: [m] of the repeat along the yarns and across them.
    half_width, half_height: (yarns, n) [m] of the section, across the yarn in the plane of the cloth and upright.
    """

    along: str
    place: np.ndarray
    side: np.ndarray
    height: np.ndarray
    colour: np.ndarray
    palette: np.ndarray
    yarn: Yarn
    length: float
    across: float
    half_width: np.ndarray
    half_height: np.ndarray

    def points(self, number: int) -> np.ndarray:
        """(n, 3) [m] axis of one yarn over the repeat: x to the right, y up the cloth, z towards the eye."""
        n = self.side.shape[1]
        along = np.arange(n) * self.length / n
        across = self.place[number] + self.side[number]
        first, second = (across, along) if self.along == "warp" else (along, across)
        return np.column_stack([first, second, self.height[number]])


@dataclass(frozen=True, eq=False)
class FiguredGeometry:
    """Yarns of a figured weave at rest, cell by cell. cells: YarnGeometry or ParticleCell of each of `Weave.cells`;
    shares: of the cloth's area that each makes up, 1 together."""

    cells: tuple[Any, ...]
    shares: tuple[float, ...]
