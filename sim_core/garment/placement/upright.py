"""Panels that stand upright before and behind the body from a landmark down: trousers, and what else is sewn about the
legs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.garment.pattern import Cloth, Pattern
from sim_core.garment.placement.ground import Ground

__all__ = ["Upright"]


@dataclass(frozen=True)
class Upright:
    """Two sheets, y = 0 of the pattern at the top of both: y > 0 before the body, y < 0 behind it.

    mark: landmark at whose height the top lies; rise [m] above it; front, back [m]: of the sheets before and behind
    the middle.
    """

    mark: str = "waist"
    rise: float = 0.0
    front: float = 0.17
    back: float = 0.13

    halves = False  # `start` takes the whole of a mirrored pattern

    def hanging(self, cloth: Cloth) -> float:
        """The longest free length [m]."""
        return float(np.abs(cloth.vertices[:, 1]).max())

    def start(self, pattern: Pattern, cloth: Cloth, ground: Ground, rng: np.random.Generator) -> np.ndarray:
        """Positions (P, 3) [m] of the pattern vertices. Raises SimCoreError where a panel lies on both sides of y = 0
        or the cloth reaches the floor."""
        y = cloth.vertices[:, 1]
        behind = np.zeros(len(y), bool)
        for number in np.unique(cloth.panel_of):
            own = cloth.panel_of == number
            low, high = float(y[own].min()), float(y[own].max())
            if low < -1e-6 and high > 1e-6:
                name = pattern.panels[number % len(pattern.panels)].name
                raise SimCoreError(
                    f"pattern {pattern.name}: panel {name!r} reaches from y = {low:.3f} to {high:.3f} m – standing "
                    "upright it is before the body (y > 0) or behind it (y < 0): cut it in two"
                )
            behind[own] = low < -1e-6
        top = ground.top(self.mark, self.rise, self.hanging(cloth), pattern.name)
        return np.stack(
            [cloth.vertices[:, 0], top - np.abs(y), np.where(behind, -self.back, self.front)], axis=1
        )
