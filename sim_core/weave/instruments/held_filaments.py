"""How a yarn of filaments bends in a cloth: freely between crossings, as one where it is pressed, until they slide.

Between crossings nothing presses the filaments of an untwisted yarn together: each bends about its own axis. Under a
crossing yarn they are held by friction and bend as one flattened section, until the shear between their layers exceeds
it. The two stretches lie in series. Over a pressed length under the force V at most mu V / 2 passes from layer to layer
on the way to its middle, half of that in the mean; summed over the height h of the section, the moment that friction
holds is M0 = mu V h / 4 (the frictional couple of Grosberg's model of bending, here from the cell's own forces).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isclose, pi, sqrt

import numpy as np

from sim_core.weave.instruments.hysteresis import Sliding
from sim_core.weave.model import Weave
from sim_core.weave.yarn import Yarn
from sim_core.weave.yarns.geometry import YarnGeometry

__all__ = [
    "FILAMENT_FRICTION",
    "Assumed",
    "HeldYarn",
    "held_yarns",
    "loaded_force",
    "pressed_length",
    "with_held",
]

FILAMENT_FRICTION = 0.25  # between silk filaments and between silk yarns, assumption
LOADED = 1e-3  # of the largest crossing force: crossings inside a float bear less


@dataclass(frozen=True)
class Assumed:
    """What the model does not settle.

    kept: share of its crimp that finishing set in a yarn.  wide: how far a crossing yarn presses, from the flat part of
    its section (0) to all of it (1).  modulus, filament: of the fibre, as times what the weave file says.
    """

    kept: float = 0.9
    wide: float = 0.5
    modulus: float = 1.0
    filament: float = 1.0


@dataclass(frozen=True)
class HeldYarn:
    """free, held: EI [N m2] between crossings and where pressed.  share: of the length that is pressed.
    height: of the section [m]."""

    free: float
    held: float
    share: float
    height: float

    @property
    def stiffness(self) -> float:
        """EI [N m2] while nothing slides."""
        return 1 / ((1 - self.share) / self.free + self.share / self.held)

    def moment(self, force: float) -> float:
        """M0 [N m] that friction holds where `force` [N] presses."""
        return FILAMENT_FRICTION * force * self.height / 4

    def bending(self, force: float) -> Sliding:
        """Moment of one yarn [N m] against curvature [1/m]."""
        if self.share == 0 or self.held <= self.free * (1 + 1e-9):
            return Sliding(self.stiffness, self.stiffness, 1.0)
        return Sliding(self.stiffness, self.free, self.moment(force) * self.held / (self.held - self.free))


def pressed_length(yarn: Yarn, wide: float) -> float:
    """How far [m] a yarn presses on one that crosses it. wide: as of `Assumed`."""
    return yarn.width - (1 - wide) * yarn.height


def held_yarns(weave: Weave, rest: YarnGeometry, assumed: Assumed) -> tuple[HeldYarn, HeldYarn]:
    """Warp and weft as they bend in this cloth. A stiffness that the weave file states is that of all their length."""
    loaded = float((rest.force > LOADED * rest.force.max()).mean())
    found = []
    for yarn, other, spacing in (
        (weave.warp, weave.weft, weave.pick_spacing),
        (weave.weft, weave.warp, weave.end_spacing),
    ):
        share = loaded * min(1.0, pressed_length(other, assumed.wide) / spacing)
        derived = isclose(yarn.stiffness, sqrt(yarn.stiffness_free * yarn.stiffness_stuck), rel_tol=1e-9)
        free = assumed.modulus * (yarn.stiffness_free * assumed.filament**2 if derived else yarn.stiffness)
        held = max(free, assumed.modulus * yarn.axial * _radius(yarn) ** 2) if derived else free
        found.append(HeldYarn(free, held, share, yarn.height))
    return found[0], found[1]


def with_held(weave: Weave, yarns: tuple[HeldYarn, HeldYarn], assumed: Assumed) -> Weave:
    """The weave, its yarns as stiff as they bend while nothing slides."""
    warp, weft = (
        replace(yarn, stiffness=held.stiffness, modulus=assumed.modulus * yarn.modulus)
        for yarn, held in zip((weave.warp, weave.weft), yarns, strict=True)
    )
    return replace(weave, warp=warp, weft=weft)


def _radius(yarn: Yarn) -> float:
    """Radius of gyration [m] of the racetrack section about its long axis, filaments spread over all of it."""
    height, flat = yarn.height, yarn.width - yarn.height
    second = flat * height**3 / 12 + pi * height**4 / 64
    return sqrt(second / (flat * height + pi * height**2 / 4))


def loaded_force(force: np.ndarray) -> float:
    """Mean [N] over the crossings that bear."""
    most = float(force.max())
    return float(force[force > LOADED * most].mean()) if most > 0 else 0.0
