"""Is a frame to be believed: finite, and no energy from nowhere."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.conditions import Conditions
from sim_core.cloth.step.kernels.diagnostics import height_energy
from sim_core.cloth.step.phases import FRAME


class Health:
    """Judges frames of a sheet in band order; the energy of the last state asked for is kept."""

    def __init__(
        self, sheet: Sheet, stored: Callable[[np.ndarray, np.ndarray], float], *, touches: bool
    ) -> None:
        """stored(x, v) [J] of arrays (3, V); touches: something may lift the cloth."""
        self.sheet, self._stored, self.touches = sheet, stored, touches
        self.mass = float(sheet.mass.sum())
        self.forget()

    def forget(self) -> None:
        """To be called when a state has been changed in place."""
        self._known = np.zeros((3, 0)), 0.0  # positions whose energy is known

    def energy(self, x: np.ndarray, v: np.ndarray, gravity: np.ndarray) -> tuple[float, float]:
        """Stored and kinetic energy, and that of height [J], of x, v (3, V)."""
        known, stored = self._known
        if known is not x:  # a frame begins where the last one ended
            stored = self._stored(x, v)
            self._known = x, stored
        return stored, float(height_energy(self.sheet.mass, gravity, x))

    def good(
        self, under: Conditions, before: tuple[np.ndarray, np.ndarray], after: tuple[np.ndarray, np.ndarray]
    ) -> bool:
        """Finite, and no more energy than before: by 1 mm of the whole cloth's height, by 20 where contact lifts it.

        Where something does work on the cloth, no edge may become three times its length instead.
        """
        if not under.quiet:
            if not all(np.isfinite(a).all() for a in after):
                return False
            return self.whole(before[0], after[0]) and self._likely(under, before[1], after[1])
        (stored, height), (stored_after, height_after) = (
            self.energy(*state, under.gravity) for state in (before, after)
        )
        weight = self.mass * max(float(np.linalg.norm(under.gravity)), 1.0)
        allowed = (0.02 if self.touches else 0.001) * weight
        finite = np.isfinite(stored_after + height_after)  # sums over everything: what is not finite shows
        return bool(finite and stored_after <= 1.5 * stored + max(height - height_after, 0.0) + allowed)

    def whole(self, before: np.ndarray, after: np.ndarray) -> bool:
        """Finite, and no edge is three times its length, nor three times what it was, if that was longer."""
        if not np.isfinite(after).all():
            return False
        ends, rest2 = self.sheet.stencil.edges, self.sheet.stencil.length2
        longer = ((after[:, ends[:, 0]] - after[:, ends[:, 1]]) ** 2).sum(0) / rest2
        earlier = ((before[:, ends[:, 0]] - before[:, ends[:, 1]]) ** 2).sum(0) / rest2
        return bool((longer < 9.0 * np.maximum(1.0, earlier)).all())

    def _likely(self, under: Conditions, before: np.ndarray, after: np.ndarray) -> bool:
        """No vertex is ten times as fast as anything that could have made it so."""
        if len(under.pulls[0]):
            return True

        def fastest(v: np.ndarray) -> float:
            return float(np.sqrt((v * v).sum(0).max()))

        wind = 0.0 if under.wind is None else fastest(under.wind.T)
        fall = float(np.linalg.norm(under.gravity)) * FRAME
        return fastest(after) <= 10 * (fastest(before) + wind + fall + 1.0)
