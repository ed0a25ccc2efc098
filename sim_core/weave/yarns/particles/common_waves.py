"""Waves in which warp and weft move up and down together, moved at once.

Where warp and weft touch, a step must be as short as the contact is stiff. What moves both together does not feel the
contact: the cloth as a whole waves as softly as its yarns bend, and would take thousands of such steps. So now and then
the net forces are gathered at the crossings, along the splines of stage A, divided by the beams' stiffness of both
systems, which is diagonal in the waves' phases, and the heights moved by what comes out. Contacts that lie aslant feel
such a wave a little; a floor under the stiffness keeps the move small there, and leaves the longest waves, whose forces
are far below any residual, alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, irfft2, rfft, rfft2

from sim_core.weave.yarns.beams import beam_stiffness
from sim_core.weave.yarns.particles.scale import Units
from sim_core.weave.yarns.splines import resampled

__all__ = ["CommonWaves", "gathered"]

SHARE = 0.8  # of the move that would undo the forces of beams
FLOOR = 0.01  # x stiffness of the contact


@dataclass(frozen=True, eq=False)
class CommonWaves:
    """Stiffness (picks, ends // 2 + 1) of the waves' modes, per particles between crossings."""

    stiffness: np.ndarray
    per: int

    @classmethod
    def of(cls, crossings: tuple[int, int], per: int, units: Units, contact: float) -> CommonWaves:
        """crossings: (picks, ends).  contact: stiffness of the contact, in `units`."""
        picks, ends = crossings
        warp, weft = (
            beam_stiffness(count, system.piece * per, system.bend, system.pull)
            for count, system in ((picks, units.warp), (ends, units.weft))
        )
        return cls(warp[:, None] + weft[None, : ends // 2 + 1] + FLOOR * contact, per)

    def move(
        self, warp: np.ndarray, weft: np.ndarray, warp_force: np.ndarray, weft_force: np.ndarray
    ) -> None:
        """Add the waves that answer the forces to the heights warp (ends, picks * per), weft (picks, ends * per)."""
        force = gathered(warp_force, self.per).T + gathered(weft_force, self.per)
        wave = SHARE * np.asarray(irfft2(np.asarray(rfft2(force)) / self.stiffness, force.shape))
        warp += resampled(wave.T, self.per)
        weft += resampled(wave, self.per)


def gathered(force: np.ndarray, per: int) -> np.ndarray:
    """(lines, crossings * per) forces -> (lines, crossings): what they do to the crossings of `resampled` curves."""
    count = force.shape[1] // per
    theta = 2 * np.pi * np.arange(count // 2 + 1)[:, None] / count
    t = np.arange(per) / per
    slope, turn = 6j * np.sin(theta) / (4 + 2 * np.cos(theta)), np.exp(1j * theta)
    way = (
        (1 + 2 * t) * (1 - t) ** 2 + turn * t * t * (3 - 2 * t)
        + slope * (t * (1 - t) ** 2 - turn * t * t * (1 - t))
    )  # fmt: skip
    modes = np.asarray(rfft(force.reshape(len(force), count, per), axis=1))
    return np.asarray(irfft((modes * np.conj(way)).sum(axis=2), count, axis=1))
