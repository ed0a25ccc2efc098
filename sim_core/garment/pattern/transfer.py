"""From one mesh of a pattern to another: what vertices of a coarse cloth have, given to those of a finer one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from sim_core.errors import SimCoreError
from sim_core.garment.pattern.cloth import Cloth

__all__ = ["Transfer"]

NEAR = 16  # faces, by their centres, among which the one is sought that a vertex lies on


@dataclass(frozen=True)
class Transfer:
    """corners (P, 3): the coarse pattern vertices of the face that each fine one lies on in its panel; shares (P, 3) of
    them, together 1. Beyond a curved edge, which coarse chords cut off, the nearest face goes on: a share is below 0.
    """

    corners: np.ndarray
    shares: np.ndarray

    @staticmethod
    def between(coarse: Cloth, fine: Cloth) -> Transfer:
        """Of two meshes of the same panels; raises SimCoreError for others."""
        if coarse.names != fine.names:
            raise SimCoreError(f"transfer: panels {coarse.names} and {fine.names} – mesh one pattern twice")
        corners = np.zeros((len(fine.vertices), 3), np.int32)
        shares = np.zeros((len(fine.vertices), 3))
        for number in range(len(coarse.names)):
            faces = coarse.faces[coarse.panel == number]
            own = np.flatnonzero(fine.panel_of == number)
            if not len(own):  # a panel that the other side has alone
                continue
            corner, point = coarse.vertices[faces], fine.vertices[own]
            _, near = KDTree(corner.mean(1)).query(point, k=min(NEAR, len(faces)))
            near = np.asarray(near).reshape(len(own), -1)
            found = _shares(corner[near], point[:, None])
            best = np.argmax(found.min(2), axis=1)  # inside: none below 0; outside: the one least beyond
            rows = np.arange(len(own))
            corners[own], shares[own] = faces[near[rows, best]], found[rows, best]
        return Transfer(corners, shares)

    def of(self, values: np.ndarray) -> np.ndarray:
        """Values (P, 3) of the fine vertices from those of the coarse ones, in their own precision."""
        return np.einsum("pk,pkc->pc", self.shares.astype(values.dtype), values[self.corners])


def _shares(corner: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Barycentric coordinates (..., 3) of points (..., 2) on faces (..., 3, 2)."""
    a, b = corner[..., 1, :] - corner[..., 0, :], corner[..., 2, :] - corner[..., 0, :]
    way = point - corner[..., 0, :]
    twice = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    second = (way[..., 0] * b[..., 1] - way[..., 1] * b[..., 0]) / twice
    third = (a[..., 0] * way[..., 1] - a[..., 1] * way[..., 0]) / twice
    return np.stack([1.0 - second - third, second, third], axis=-1)
