"""A fine cloth that follows a coarse one softly: its mean about every coarse vertex is drawn to the coarse surface's.

Only what the coarse mesh can say is led (Bergou, Mathur, Wardetzky and Grinspun 2007: TRACKS); of wrinkles finer than
its edges, speeds against the coarse surface die away, so that they depend less on how they once began.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, diags_array

from sim_core.cloth.run import ENGINE_VERSION
from sim_core.cloth.step.frame import FRAME

__all__ = ["MADE_BY", "SLOW", "Lead", "between"]

SLOW = 16  # times as slow as it is the fine cloth is simulated: forces change as often in a frame
# Forces that stand still for a sixteenth of a frame come late, and swing up what turns within it: the sheet's own waves
# as long as a coarse edge. With 1.6 instead of .6, or 60 instead of 8, two time steps end 4 mm apart, with these .02.
DRAWN = 0.04  # of what the mean is away, that is drawn in a sixteenth of a frame
DAMPED = 0.6  # of the critical two
CALM = 8.0  # [1/s] at which speeds against the coarse surface die away
MADE_BY = {"engine": ENGINE_VERSION, "slow": SLOW, "drawn": DRAWN, "damped": DAMPED, "calm": CALM}


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

    def forces(
        self, positions: np.ndarray, velocities: np.ndarray, before: np.ndarray, there: np.ndarray
    ) -> np.ndarray:
        """Forces (V, 3) [N] of the slowed cloth in one of its frames, in which the coarse surface goes from `before` to
        `there` (C, 3) [m]."""
        off = self.away(positions, before)
        faster = velocities - self.spread @ ((there - before) / FRAME)
        drawn = -(DRAWN * off / FRAME + DAMPED * np.sqrt(DRAWN) * (self.mean @ faster)) / FRAME
        return self.mass[:, None] * (self.spread @ drawn - CALM / SLOW * faster)


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
