"""Nesterov's method on the yarns of stage B until they are at rest, or for a number of steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.weave.yarns.particles.closest_pairs import pin_forces
from sim_core.weave.yarns.particles.forces import contact_forces, side_forces, yarn_forces
from sim_core.weave.yarns.particles.preconditioner import advance, factored, power
from sim_core.weave.yarns.particles.scale import Units

__all__ = ["Outcome", "Yarns"]

DEEP, HELPED = 0.02, 0.5  # overlap at rest [D], or share of the last one, from which the contact is stiffened
LONGEST_STEP = 0.7  # x 1 / fastest frequency
SHORTER, PATIENCE, SHORTEST = 0.8, 800, 0.3  # of that, after so many steps without gain, down to so many
SLACK = 1.0  # EI/l^3 on the diagonal: contacts that come between two weighings must not throw a yarn
WEIGH, FADE = 10, 0.99  # steps between two weighings of the particles, and how slowly a mass may fall
SIDE = 0.3  # stiffness of the contact of neighbours, relative to that at crossings


@dataclass(frozen=True)
class Outcome:
    """How yarns ended: largest net force / largest crossing force, overlap [D], energy, steps, contact's stiffness, and
    by how much static friction exceeded sliding friction in the end; coarse: whether they need more particles."""

    residual: float
    overlap: float
    energy: float
    steps: int
    stiff: float
    static: float = 0.0
    coarse: bool = False


class Yarns(NamedTuple):
    """The yarns of one repeat on their way to rest; the arrays are changed in place.

    places: wu, wz, fu, fz as of contact_forces, and the forces on them.  offsets: of contacts at crossings, of ends, of
    picks.  motion: speeds of both systems, and their ways as of advance; it goes on from one round to the next.
    shifts: (ends,) turns as of contact_forces, and those of the next end and pick in side_forces, or empty.
    hardest: largest crossing force at the start, of the beams.  watch: (2,) steps and residual.
    """

    places: tuple[np.ndarray, ...]
    forces: tuple[np.ndarray, ...]
    lift: np.ndarray
    pressing: np.ndarray
    offsets: tuple[np.ndarray, ...]
    motion: tuple[np.ndarray, ...]
    shifts: tuple[np.ndarray, int, int]
    per: int
    units: Units
    hardest: float
    watch: np.ndarray

    def settle(
        self,
        stiff: float,
        most: int,
        *,
        pins: np.ndarray | None = None,
        apart: np.ndarray | None = None,
        stuck: np.ndarray | None = None,
        tolerance: float = -1.0,
        overlap: float = 1.0,
        renew: bool = False,
    ) -> Outcome:
        """At most `most` steps with contact of this stiffness, fewer if it comes to rest within tolerance and overlap.

        pins: (n, 6) as of curve_overlap.  apart, stuck: (picks, ends, 2 and 3) as of contact_forces.
        renew: set contacts out first.
        """
        pins = np.zeros((0, 6)) if pins is None else pins
        apart = np.zeros((0, 0, 2)) if apart is None else apart
        stuck = np.zeros((0, 0, 3)) if stuck is None else stuck
        return Outcome(*_settle(self, pins, apart, stuck, stiff, tolerance, overlap, most, renew))


@njit(cache=True, error_model="numpy", nogil=True)
def _settle(yarns, pins, apart, stuck, stiff, tolerance, overlap, most, overlapping):
    """Nesterov's method on `Yarns`. Returns (residual, overlap, energy, steps, stiffness).

    apart, stuck: as of contact_forces.  overlapping: contacts are to be set out at once.
    """
    lift, pressing, per, watch = yarns.lift, yarns.pressing, yarns.per, yarns.watch
    wu, wz, fu, fz = yarns.places
    held, held1, held2 = yarns.offsets
    speed1, speed2, way1, way2 = yarns.motion
    warp, weft, friction, slip = yarns.units
    l1, e1, t1, wide_x, reach1, p1, s1, h1 = warp
    l2, e2, t2, wide_y, reach2, p2, s2, h2 = weft
    gwu, gwz, gfu, gfz = yarns.forces
    (vwu, vwz), (vfu, vfz) = speed1, speed2
    hwu, hwz, hfu, hfz = np.zeros_like(wu), np.zeros_like(wz), np.zeros_like(fu), np.zeros_like(fz)
    mwu, mwz, mfu, mfz = np.zeros_like(wu), np.zeros_like(wz), np.zeros_like(fu), np.zeros_like(fz)
    near = np.zeros((*lift.shape, 2 * (reach1 + reach2 + 1)), np.uint8)
    made1, made2 = np.zeros((2, *wu.shape, 5)), np.zeros((2, *fu.shape, 5))
    bend1, bend2, pull1, pull2 = e1 / l1**3, e2 / l2**3, t1 / l1, t2 / l2
    at, side1, side2 = yarns.shifts
    residual, deepest, before, energy, steps = np.inf, np.inf, np.inf, 0.0, 0
    longest, best, since = LONGEST_STEP, np.inf, 0
    for step in range(most):
        steps = step + 1
        renew = overlapping
        weigh = renew or step % WEIGH == 0
        overlapping = False
        gwu[:], gwz[:], gfu[:], gfz[:] = 0.0, 0.0, 0.0, 0.0
        if weigh:
            hwu[:], hwz[:], hfu[:], hfz[:] = 0.0, 0.0, 0.0, 0.0
        energy = yarn_forces(wu, wz, l1, e1, t1, gwu, gwz) + yarn_forces(fu, fz, l2, e2, t2, gfu, gfz)
        side = 0.0
        if s1 > 0:
            more, side = side_forces(
                wu, wz, p1, s1, h1, SIDE * stiff, gwu, gwz, held1, renew, weigh, hwu, hwz, side1
            )
            energy += more
        if s2 > 0:
            more, other = side_forces(
                fu, fz, p2, s2, h2, SIDE * stiff, gfu, gfz, held2, renew, weigh, hfu, hfz, side2
            )
            energy += more
            side = max(side, other)
        more, deepest, largest = contact_forces(
            wu, wz, fu, fz, gwu, gwz, gfu, gfz, lift, pressing, near, held, renew, per, l1, l2, wide_x, wide_y,
            reach1, reach2, stiff, friction, slip, weigh, hwu, hwz, hfu, hfz, at, apart, stuck,
        )  # fmt: skip
        energy += more
        deepest = max(deepest, side)
        if len(pins):
            more, deep, most_pressed = pin_forces(
                pins, wu, wz, fu, fz, gwu, gwz, gfu, gfz, lift, pressing, per, l1, l2, wide_x, wide_y, reach1, reach2,
                stiff, renew, weigh, hwu, hwz, hfu, hfz, at,
            )  # fmt: skip
            energy, deepest, largest = energy + more, max(deepest, deep), max(largest, most_pressed)
        if weigh:
            for m, h, bend, pull, made in (
                (mwu, hwu, bend1, pull1, made1[0]),
                (mwz, hwz, bend1, pull1, made1[1]),
                (mfu, hfu, bend2, pull2, made2[0]),
                (mfz, hfz, bend2, pull2, made2[1]),
            ):
                for y in range(m.shape[0]):
                    for k in range(m.shape[1]):
                        m[y, k] = max(SLACK * bend + 3.0 * h[y, k], FADE * m[y, k])
                factored(m, bend, pull, made)
        worst = max(power(vwu, vwz, gwu, gwz, way1), power(vfu, vfz, gfu, gfz, way2))
        residual = worst / max(largest, 1e-300)
        watch[0], watch[1] = watch[0] + 1, residual
        if residual < 0.7 * best:
            best, since = residual, step
        elif step - since > PATIENCE:
            # some particles flutter between touching and not: smaller steps calm them
            longest, best, since = max(SHORTER * longest, SHORTEST), residual, step
        if weigh and residual < tolerance:
            if deepest <= overlap:
                break
            if not renew:
                # at rest, but the yarns overlap: contacts are set out by as much, and stiffened where that helps little
                if deepest > max(DEEP, HELPED * before):
                    factor = min(max(deepest / DEEP, 2.0), 20.0)
                    stiff *= factor
                    held /= factor
                    held1 /= factor
                    held2 /= factor
                    pins[:, 5] /= factor
                overlapping, before = True, deepest
                continue
        advance(wu, wz, vwu, vwz, gwu, gwz, made1[0], made1[1], way1, longest)
        advance(fu, fz, vfu, vfz, gfu, gfz, made2[0], made2[1], way2, longest)
    return residual, deepest, energy, steps, stiff
