"""Cloth folded flat over a bar: an arch about it, both ends hanging straight, without strain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.garment.pattern import Cloth, Pattern
from sim_core.garment.placement.ground import Ground

__all__ = ["Folded"]


@dataclass(frozen=True)
class Folded:
    """front [m]: of the cloth that hangs in front of the bar; x of the pattern lies along the bar, y goes over it.

    at [m]: where along the bar the cloth's middle lies, from the bar's, to the visitor's right: several lengths hang
    side by side.
    """

    front: float
    at: float = 0.0

    halves = False  # `start` takes the whole of a mirrored pattern

    def hanging(self, cloth: Cloth) -> float:
        """The longest free length [m]."""
        return max(self.front, float(np.ptp(cloth.vertices[:, 1])) - self.front)

    def start(self, pattern: Pattern, cloth: Cloth, ground: Ground, rng: np.random.Generator) -> np.ndarray:
        """Positions (P, 3) [m]; raises SimCoreError where the cloth does not fit the stand."""
        stand, points = ground.bar(), cloth.vertices
        low, high = points.min(0), points.max(0)
        width, length = (float(c) for c in high - low)
        radius = stand.bar_radius + ground.clearance + 0.001
        longest = max(self.front, length - self.front)
        if not 0.0 < self.front < length:
            raise SimCoreError(
                f"pattern {pattern.name}: {length:.2f} m long – front {self.front} m leaves none"
            )
        if longest > stand.height - 0.05:
            raise SimCoreError(
                f"pattern {pattern.name}: an end of {longest:.2f} m touches the floor – raise the stand's bar"
            )
        if width > stand.span - 0.02:
            raise SimCoreError(f"pattern {pattern.name}: {width:.2f} m wide – wider than the stand")
        beyond = abs(self.at) + 0.5 * (width - stand.span) + 0.01
        if beyond > 0:
            raise SimCoreError(
                f"pattern {pattern.name}: {width:.2f} m wide at {self.at} m reaches {beyond:.2f} m beyond a post – "
                "move it towards the middle or widen the stand's span"
            )
        along = self.front - (points[:, 1] - low[1])  # from the top of the bar, forwards
        angle = np.clip(along / radius, -np.pi / 2, np.pi / 2)
        hanging = np.maximum(np.abs(along) - radius * np.pi / 2, 0.0)
        x = self.at + 0.5 * (low[0] + high[0]) - points[:, 0]  # the face is turned to the visitor
        return np.stack([x, stand.height + radius * np.cos(angle) - hanging, radius * np.sin(angle)], axis=1)
