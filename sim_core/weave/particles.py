"""Stage B: yarn particles in 3-D brought to rest on one energy, periodic, started from stage A.

Energy: bending, tension times length, contact of flattened sections (also of neighbours), and friction at the
crossings as work against slip from the place as woven (the pressing force held fixed while it is evaluated, then
renewed). Minimised by Nesterov's method, each yarn turning back by itself, in steps divided by its own stiffness. The
contact is an augmented Lagrangian: it stays soft, and is set out by what it overlaps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from sim_core.errors import WeaveError
from sim_core.weave.closest_pairs import curve_overlap, pin_forces
from sim_core.weave.geometry import YarnGeometry
from sim_core.weave.jam import check_jam
from sim_core.weave.lines import resampled
from sim_core.weave.model import Weave
from sim_core.weave.particle_forces import contact_forces, side_forces, yarn_forces
from sim_core.weave.particle_scale import Scale, crimp_of
from sim_core.weave.shifted import MANY, turns_of
from sim_core.weave.yarn_steps import advance, factored, power

__all__ = ["NotAtRest", "ParticleCell", "relax_particles"]

RESIDUAL = 1e-3
DEEP, HELPED = 0.02, 0.5  # overlap at rest [D], or share of the last one, from which the contact is stiffened
OVERLAP = 4.5e-4  # of D, where contact acts; what is promised, of curves everywhere, is
PINNED, PROMISED = 4.2e-4, 5e-4
LOOK = 300  # steps after which pins are sought again though the yarns still move
ROUNDS = 400  # of rest and pins
ROUGH = (50.0, 10.0, 3.0)  # x tolerance: rest enough to find the first pins
SOFT = 40.0  # first stiffness of the contact, x largest crossing force
MOST_STEPS = 80_000
YARN_FRICTION = 0.3
LONGEST_STEP = 0.7  # x 1 / fastest frequency
SHORTER, PATIENCE, SHORTEST = 0.8, 800, 0.3  # of that, after so many steps without gain, down to so many
STIFFER = 1.3  # x stiffness, after a round that leaves the yarns overlapping
SLACK = 1.0  # EI/l^3 on the diagonal: contacts that come between two weighings must not throw a yarn
WEIGH, FADE = 10, 0.99  # steps between two weighings of the particles, and how slowly a mass may fall
SIDE = 0.3  # stiffness of the contact of neighbours, relative to that at crossings


class NotAtRest(WeaveError):
    """The particles were still moving after the steps that were allowed."""


@dataclass(frozen=True, eq=False)
class ParticleCell:
    """One repeat in force balance; particle 0 of every yarn stands at crossing 0.

    warp_side, warp_height: (ends, picks * per) [m], sideways from the end's place and above the middle plane.
    weft_side, weft_height: (picks, ends * per) [m].  force: (picks, ends) [N] that presses at each crossing.
    warp_crimp: (ends,), weft_crimp: (picks,), of the curves.  residual: largest net force on a particle / largest
    crossing force.  penetration: deepest overlap of two yarns that cross, anywhere on their curves, or of particles
    of neighbours, or widest gap across which a contact presses, in units of D, the mean height of warp and weft.
    skew: (warp, weft) largest sideways shift of a crossing against the yarns' mean [m].
    """

    per: int
    warp_side: np.ndarray
    warp_height: np.ndarray
    weft_side: np.ndarray
    weft_height: np.ndarray
    force: np.ndarray
    warp_crimp: np.ndarray
    weft_crimp: np.ndarray
    residual: float
    penetration: float
    energy: float
    friction: float
    steps: int

    @property
    def skew(self) -> tuple[float, float]:
        """Largest sideways shift of a crossing from its mean over the repeat [m], of the warp and of the weft."""
        warp, weft = self.warp_side[:, :: self.per], self.weft_side[:, :: self.per]
        return float(np.abs(warp - warp.mean()).max()), float(np.abs(weft - weft.mean()).max())

    def crest_to_trough(self) -> tuple[float, float]:
        """h1 of the warp and h2 of the weft [m]."""
        return float(np.ptp(self.warp_height, axis=1).max()), float(np.ptp(self.weft_height, axis=1).max())


@njit(cache=True, error_model="numpy", nogil=True)
def _settle(
    places, lift, pressing, offsets, motion, pins, turns, per, numbers, stiff, tolerance, overlap, most, overlapping,
    watch,
):  # fmt: skip
    """Nesterov's method. numbers: l1, l2, EI1, EI2, T1, T2, wide_x, wide_y, reach1, reach2, p1, p2, side1,
    high1, side2, high2, friction, slip.  places: wu, wz, fu, fz.  offsets: of contacts at crossings, of ends, of picks.
    motion: speeds of both systems, and their ways as of advance; it goes on from one round to the next.
    turns: (ends,) as of contact_forces, and those of the next end and pick in side_forces, or empty.
    overlapping: contacts are to be set out at once.  watch: (2,) steps and residual, written.
    Returns (residual, overlap, energy, steps, stiffness)."""
    wu, wz, fu, fz = places
    held, held1, held2 = offsets
    speed1, speed2, way1, way2 = motion
    l1, l2, e1, e2, t1, t2, wide_x, wide_y, r1, r2, p1, p2, s1, h1, s2, h2, friction, slip = numbers
    reach1, reach2 = int(r1), int(r2)
    gwu, gwz, gfu, gfz = np.zeros_like(wu), np.zeros_like(wz), np.zeros_like(fu), np.zeros_like(fz)
    (vwu, vwz), (vfu, vfz) = speed1, speed2
    hwu, hwz, hfu, hfz = np.zeros_like(wu), np.zeros_like(wz), np.zeros_like(fu), np.zeros_like(fz)
    mwu, mwz, mfu, mfz = np.zeros_like(wu), np.zeros_like(wz), np.zeros_like(fu), np.zeros_like(fz)
    near = np.zeros((*lift.shape, 2 * (reach1 + reach2 + 1)), np.uint8)
    made1, made2 = np.zeros((2, *wu.shape, 5)), np.zeros((2, *fu.shape, 5))
    bend1, bend2, pull1, pull2 = e1 / l1**3, e2 / l2**3, t1 / l1, t2 / l2
    at, side1, side2 = turns
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
            reach1, reach2, stiff, friction, slip, weigh, hwu, hwz, hfu, hfz, at,
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
        elif (
            step - since > PATIENCE
        ):  # some particles flutter between touching and not: smaller steps calm them
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


def relax_particles(
    weave: Weave,
    *,
    per: int = 8,
    friction: float = YARN_FRICTION,
    tolerance: float = RESIDUAL,
    start: YarnGeometry | None = None,
    most: int = MOST_STEPS,
    watch: np.ndarray | None = None,
) -> ParticleCell:
    """Bring the particles of one repeat to rest.

    per: particles for each crossing and yarn, 4 to 64.  friction: Coulomb's mu between warp and weft.  tolerance: of
    the net force on a particle, relative to the largest crossing force.  start: stage A of this weave, made if absent.
    watch: (2,) float64, steps done and residual of the last one, written as it goes for another thread to show.
    Above 10,000 crossings satins and twills are relaxed by one pick and one end, of which all others are shifts.
    Raises WeaveError for a jammed sett, NotAtRest where the cell does not come to rest within `most` steps.
    """
    from sim_core.weave.relaxation import relax

    if not 4 <= per <= 64:
        raise WeaveError(f"weave {weave.name}: {per} particles a crossing – give 4 to 64")
    check_jam(weave)
    lift = np.ascontiguousarray(weave.draft.lift)
    first = start or relax(weave, tolerance=1e-4)
    scale = Scale.of(weave, per)
    turns = turns_of(lift) if lift.size > MANY else None
    one = slice(None) if turns is None else slice(1)
    shifts = (np.zeros(0, np.int64), 0, 0) if turns is None else turns.particles(per)
    lift = lift[one]
    wz, fz = (
        resampled(first.warp_height.T[one], per) / scale.length,
        resampled(first.weft_height[one], per) / scale.length,
    )
    wu, fu = np.zeros_like(wz), np.zeros_like(fz)
    pressing = first.force[one] / scale.force
    stiff = SOFT * max(float(pressing.max()), 1e-12)
    numbers = scale.numbers(friction)
    l1, l2, wide_x, wide_y = *numbers[:2], *numbers[6:8]
    deep, steps, pins = 0.0, 0, np.zeros((0, 6))
    offsets = np.zeros((*lift.shape, 2 * (sum(scale.reach) + 1))), np.zeros_like(wu), np.zeros_like(fu)
    for middle in (scale.reach[0], -1 - scale.reach[1]):  # the crossing itself carries what the beams say
        offsets[0][:, :, middle] = pressing / (2 * stiff)
    places = wu, wz, fu, fz
    watch = np.zeros(2) if watch is None else watch
    ways = np.zeros((len(wu), 2)), np.zeros((len(fu), 2))
    motion = np.zeros((2, *wu.shape)), np.zeros((2, *fu.shape)), *ways
    for rough in (*ROUGH, *(1.0,) * ROUNDS):
        turn = min(most - steps, LOOK if deep > OVERLAP else max(LOOK, steps // 3))
        residual, deepest, energy, more, stiff = _settle(
            places, lift, pressing, offsets, motion, pins, shifts, per, numbers, stiff, rough * tolerance, OVERLAP,
            turn, deep > OVERLAP, watch,
        )  # fmt: skip
        steps += more
        between, new = curve_overlap(
            wu, wz, fu, fz, lift, per, l1, l2, wide_x, wide_y, *scale.reach, pins, max(PINNED, deepest),
            shifts[0],
        )  # fmt: skip
        deep, deepest = deepest, max(deepest, between)
        if steps >= most or residual <= tolerance and deepest <= PROMISED:
            break
        if deep > OVERLAP:  # not at rest: stiffer contact leaves less to set out
            stiff *= STIFFER
            for array in (*offsets, pins[:, 5]):
                array /= STIFFER
        pins = np.vstack([pins, new])
    if residual > tolerance or deepest > PROMISED:
        raise NotAtRest(
            f"weave {weave.name}: the yarns do not come to rest (residual {residual:.1e}, overlap {deepest:.1e} D, "
            f"after {steps} steps) – lower the sett, or allow a larger residual"
        )
    crimp1, crimp2 = crimp_of(wu, wz, l1), crimp_of(fu, fz, l2)
    sides = [place * scale.length for place in (wu, wz, fu, fz)]
    force = pressing * scale.force
    if turns is not None:
        sides, force = turns.all_yarns(per, sides, force)
        crimp1, crimp2, energy = (
            np.repeat(crimp1, len(force)),
            np.repeat(crimp2, len(force)),
            energy * len(force),
        )
    wu, wz, fu, fz = sides
    return ParticleCell(
        per, wu, wz, fu, fz, force, crimp1, crimp2, float(residual), float(deepest),
        float(energy) * scale.force * scale.length, friction, int(steps),
    )  # fmt: skip
