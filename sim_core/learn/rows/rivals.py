"""Networks to compare with, as rows; they run in torch, on one core as all rows do."""

# pyright: reportMissingImports=false
# (torch is an extra)

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.learn.data import Pair
from sim_core.learn.inference import RIVALS, Ground, RivalTrained, Trained
from sim_core.learn.pooling import Pooled
from sim_core.learn.rows.learned import Ours
from sim_core.learn.rows.row import Follow, Row
from sim_core.learn.upsampling import weighted_sums

__all__ = ["RivalRow", "row_of"]


@dataclass(frozen=True)
class RivalRow:
    """A network that mends the base frame by frame."""

    trained: RivalTrained

    @property
    def name(self) -> str:
        return self.trained.row

    def follow(self, pair: Pair) -> Follow:
        """Raises SimCoreError without torch, and for a kind of sheet that was not learned from, where one is pooled."""
        import torch

        from sim_core.learn.networks.rivals import RivalSheet, made_of, network_of

        torch.set_num_threads(1)
        rival, device = RIVALS[self.name], torch.device("cpu")
        network = network_of(rival)
        network.load_state_dict(
            {name: torch.from_numpy(np.array(value)) for name, value in self.trained.weights.items()}
        )
        ground = Ground.of(pair)
        sheet = RivalSheet(ground, device)
        tables = made_of(rival, sheet, self._pooled(pair) if rival.length else None)
        past: list[np.ndarray] = []

        def follow(coarse: np.ndarray) -> np.ndarray:
            base = weighted_sums(pair.base, coarse)
            past.insert(0, base)
            del past[3:]
            three = [past[0], past[min(1, len(past) - 1)], past[-1]]
            given = torch.from_numpy(np.stack(three).astype(np.float32))[None]
            with torch.inference_mode():
                return base + network(sheet.frames(given), sheet, tables)[0].numpy()

        return follow

    def _pooled(self, pair: Pair) -> Pooled:
        found = self.trained.pooled.get(pair.kind)
        if found is None:
            raise SimCoreError(
                f"{self.name} has learned from no sheet of this kind ({pair.kind}) – train it on one"
            )
        return found


def row_of(trained: Trained | RivalTrained) -> Row:
    """What follows by weights, whosever they are."""
    return Ours(trained) if isinstance(trained, Trained) else RivalRow(trained)
