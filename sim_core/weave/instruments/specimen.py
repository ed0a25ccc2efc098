"""A piece of cloth in the laboratory, tested as the instruments of Kawabata's evaluation system (KES) test it.

KES-FB1 pulls a strip held at full width to 500 gf/cm, and shears it by 8 degrees to and fro under 10 gf/cm along the
warp; KES-FB2 bends it to 2.5 /cm to and fro; KES-FB3 presses it between plates to 50 gf/cm2. Read are what its sheets
read: EMT, LT, WT, RT; G between .5 and 2.5 degrees, 2HG at .5, 2HG5 at 5; B between .5 and 1.5 /cm, 2HB at 1; thickness
T0 under .5 gf/cm2 and TM under 50 (Kawabata 1980, The Standardization and Analysis of Hand Evaluation).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi, radians, sqrt

import numpy as np

from sim_core.weave.instruments.held_filaments import (
    FILAMENT_FRICTION,
    Assumed,
    HeldYarn,
    held_yarns,
    loaded_force,
    pressed_length,
    with_held,
)
from sim_core.weave.instruments.hysteresis import Sliding
from sim_core.weave.instruments.readings import GF_CM, GF_CM2
from sim_core.weave.instruments.set_beams import Load, SetBeams, Settled
from sim_core.weave.model import Weave
from sim_core.weave.yarns.beams import relax
from sim_core.weave.yarns.geometry import YarnGeometry
from sim_core.weave.yarns.paths import strands
from sim_core.weave.yarns.shifts import MANY

__all__ = ["Specimen"]

MOST_PULL = 500 * GF_CM  # [N/m]
PULLS = (0.03, 0.1, 0.3, 0.6, 1.0)  # of it, where the curve is read
PROBE = 0.5  # [N/m] small enough for a nearly linear answer
SHEAR_PULL = 10 * GF_CM  # [N/m]
SHEAR_TURN = radians(8)
BEND_TURN = 250.0  # [1/m]
LIGHT, HEAVY = 0.5 * GF_CM2, 50 * GF_CM2  # [Pa]
WIDTH_HELD = 2e-5  # strain of the width that is left
SECANTS = 12  # to hold it
SIDES = "warp", "weft"


@dataclass(frozen=True, eq=False)
class Specimen:
    """weave: simple, without extra wefts.  rest: of stage A.  assumed: what the model does not settle.
    like: a specimen under other assumptions, from whose balance this one's begins."""

    weave: Weave
    rest: YarnGeometry
    assumed: Assumed
    like: Specimen | None = None

    @cached_property
    def yarns(self) -> tuple[HeldYarn, HeldYarn]:
        """Warp and weft as they bend in the cloth."""
        return held_yarns(self.weave, self.rest, self.assumed)

    @cached_property
    def stiff(self) -> Weave:
        """The weave, its yarns as stiff as they bend while nothing slides."""
        return with_held(self.weave, self.yarns, self.assumed)

    @cached_property
    def beams(self) -> SetBeams:
        """The cell that is loaded."""
        reach = (
            self.like.beams.reach if self.like else _reach(self.weave, self.rest)
        )  # the same whatever is assumed
        return SetBeams(self.stiff, self.rest, self.assumed.kept, reach)

    @cached_property
    def slack(self) -> Settled:
        """The cell without a load."""
        return self.beams.settle(Load(), self.like.slack if self.like else None)

    @cached_property
    def unset(self) -> YarnGeometry:
        """A large cell by stage A, its yarns as stiff as in the test and nothing of their crimp set: long waves are so
        soft that the beams between plates and under pull would take minutes, and stage A has its own ways there."""
        return relax(self.stiff, start=self.rest)

    @property
    def many(self) -> bool:
        """Whether the cell is a large one."""
        return self.rest.force.size > MANY

    def forces(self, pull: float = 0.0) -> np.ndarray:
        """(picks, ends) [N] at the crossings, the warp pulled by `pull` [N] an end (left out of large cells)."""
        if self.many:
            return (1 - self.assumed.kept) * self.unset.force
        return (self.beams.settle(Load((pull, 0.0)), self.slack) if pull else self.slack).force

    @cached_property
    def pressed(self) -> tuple[Settled, Settled]:
        """Between plates, under the light pressure and the heavy one."""
        light = self.beams.settle(Load(pressure=LIGHT), self.like.pressed[0] if self.like else self.slack)
        return light, self.beams.settle(Load(pressure=HEAVY), self.like.pressed[1] if self.like else light)

    def compliance(self) -> np.ndarray:
        """Strains per tension [m/N] at rest, (2, 2) symmetric (Maxwell, Betti): [0, 0] warp, [1, 1] weft,
        [0, 1] crimp interchange, negative where pulling one yarn system shortens the other."""
        weave, columns = self.stiff, []
        counts, axial = (weave.ends_per_m, weave.picks_per_m), (weave.warp.axial, weave.weft.axial)
        for side in (0, 1):
            # The slope at rest by Richardson's rule: a push would buckle a figure's long waves.
            once, twice = (self._straightened(side, share * PROBE / counts[side]) for share in (1, 2))
            strain = (2 * once - twice / 2) / PROBE
            strain[side] += 1 / (axial[side] * counts[side])
            columns.append(strain)
        matrix = np.column_stack(columns)
        return (matrix + matrix.T) / 2

    def _straightened(self, side: int, pull: float) -> np.ndarray:
        """Crimp (2,) that a pull [N] on each yarn of one system takes from both."""
        pulls = (pull, 0.0) if side == 0 else (0.0, pull)
        if not self.many:
            return np.array(self.slack.crimp) - self.beams.settle(Load(pulls), self.slack).crimp
        slack, pulled = self.unset, relax(self.stiff, tension=pulls, start=self.unset)
        return np.array(
            [
                slack.warp_crimp.mean() - pulled.warp_crimp.mean(),
                slack.weft_crimp.mean() - pulled.weft_crimp.mean(),
            ]
        )

    def thickness(self) -> dict[str, float]:
        """T0 and TM [m], and `free` without plates: from the highest to the lowest point."""
        light, heavy = self.pressed
        return {"free": self.slack.thickness, "T0": light.thickness, "TM": heavy.thickness}

    def bending(self) -> dict[str, dict[str, float]]:
        """B [N m] and 2HB [N] along the warp and along the weft."""
        force, weave = loaded_force(self.forces()), self.weave
        counts = weave.ends_per_m, weave.picks_per_m
        crimps = self.rest.warp_crimp, self.rest.weft_crimp
        found = {}
        for side, yarn, count, crimp in zip(SIDES, self.yarns, counts, crimps, strict=True):
            loop, per_metre = yarn.bending(force), count / (1 + float(crimp.mean()))
            found[side] = {
                "B": per_metre * loop.slope(50.0, 150.0, BEND_TURN),
                "2HB": per_metre * loop.width(100.0, BEND_TURN),
            }
        return found

    def shearing(self) -> Sliding:
        """Shear force [N/m] against the angle [rad], without what the pull along the warp adds.

        Crossings hold by the friction of the patch where the yarns press, and the yarns bend between them until the
        patch turns: torque mu V r, r the mean distance from the middle of a round patch of the same area.
        """
        weave = self.weave
        force = float(self.forces(SHEAR_PULL / weave.ends_per_m).mean())
        wide = self.assumed.wide
        arm = 2 / 3 * sqrt(pressed_length(weave.warp, wide) * pressed_length(weave.weft, wide) / pi)
        torque = FILAMENT_FRICTION * force * arm
        p1, p2 = weave.end_spacing, weave.pick_spacing
        warp, weft = self.yarns
        frame = 12 / (p1 * p2 * (p2 / warp.stiffness + p1 / weft.stiffness))
        return Sliding(frame, 0.0, torque / (p1 * p2))

    def shear(self) -> dict[str, float]:
        """G [N/m per rad] with the pull's own share, as the instrument reads it, 2HG and 2HG5 [N/m]; `secant` [N/m per
        rad] at 8 degrees without it."""
        loop = self.shearing()
        return {
            "G": SHEAR_PULL + loop.slope(radians(0.5), radians(2.5), SHEAR_TURN),
            "2HG": loop.width(radians(0.5), SHEAR_TURN),
            "2HG5": loop.width(radians(5), SHEAR_TURN),
            "secant": loop.once(SHEAR_TURN) / SHEAR_TURN,
        }

    def tensile(self) -> dict[str, dict[str, float]]:
        """EMT, LT, WT [J/m2] and RT along the warp and along the weft."""
        return {side: self._pulled(k) for k, side in enumerate(SIDES)}

    def _pulled(self, side: int) -> dict[str, float]:
        """The curve of one direction, and its readings."""
        weave = self.stiff
        count, axial = (weave.ends_per_m, weave.picks_per_m)[side], (weave.warp.axial, weave.weft.axial)
        last, cross, tensions, strains, lost = self.slack, 0.0, [0.0], [0.0], 0.0
        for part in PULLS:
            before, pull = last, part * MOST_PULL / count
            last, cross = self._held_width(last, side, pull, cross, axial[1 - side])
            tensions.append(part * MOST_PULL)
            strains.append(self.slack.crimp[side] - last.crimp[side] + pull / axial[side])
            lost += self._rubbed(before, last)
        work = float(np.trapezoid(tensions, strains))
        return {
            "EMT": strains[-1],
            "LT": work / (0.5 * tensions[-1] * strains[-1]),
            "WT": work,
            "RT": max(0.0, 1 - 2 * lost / work),
        }

    def _held_width(
        self, last: Settled, side: int, pull: float, cross: float, axial: float
    ) -> tuple[Settled, float]:
        """Pulled along one yarn system at constant width: the cell, and the pull of the other system [N] that keeps it.

        last, cross: of the pull before.  axial: EA of the other yarn.
        """

        def widened(other: float, start: Settled) -> tuple[float, Settled]:
            made = self.beams.settle(Load((pull, other) if side == 0 else (other, pull)), start)
            return self.slack.crimp[1 - side] - made.crimp[1 - side] + other / axial, made

        low = cross
        strain, last = widened(low, last)
        high = low + 0.1 * pull
        for _ in range(SECANTS):
            if abs(strain) < WIDTH_HELD or (low == 0 and strain > 0):
                return last, low
            beyond, last = widened(high, last)
            slope = (beyond - strain) / (high - low)
            following = max(0.0, high - beyond / slope) if slope > 0 else 2 * high
            low, strain, high = high, beyond, following
        return last, low

    def _rubbed(self, before: Settled, after: Settled) -> float:
        """Work [J/m2] of friction between filaments as pressed lengths straighten: M0 times the angle, a crossing."""
        weave, work = self.weave, 0.0
        force = (loaded_force(before.force) + loaded_force(after.force)) / 2
        for axis, yarn, spacing in zip(
            (0, 1), self.yarns, (weave.pick_spacing, weave.end_spacing), strict=True
        ):
            turns = [_turns(getattr(one, SIDES[axis]), axis) / spacing for one in (before, after)]
            work += yarn.moment(force) * float(np.abs(turns[1] - turns[0]).mean())
        return work / (weave.end_spacing * weave.pick_spacing)


def _turns(height: np.ndarray, axis: int) -> np.ndarray:
    return np.roll(height, 1, axis) - 2 * height + np.roll(height, -1, axis)


def _reach(weave: Weave, rest: YarnGeometry) -> np.ndarray:
    """(4, picks, ends) [m] from the axis of stage A to the top and the bottom of the spread section."""
    warp, weft = strands(weave, rest)
    per = warp.height.shape[1] // weave.draft.picks
    found = []
    for system, axis in ((warp, rest.warp_height.T), (weft, rest.weft_height)):
        sunk, half = system.height[:, ::per] - axis, system.half_height[:, ::per]
        found += [sunk + half, half - sunk]
    return np.stack([found[0].T, found[1].T, found[2], found[3]])
