"""A fine cloth that follows a coarse one softly: its mean about every coarse vertex is drawn to the coarse surface's.

Only what the coarse mesh can say is led (Bergou, Mathur, Wardetzky and Grinspun 2007: TRACKS). Wrinkles finer than its
edges are the cloth's own, and their speeds against the coarse surface die away within a tenth of a frame or so: a sheet
rings at 15 Hz and more, which 25 frames a second do not show, and what they do not show cannot be learned from them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, diags_array

from sim_core.cloth.run import ENGINE_VERSION
from sim_core.cloth.step.frame import FRAME

__all__ = ["MADE_BY", "SLOW", "STIFFNESS", "Lead", "between"]

SLOW = 16  # times as slow as it is the fine cloth is simulated: forces change as often in a frame
DRAWN = 1.0  # of what the mean is away, that is drawn in a sixteenth of a frame
# Speeds against the coarse surface are braked by the engine, in every substep, and only the coarse surface's own speed
# is given as a force: brakes that come a sixteenth of a frame late swing up the sheet's waves instead.
CALM = 300.0  # [1/s] at which they die away
STIFFNESS = DRAWN * (SLOW / FRAME) ** 2  # [1/s2] acceleration of the mean per metre that it is away
MADE_BY = {"engine": ENGINE_VERSION, "slow": SLOW, "drawn": DRAWN, "calm": CALM}


@dataclass(frozen=True)
class Lead:
    """spread (V, C): the coarse surface at the fine vertices, linear in between; mean (C, V): the mean, by mass, of
    fine vertices about each coarse one; mass (V,) [kg]."""

    spread: csr_array
    mean: csr_array
    mass: np.ndarray

    @staticmethod
    def of(spread: csr_array, mass: np.ndarray) -> Lead:
        """From weights (V, C) whose rows sum to one, and the fine sheet's mass (V,) [kg]."""
        weighed = csr_array(spread.T @ diags_array(mass))
        total = np.asarray(weighed.sum(axis=1)).ravel()
        return Lead(spread, csr_array(diags_array(1.0 / total) @ weighed), mass)

    def away(self, fine: np.ndarray, coarse: np.ndarray) -> np.ndarray:
        """How far (C, 3) the fine mean is from the coarse surface's, fine (V, 3), coarse (C, 3) [m]."""
        return self.mean @ (fine - self.spread @ coarse)

    def forces(self, positions: np.ndarray, before: np.ndarray, there: np.ndarray) -> np.ndarray:
        """Forces (V, 3) [N] of the slowed cloth, which is damped by CALM / SLOW, in one of its frames, in which the
        coarse surface goes from `before` to `there` (C, 3) [m]."""
        drawn = -DRAWN / FRAME**2 * self.away(positions, before)
        speed = (there - before) / FRAME
        return self.mass[:, None] * (self.spread @ (drawn + CALM / SLOW * speed))


def between(film: np.ndarray) -> Iterator[np.ndarray]:
    """Places (C, 3) of a film (T + 1, C, 3) at every sixteenth of its T frames, its begin first, where it is at rest:
    by cubics through its frames (Catmull and Rom 1974)."""
    yield film[0]
    padded = np.concatenate([film[1:2], film, 2 * film[-1:] - film[-2:-1]])
    for a, b, c, d in zip(padded, padded[1:], padded[2:], padded[3:], strict=False):
        for k in range(1, SLOW + 1):
            s = k / SLOW
            bend, twist = 2 * a - 5 * b + 4 * c - d, 3 * b - a - 3 * c + d
            yield 0.5 * (2 * b + (c - a) * s + bend * s**2 + twist * s**3)
