"""Is a frame to be believed: finite, and no energy from nowhere."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.frame import FRAME, Frame, State
from sim_core.cloth.step.kernels.diagnostics import height_energy


class Health:
    """Judges frames of a sheet in band order; the energy of the last state asked for is kept."""

    def __init__(self, sheet: Sheet, stored: Callable[[State], float], *, touches: bool) -> None:
        """stored(state) [J]; touches: something may lift the cloth."""
        self.sheet, self._stored, self.touches = sheet, stored, touches
        self.mass = float(sheet.mass.sum())
        self.forget()

    def forget(self) -> None:
        """To be called when a state has been changed in place."""
        self._known = np.zeros((3, 0)), 0.0  # positions whose energy is known

    def energy(self, state: State, gravity: np.ndarray) -> tuple[float, float]:
        """Stored and kinetic energy, and that of height [J]."""
        known, stored = self._known
        if known is not state.x:  # a frame begins where the last one ended
            stored = self._stored(state)
            self._known = state.x, stored
        return stored, float(height_energy(self.sheet.mass, gravity, state.x))

    def good(self, frame: Frame, before: State, after: State) -> bool:
        """Finite, and no more energy than before: by 1 mm of the whole cloth's height, by 20 where contact lifts it.

        Where something does work on the cloth, no edge may become three times its length instead.
        """
        if not frame.quiet:
            if not all(np.isfinite(a).all() for a in after):
                return False
            return self.whole(before.x, after.x) and self._likely(frame, before.v, after.v)
        (stored, height), (stored_after, height_after) = (
            self.energy(state, frame.gravity) for state in (before, after)
        )
        weight = self.mass * max(float(np.linalg.norm(frame.gravity)), 1.0)
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

    def _likely(self, frame: Frame, before: np.ndarray, after: np.ndarray) -> bool:
        """No vertex is ten times as fast as anything that could have made it so."""
        if len(frame.pulled):
            return True

        def fastest(v: np.ndarray) -> float:
            return float(np.sqrt((v * v).sum(0).max()))

        fall = float(np.linalg.norm(frame.gravity)) * FRAME
        return fastest(after) <= 10 * (fastest(before) + fastest(frame.wind.T) + fall + 1.0)
