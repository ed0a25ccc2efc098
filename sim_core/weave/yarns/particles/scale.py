"""Units of stage B: the repeat in units of D, the mean height of warp and weft, and of EI/D^2; crimp of its curves."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np

from sim_core.weave.model import Weave

__all__ = ["Scale", "crimp_of"]

SLIP = 0.01  # of D, elastic slip of a crossing that sticks


@dataclass(frozen=True)
class Scale:
    """The repeat in units of D and EI/D^2."""

    weave: Weave
    length: float
    force: float
    stiffness: float
    spacing: tuple[float, float]  # ends, picks
    piece: tuple[float, float]
    wide: tuple[float, float]  # contact norm along the weft, along the warp
    reach: tuple[int, int]

    @classmethod
    def of(cls, weave: Weave, per: int) -> Scale:
        warp, weft = weave.warp, weave.weft
        length = (warp.height + weft.height) / 2
        stiffness = sqrt(warp.stiffness * weft.stiffness)
        p1, p2 = weave.end_spacing / length, weave.pick_spacing / length
        wide = (warp.width + weft.height) / 2 / length, (weft.width + warp.height) / 2 / length
        piece = p2 / per, p1 / per
        half = per * min(weave.draft.picks, weave.draft.ends) - 1
        reach = tuple(min(ceil(w / p), per - 1, half) for w, p in ((wide[1], piece[0]), (wide[0], piece[1])))
        return cls(weave, length, stiffness / length**2, stiffness, (p1, p2), piece, wide, reach)  # type: ignore[arg-type]

    def numbers(self, friction: float) -> tuple[float, ...]:
        warp, weft = self.weave.warp, self.weave.weft
        sides = []
        for yarn, room in ((warp, self.spacing[0]), (weft, self.spacing[1])):
            wide = yarn.width / self.length
            # a section is never wider than its room: packed fibres give way sideways
            sides += [min(wide, room) if room < 1.7 * wide else 0.0, yarn.height / self.length]
        return (
            *self.piece, warp.stiffness / self.stiffness, weft.stiffness / self.stiffness, warp.tension / self.force,
            weft.tension / self.force, *self.wide, float(self.reach[0]), float(self.reach[1]), *self.spacing, *sides,
            friction, SLIP,
        )  # fmt: skip


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
