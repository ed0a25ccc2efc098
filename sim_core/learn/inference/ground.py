"""Everything of a sequence's two sheets that a network stands on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.learn.data import Pair
from sim_core.learn.patches import Imbalance, Patches, Surroundings, limited

__all__ = ["FURTHEST_WAY", "UNIT", "Ground"]

UNIT = 0.25  # of a coarse edge: what displacements are told in
FURTHEST_WAY = 4.0  # units that a vertex is told to be out of balance by, at most


@dataclass(frozen=True)
class Ground:
    """The sheets, patches between them, what coarse vertices see, and what the fine sheet lacks to balance.

    unit [m]: of displacements from the base.
    """

    pair: Pair
    patches: Patches
    surroundings: Surroundings
    imbalance: Imbalance
    unit: float

    @staticmethod
    def of(pair: Pair) -> Ground:
        """That of a pair."""
        patches = Patches.of(pair.coarse.rest, pair.coarse.faces, pair.fine.rest, held=pair.kept)
        surroundings = Surroundings.of(pair.coarse.rest, pair.coarse.faces, pair.pins[0])
        return Ground(pair, patches, surroundings, Imbalance.of(pair), UNIT * patches.length)

    def lacking(
        self, fine: np.ndarray, coarse: np.ndarray, shared: np.ndarray, turn: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """`Imbalance.ways` as a network is told of them, in units: those of fine vertices (V, 3), the longer ones cut,
        and the means (C, 3) as their tangent frames turn (C, 3, 3) see them."""
        ways, means = self.imbalance.ways(fine, coarse, shared)
        return limited(ways / self.unit, FURTHEST_WAY), self.patches.turned(means / self.unit, turn)
