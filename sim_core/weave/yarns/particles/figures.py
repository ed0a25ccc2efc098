"""Rest of large figures: contact that stays soft, curves kept apart without pins, and common waves moved at once.

Pins hold places; in a large figure in a close sett the yarns slide far before they rest, leave their pins, and get new
ones, while the contact is stiffened round after round. Here nothing is pinned: where two curves come nearer to each
other than their particles do, the particles of that crossing keep farther by as much, which is renewed as they slide.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from sim_core.weave.yarns.particles.closest_pairs import curve_gaps
from sim_core.weave.yarns.particles.common_waves import CommonWaves
from sim_core.weave.yarns.particles.forces import side_forces
from sim_core.weave.yarns.particles.nesterov import Outcome, Yarns

__all__ = ["STATIC", "Wanted", "rest_of_figure"]

SOFT = 20.0  # stiffness of the contact, x largest crossing force
TURN = 30  # steps between two looks at the curves
FARTHEST = 0.1  # of D, particles keep from a curve beyond touching it
SLIDE = 0.5  # of D, that yarns slide sideways and their contacts must follow
WAVED = 20  # turns after which common waves are moved no more
WIDE = 100  # crossings, beyond which a repeat needs them at all
STICK = 6  # turns between two times when yarns that have come to creep stick
SLID = 0.03  # of D, away from where they stuck
STATIC = 0.2  # by how much static friction exceeds sliding friction
COARSE = 50  # turns after which curves that overlap, however far their particles keep, need more of them
CREEP = 60  # turns after which what still creeps is held harder
HARDER = 1.2  # times as hard each time that it may stick
PRESSED = 1e-3  # x largest crossing force, from which a crossing is held to touch


@dataclass(frozen=True)
class Wanted:
    """When a figure is at rest: tolerance: of the residual; overlap: of curves [D], and of the gap of two that press.

    most: steps; finer: whether the figure may be begun again with more particles."""

    tolerance: float
    overlap: float
    most: int
    finer: bool = False


def rest_of_figure(yarns: Yarns, begun: Outcome, wanted: Wanted) -> Outcome:
    """Bring yarns that the plain way did not bring to rest to it, or to the most steps; begun: how that way ended.

    Yarns that turn more steeply than their particles can show overlap between them, however far those keep: where more
    may be had, the outcome is `coarse` then. Long floats of a loose sett would slide on
    for ever and draw together into ropes: what still creeps after 1,800 steps is held by static friction that grows.
    """
    picks, ends = yarns.lift.shape
    stiff = SOFT * yarns.hardest
    yarns = _reaching(yarns)
    yarns.offsets[0][:] = (
        0.0  # curves are kept apart here, not particles: both would answer one overlap twice
    )
    for array in yarns.offsets[1:]:  # neighbours press as before
        array *= begun.stiff / stiff
    apart, gaps = np.zeros((picks, ends, 2)), np.zeros((picks, ends, 2))
    waves = CommonWaves.of((picks, ends), yarns.per, yarns.units, stiff)
    steps, turn, done, deepest = begun.steps, 0, begun, begun.overlap
    stuck, static = None, 0.0
    most = wanted.most
    while steps < most:
        if turn and turn % STICK == 0:
            static = STATIC * HARDER ** max(0, (turn - CREEP) // STICK)
            stuck = _stuck(yarns, stuck, static)
        done = yarns.settle(stiff, min(TURN, most - steps), apart=apart, stuck=stuck)
        steps += done.steps
        _measure(gaps, yarns)
        deepest = max(_deepest(gaps, yarns.pressing), _of_neighbours(yarns))
        if done.residual <= wanted.tolerance and deepest <= wanted.overlap:
            break
        if wanted.finer and turn >= COARSE and (gaps[apart >= FARTHEST] < -wanted.overlap).any():
            return Outcome(done.residual, deepest, done.energy, steps, stiff, static, coarse=True)
        if steps < most:  # else what is told of the yarns must be of where they end
            apart = np.clip(apart - gaps, 0.0, FARTHEST)
            _of_neighbours(yarns, renew=True)
            if turn < WAVED and max(picks, ends) > WIDE:
                wu, wz, fu, fz = yarns.places
                waves.move(wz, fz, yarns.forces[1], yarns.forces[3])
        turn += 1
    return Outcome(done.residual, deepest, done.energy, steps, stiff, static)


def _reaching(yarns: Yarns) -> Yarns:
    """The same yarns, but particles as far beyond a crossing as they slide here may touch, too."""
    warp, weft = yarns.units.warp, yarns.units.weft
    most = min(yarns.per * min(yarns.lift.shape), yarns.per) - 1
    old, new = (
        [warp.reach, weft.reach],
        [min(system.reach + ceil(SLIDE / system.piece), most) for system in (warp, weft)],
    )
    held = np.zeros((*yarns.lift.shape, 2 * (sum(new) + 1)))
    for first, second, start in ((0, 0, 0), (2 * old[0] + 1, 2 * new[0] + 1, 1)):
        width, wider = 2 * old[start] + 1, new[start] - old[start]
        held[:, :, second + wider : second + wider + width] = yarns.offsets[0][:, :, first : first + width]
    units = yarns.units._replace(warp=warp._replace(reach=new[0]), weft=weft._replace(reach=new[1]))
    return yarns._replace(units=units, offsets=(held, *yarns.offsets[1:]))


def _stuck(yarns: Yarns, before: np.ndarray | None, static: float) -> np.ndarray:
    """(picks, ends, 3) places of both yarns at each crossing: where it stuck before, unless it slid away from there;
    and by how much static friction exceeds sliding friction."""
    wu, _, fu, _ = yarns.places
    here = np.dstack([wu[:, :: yarns.per].T, fu[:, :: yarns.per], np.full(yarns.lift.shape, static)])
    if before is not None:
        stayed = np.hypot(*np.moveaxis((here - before)[..., :2], 2, 0)) <= SLID
        here[stayed, :2] = before[stayed, :2]
    return here


def _measure(gaps: np.ndarray, yarns: Yarns) -> None:
    """Fill gaps (picks, ends, 2) [D] of the curves at every crossing, round the warp and round the weft."""
    wu, wz, fu, fz = yarns.places
    warp, weft = yarns.units.warp, yarns.units.weft
    curve_gaps(wu, wz, fu, fz, yarns.lift, yarns.per, warp.piece, weft.piece, warp.wide, weft.wide, warp.reach,
               weft.reach, gaps)  # fmt: skip


def _deepest(gaps: np.ndarray, pressing: np.ndarray) -> float:
    """Deepest overlap of curves, or widest gap of two that press on each other [D]."""
    nearest = gaps.min(axis=2)
    pressed = pressing > PRESSED * pressing.max()
    return float(max(-nearest.min(), nearest[pressed].max(initial=0.0)))


def _of_neighbours(yarns: Yarns, *, renew: bool = False) -> float:
    """Deepest overlap of neighbours of one system, or widest gap across which they press [D]; renew: set them out."""
    found = 0.0
    wu, wz, fu, fz = yarns.places
    _, ends, picks = yarns.offsets
    for u, z, system, held in ((wu, wz, yarns.units.warp, ends), (fu, fz, yarns.units.weft, picks)):
        if system.side > 0:
            spare = np.zeros_like(u)
            deep = side_forces(u, z, system.spacing, system.side, system.high, 1.0, spare, spare, held, renew, False,
                               spare, spare, 0)  # fmt: skip
            found = max(found, deep[1])
    return found
