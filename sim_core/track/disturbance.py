"""What a sensor does to joints that are known: noise, joints that are not seen, outliers; from a seed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.validation import finite, integer

__all__ = ["Disturbance"]


@dataclass(frozen=True)
class Disturbance:
    """noise [m] an axis (normal); dropout: the share of joints that are not seen; outliers: the share that is measured
    `reach` [m] away in any direction; seed."""

    noise: float = 0.0
    dropout: float = 0.0
    outliers: float = 0.0
    reach: float = 0.3
    seed: int = 0

    def __post_init__(self) -> None:
        """Raises SimCoreError naming the value and its bounds."""
        for name, most in (("noise", 10.0), ("dropout", 1.0), ("outliers", 1.0), ("reach", 100.0)):
            finite(name, getattr(self, name), least=0.0, most=most)
        integer("seed", self.seed, 0, "give a whole number of 0 or more", 2**63 - 1)

    def of(self, joints: np.ndarray) -> np.ndarray:
        """Joints (T, J, 3) [m] as such a sensor would give them, NaN where one is not seen."""
        random = np.random.default_rng(self.seed)
        out = joints + self.noise * random.standard_normal(joints.shape)
        away = random.standard_normal(joints.shape)
        away *= self.reach / np.linalg.norm(away, axis=-1, keepdims=True)
        struck = random.random(joints.shape[:-1]) < self.outliers
        out[struck] += away[struck]
        out[random.random(joints.shape[:-1]) < self.dropout] = np.nan
        return out
