"""Units of stage B: the repeat in units of D, the mean height of warp and weft, and of EI/D^2; crimp of its curves."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt
from typing import NamedTuple

import numpy as np

from sim_core.weave.model import Weave
from sim_core.weave.yarn import Yarn

__all__ = ["Scale", "System", "Units", "crimp_of"]

SLIP = 0.01  # of D, elastic slip of a crossing that sticks


class System(NamedTuple):
    """Warp or weft in units of D and EI/D^2.

    piece: between neighbouring particles, along the yarn.  bend, pull: stiffness and tension.  wide: half width of the
    norm of contact round the yarn, across it.  reach: particles on both sides of a crossing that can touch the other
    system.  spacing: between neighbouring yarns; side, high: width and height of their sections where they touch each
    other, side 0 where they cannot.
    """

    piece: float
    bend: float
    pull: float
    wide: float
    reach: int
    spacing: float
    side: float
    high: float


class Units(NamedTuple):
    """Both systems, Coulomb's mu between them, and the elastic slip [D] of a crossing that sticks."""

    warp: System
    weft: System
    friction: float
    slip: float = SLIP


@dataclass(frozen=True)
class Scale:
    """A weave in the units of stage B. length: [m] of D.  force: [N] of EI/D^2.  per: particles a crossing and yarn."""

    length: float
    force: float
    per: int
    units: Units

    @classmethod
    def of(cls, weave: Weave, per: int, friction: float) -> Scale:
        warp, weft = weave.warp, weave.weft
        length = (warp.height + weft.height) / 2
        stiffness = sqrt(warp.stiffness * weft.stiffness)
        half = per * min(weave.draft.picks, weave.draft.ends) - 1
        widths = (warp.width + weft.height) / 2 / length, (weft.width + warp.height) / 2 / length
        spacings = weave.end_spacing / length, weave.pick_spacing / length

        def system(yarn: Yarn, own: int) -> System:
            other = 1 - own
            piece, room, wide = spacings[other] / per, spacings[own], yarn.width / length
            reach = min(ceil(widths[other] / piece), per - 1, half)
            # a section is never wider than its room: packed fibres give way sideways
            side = min(wide, room) if room < 1.7 * wide else 0.0
            bend, pull = yarn.stiffness / stiffness, yarn.tension / (stiffness / length**2)
            return System(piece, bend, pull, widths[own], reach, room, side, yarn.height / length)

        return cls(
            length, stiffness / length**2, per, Units(system(warp, 0), system(weft, 1), float(friction))
        )


def crimp_of(u: np.ndarray, z: np.ndarray, piece: float) -> np.ndarray:
    """Excess arc length of each yarn: of the Catmull-Rom curves that are in contact, by Gauss's rule in each piece."""
    speed = np.zeros_like(u)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    for f, weight in zip((nodes + 1) / 2, weights / 2, strict=True):
        square = np.full_like(u, piece**2)
        for p in (u, z):
            before, after, next_ = np.roll(p, 1, axis=1), np.roll(p, -1, axis=1), np.roll(p, -2, axis=1)
            rise = (
                6 * f * (1 - f) * (after - p)
                + (1 - f) * (1 - 3 * f) * (after - before) / 2
                + f * (3 * f - 2) * (next_ - p) / 2
            )
            square += rise**2
        speed += weight * np.sqrt(square)
    return speed.mean(axis=1) / piece - 1
