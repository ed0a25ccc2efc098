"""Solids packed as arrays for the compiled loops, and the numbers of their kinds."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

CAPSULE, CYLINDER, BOX, HALFSPACE, GRID, MOVING = range(6)
FASTEST = 4  # column of a moving grid: the most that its distance changes anywhere between the two keys [m]
NO_GRID = np.zeros((2, 2, 2), np.float32)
_AT_REST = np.zeros(2)
_NO_FACES, _NO_CORNERS = np.full((1, 1, 1), -1, np.int32), np.zeros((0, 3, 3))


class Fields(NamedTuple):
    """Of `Packed` what a distance is asked of: compiled calls hand every array on, and most calls ask no more."""

    kind: np.ndarray
    data: np.ndarray
    grid: np.ndarray
    later: np.ndarray
    blend: np.ndarray


class Packed(NamedTuple):
    """Solids as arrays: kind (P,), data (P, 20), and the nodes of at most one grid, float32.

    A moving grid lies between `grid` and `later`: blend (2,) is how far, 0..1, and how fast [1/s]. Where its surface is
    known, nearest (nx, ny, nz) is the face next to each node (-1: none), corners (F, 3, 3) [m] are those of the faces
    and ways (F, 3, 3) [m] where these go in between.
    """

    kind: np.ndarray
    data: np.ndarray
    grid: np.ndarray
    later: np.ndarray = NO_GRID
    blend: np.ndarray = _AT_REST
    nearest: np.ndarray = _NO_FACES
    corners: np.ndarray = _NO_CORNERS
    ways: np.ndarray = _NO_CORNERS
