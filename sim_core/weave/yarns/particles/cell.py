"""Stage B: yarn particles in 3-D brought to rest on one energy, periodic, started from stage A.

Energy: bending, tension times length, contact of flattened sections (also of neighbours), and friction at the
crossings as work against slip from the place as woven (the pressing force held fixed while it is evaluated, then
renewed). Minimised by Nesterov's method, each yarn turning back by itself, in steps divided by its own stiffness. The
contact is an augmented Lagrangian: it stays soft, and is set out by what it overlaps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.model import Weave
from sim_core.weave.yarns.geometry import YarnGeometry
from sim_core.weave.yarns.jam import check_jam
from sim_core.weave.yarns.particles.closest_pairs import curve_overlap
from sim_core.weave.yarns.particles.figures import Wanted, rest_of_figure
from sim_core.weave.yarns.particles.nesterov import Outcome, Yarns
from sim_core.weave.yarns.particles.scale import Scale, crimp_of
from sim_core.weave.yarns.shifts import MANY, draft_shift, turns_of
from sim_core.weave.yarns.splines import resampled

__all__ = ["NotAtRest", "ParticleCell", "is_figure", "relax_particles"]

RESIDUAL = 1e-3
OVERLAP = 4.5e-4  # of D, where contact acts; what is promised, of curves everywhere, is
PINNED, PROMISED = 4.2e-4, 5e-4
LOOK = 300  # steps after which pins are sought again though the yarns still move
ROUNDS = 400  # of rest and pins
ROUGH = (50.0, 10.0, 3.0)  # x tolerance: rest enough to find the first pins
SOFT = 40.0  # first stiffness of the contact, x largest crossing force
MOST_STEPS = 80_000
FIGURE = 500  # crossings from which it is a figure, unless it is a satin or a twill
FINEST = 16  # particles a crossing, up to which a figure that is too steep for fewer begins again with more
BEGIN = 100  # steps after which a figure that is not at rest is relaxed another way
FIGURE_STEPS = 8000  # and after which pins have the rest of the steps, from the start
YARN_FRICTION = 0.3
STIFFER = 1.3  # x stiffness, after a round that leaves the yarns overlapping


class NotAtRest(WeaveError):
    """The particles were still moving after the steps that were allowed."""


@dataclass(frozen=True, eq=False)
class ParticleCell:
    """One repeat in force balance; particle 0 of every yarn stands at crossing 0.

    warp_side, warp_height: (ends, picks * per) [m], sideways from the end's place and above the middle plane.
    weft_side, weft_height: (picks, ends * per) [m].  force: (picks, ends) [N] that presses at each crossing.
    warp_crimp: (ends,), weft_crimp: (picks,), of the curves.  residual: largest net force on a particle / largest
    crossing force.  penetration: deepest overlap of two yarns that cross, anywhere on their curves, or of particles
    of neighbours, or widest gap across which a contact presses (of figures: a crossing), in units of D, the mean height
    of warp and weft.
    static: by how much static friction exceeds sliding friction where yarns stick, of figures that slid, as a share.
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
    static: float = 0.0

    @property
    def skew(self) -> tuple[float, float]:
        """Largest sideways shift of a crossing from its mean over the repeat [m], of the warp and of the weft."""
        warp, weft = self.warp_side[:, :: self.per], self.weft_side[:, :: self.per]
        return float(np.abs(warp - warp.mean()).max()), float(np.abs(weft - weft.mean()).max())

    def crest_to_trough(self) -> tuple[float, float]:
        """h1 of the warp and h2 of the weft [m]."""
        return float(np.ptp(self.warp_height, axis=1).max()), float(np.ptp(self.weft_height, axis=1).max())


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
    Figures (see is_figure) are relaxed by rest_of_figure first, and by pins where that does not bring them to rest;
    those that turn more steeply than `per` particles can show get half as many more, up to 16: see the cell's `per`.
    Raises WeaveError for a jammed sett, NotAtRest where the cell does not come to rest within `most` steps.
    """
    from sim_core.weave.yarns.beams import relax

    if not 4 <= per <= 64:
        raise WeaveError(f"weave {weave.name}: {per} particles a crossing – give 4 to 64")
    check_jam(weave)
    lift = np.ascontiguousarray(weave.draft.lift)
    first = start or relax(weave, tolerance=1e-4)
    scale = Scale.of(weave, per, friction)
    turns = turns_of(lift) if lift.size > MANY else None
    figure = is_figure(lift)
    one = slice(None) if turns is None else slice(1)
    shifts = (np.zeros(0, np.int64), 0, 0) if turns is None else turns.particles(per)
    lift = lift[one]
    watch = np.zeros(2) if watch is None else watch

    def start_again() -> Yarns:
        return _begun(first, lift, one, scale, shifts, watch)

    yarns = start_again()
    done = _pinned(yarns, tolerance, min(most, BEGIN) if figure else most)
    if figure and not _rests(done, tolerance):
        finer = min(3 * per // 2, FINEST)
        done = rest_of_figure(yarns, done, Wanted(tolerance, PROMISED, min(most, FIGURE_STEPS), finer > per))
        if done.coarse:
            cell = relax_particles(
                weave,
                per=finer,
                friction=friction,
                tolerance=tolerance,
                start=start,
                most=most - done.steps,
                watch=watch,
            )
            return replace(cell, steps=cell.steps + done.steps)
        if not _rests(done, tolerance) and done.steps < most:  # long floats may rest by pins alone
            yarns, before = start_again(), done.steps
            done = _pinned(yarns, tolerance, most - before)
            done = replace(done, steps=before + done.steps)
    wu, wz, fu, fz = yarns.places
    if not _rests(done, tolerance):
        raise NotAtRest(
            f"weave {weave.name}: the yarns do not come to rest (residual {done.residual:.1e}, "
            f"overlap {done.overlap:.1e} D, after {done.steps} steps) – lower the sett, or allow a larger residual"
        )
    units, energy = scale.units, done.energy
    crimp1, crimp2 = crimp_of(wu, wz, units.warp.piece), crimp_of(fu, fz, units.weft.piece)
    sides = [place * scale.length for place in (wu, wz, fu, fz)]
    force = yarns.pressing * scale.force
    if turns is not None:
        sides, force = turns.all_yarns(per, sides, force)
        crimp1, crimp2, energy = (
            np.repeat(crimp1, len(force)),
            np.repeat(crimp2, len(force)),
            energy * len(force),
        )
    wu, wz, fu, fz = sides
    return ParticleCell(
        per, wu, wz, fu, fz, force, crimp1, crimp2, float(done.residual), float(done.overlap),
        float(energy) * scale.force * scale.length, friction, int(done.steps), done.static,
    )  # fmt: skip


def _begun(
    first: YarnGeometry, lift: np.ndarray, one: slice, scale: Scale, shifts: tuple, watch: np.ndarray
) -> Yarns:
    """Yarns along the beams of stage A, pressing as they do, where they were woven."""
    per, reach = scale.per, (scale.units.warp.reach, scale.units.weft.reach)
    wz, fz = (
        resampled(first.warp_height.T[one], per) / scale.length,
        resampled(first.weft_height[one], per) / scale.length,
    )
    wu, fu = np.zeros_like(wz), np.zeros_like(fz)
    pressing = first.force[one] / scale.force
    hardest = max(float(pressing.max()), 1e-12)
    offsets = np.zeros((*lift.shape, 2 * (sum(reach) + 1))), np.zeros_like(wu), np.zeros_like(fu)
    for middle in (reach[0], -1 - reach[1]):  # the crossing itself carries what the beams say
        offsets[0][:, :, middle] = pressing / (2 * SOFT * hardest)
    places = wu, wz, fu, fz
    ways = np.zeros((len(wu), 2)), np.zeros((len(fu), 2))
    motion = np.zeros((2, *wu.shape)), np.zeros((2, *fu.shape)), *ways
    forces = tuple(np.zeros_like(place) for place in places)
    return Yarns(places, forces, lift, pressing, offsets, motion, shifts, per, scale.units, hardest, watch)


def is_figure(lift: np.ndarray) -> bool:
    """Whether a large draft is no satin or twill, whose long floats rest by pins alone. lift: (picks, ends)."""
    return lift.size >= FIGURE and draft_shift(lift) is None


def _rests(done: Outcome, tolerance: float) -> bool:
    return done.residual <= tolerance and done.overlap <= PROMISED


def _pinned(yarns: Yarns, tolerance: float, most: int) -> Outcome:
    """Rounds of rest and pins, of contact that is stiffened where the yarns still overlap."""
    deep, steps, pins, stiff = 0.0, 0, np.zeros((0, 6)), SOFT * yarns.hardest
    warp, weft = yarns.units.warp, yarns.units.weft
    done = Outcome(np.inf, np.inf, 0.0, 0, stiff)
    for rough in (*ROUGH, *(1.0,) * ROUNDS):
        turn = min(most - steps, LOOK if deep > OVERLAP else max(LOOK, steps // 3))
        done = yarns.settle(
            stiff, turn, pins=pins, tolerance=rough * tolerance, overlap=OVERLAP, renew=deep > OVERLAP
        )
        steps, stiff = steps + done.steps, done.stiff
        asked: list = [
            *yarns.places, yarns.lift, yarns.per, warp.piece, weft.piece, warp.wide, weft.wide, warp.reach, weft.reach,
            pins, max(PINNED, done.overlap), yarns.shifts[0],
        ]  # fmt: skip
        between, new = curve_overlap(*asked)
        deep = done.overlap
        done = Outcome(done.residual, max(deep, between), done.energy, steps, stiff)
        if steps >= most or _rests(done, tolerance):
            break
        if deep > OVERLAP:  # not at rest: stiffer contact leaves less to set out
            stiff *= STIFFER
            for array in (*yarns.offsets, pins[:, 5]):
                array /= STIFFER
        pins = np.vstack([pins, new])
    return done
