"""Lines of sight to points on lamps: what they bring arrives where nothing is in the way."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hall_app.light.rays.embree import Tree, blocked

__all__ = ["Sights", "room_for_sights", "see"]


class Sights(NamedTuple):
    """R lines: origin (R, 3) [m], unit way (R, 3), limit (R,) [m]; row (R,) they bring light (R, 3) to."""

    origin: NDArray[np.float32]
    way: NDArray[np.float32]
    limit: NDArray[np.float32]
    row: NDArray[np.int32]
    light: NDArray[np.float32]


def room_for_sights(count: int) -> Sights:
    origin, way, light = (np.zeros((count, 3), np.float32) for _ in range(3))
    return Sights(origin, way, np.zeros(count, np.float32), np.zeros(count, np.int32), light)


@njit(cache=True, error_model="numpy", nogil=True)
def _add(hidden, row, light, out):
    for a in range(len(hidden)):
        if not hidden[a]:
            for c in range(3):
                out[row[a], c] += light[a, c]


def see(tree: Tree, sights: Sights, count: int, out: NDArray[np.float32]) -> None:
    """Add what the first `count` lines bring to the rows of out (N, 3), one after the other."""
    s = Sights._make(array[:count] for array in sights)
    _add(blocked(tree, s.origin, s.way, s.limit), s.row, s.light, out)
