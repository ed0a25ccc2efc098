"""Yarns of a finished cloth as beams, between plates or under pull.

Finishing sets silk: boiled off in the cloth, a yarn keeps most of its crimp when it is drawn out. Its beam has then a
shape of its own, a share s of the shape z0 that weaving bent it to, and presses on the others with 1 - s of the force
that stage A finds for straight ones. The heights minimise
    1/2 (zw - s z0w) Kw (zw - s z0w) + 1/2 zw Tw zw + the same of the weft + pressure x area x thickness
subject to contact, s (zw - zf) >= 1 in units of D, and to all yarns lying between two plates. Kw is diagonal in Fourier
modes as in `beams`; since each yarn touches both plates by the same measure, the thickness drops out of the equations
of the heights, and the alternating direction method of multipliers needs a 2 x 2 solve a mode.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.fft import irfft2, rfft2

from sim_core.weave.model import Weave
from sim_core.weave.yarns.beams import beam_stiffness, crimp_of
from sim_core.weave.yarns.geometry import YarnGeometry

__all__ = ["Load", "SetBeams", "Settled"]

TOLERANCE = 1e-6  # of D
TOLERANCE_PRESSED = 1e-5  # between plates: a nanometre
ITERATIONS = 4_000
OVER_RELAXATION = 1.6


@dataclass(frozen=True)
class Load:
    """pulls: of each end and each pick [N].  pressure: of the plates [Pa], 0 where there are none."""

    pulls: tuple[float, float] = (0.0, 0.0)
    pressure: float = 0.0


@dataclass(frozen=True, eq=False)
class Settled:
    """warp, weft: (picks, ends) [m] heights.  crimp: means of warp and weft.  force: (picks, ends) [N] at crossings.
    thickness: [m] between the plates, without them from the highest to the lowest point.
    state: to begin from under a load that differs little."""

    warp: np.ndarray
    weft: np.ndarray
    crimp: tuple[float, float]
    force: np.ndarray
    thickness: float
    state: _State


@dataclass(frozen=True, eq=False)
class SetBeams:
    """weave: its yarns as stiff as they bend in the test.  rest: of stage A.  kept: share s of the shape that is set.
    reach: (4, picks, ends) [m] from the axis up and down, of the warp and of the weft at each crossing."""

    weave: Weave
    rest: YarnGeometry
    kept: float
    reach: np.ndarray

    def settle(self, load: Load, start: Settled | None = None) -> Settled:
        """Heights in balance under a load; start: of the same yarns under one that differs little."""
        weave = self.weave
        picks, ends = self.rest.warp_height.shape
        unit_length = (weave.warp.height + weave.weft.height) / 2
        bent = _stiffness(weave, (0.0, 0.0), (picks, ends))
        pulled = _stiffness(weave, load.pulls, (picks, ends))
        unit = float(np.sqrt(bent[0].max() * bent[1].max()))
        shapes = [
            self.kept * height / unit_length for height in (self.rest.warp_height, self.rest.weft_height)
        ]
        half = ends // 2 + 1
        problem = _Problem(
            sign=np.where(weave.draft.lift, 1.0, -1.0),
            stiffness=tuple(k[:, :half] / unit for k in pulled),
            pushed=tuple(
                k[:, :half] / unit * np.asarray(rfft2(z)) for k, z in zip(bent, shapes, strict=True)
            ),
            reach=self.reach / unit_length,
            weight=load.pressure * weave.end_spacing * weave.pick_spacing / (unit * unit_length),
        )
        if start:
            state = _scaled(start.state, _penalty(problem))
        else:
            pressing = (1 - self.kept) * self.rest.force / (unit * unit_length)
            state = _begun(problem, (self.rest.warp_height - self.rest.weft_height) / unit_length, pressing)
        if load.pressure and len(state.split) == 1:
            state = _between_plates(problem, state)
        state = _balanced(problem, state)
        warp, weft = state.heights[0] * unit_length, state.heights[1] * unit_length
        top, bottom = _extremes((warp, weft), self.reach)
        crimps = crimp_of(warp, weave.pick_spacing, 0), crimp_of(weft, weave.end_spacing, 1)
        force = np.maximum(problem.sign * -state.dual[0] * state.penalties[0], 0.0)
        return Settled(
            warp,
            weft,
            (float(crimps[0].mean()), float(crimps[1].mean())),
            force * unit * unit_length,
            state.thickness * unit_length if load.pressure else top - bottom,
            state,
        )


def _stiffness(
    weave: Weave, pulls: tuple[float, float], shape: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray]:
    """K of both yarn systems over the whole spectrum, (picks, ends) each [N/m]."""
    warp = beam_stiffness(shape[0], weave.pick_spacing, weave.warp.stiffness, pulls[0])[:, None]
    weft = beam_stiffness(shape[1], weave.end_spacing, weave.weft.stiffness, pulls[1])[None, :]
    return np.broadcast_to(warp, shape), np.broadcast_to(weft, shape)


@dataclass(frozen=True, eq=False)
class _Problem:
    """In units of D and of the stiffest mode. pushed: spectra of the forces that bring each yarn to its set shape.
    reach: (4, picks, ends) of warp and weft up and down. weight: of the plates on the area of a crossing."""

    sign: np.ndarray
    stiffness: tuple[np.ndarray, ...]
    pushed: tuple[np.ndarray, ...]
    reach: np.ndarray
    weight: float


@dataclass(frozen=True, eq=False)
class _State:
    """Of the alternating directions. split: (1 or 5, picks, ends) gap at each crossing and, between plates, distances
    of warp and weft from both. dual: its multipliers over the penalties, that of the gap and that of the plates."""

    split: np.ndarray
    dual: np.ndarray
    penalties: np.ndarray
    heights: tuple[np.ndarray, np.ndarray]
    thickness: float


def _balanced(problem: _Problem, state: _State) -> _State:
    """ADMM from a state, until gaps and distances agree and no longer change."""
    sign, plates = problem.sign, len(state.split) > 1
    split, dual, penalties = state.split, state.dual, state.penalties.copy()
    heights, thickness = state.heights, state.thickness
    blocks = (slice(0, 1), slice(1, 5)) if plates else (slice(0, 1),)
    enough = TOLERANCE_PRESSED if plates else TOLERANCE
    for iteration in range(1, ITERATIONS + 1):
        wanted = split - dual
        heights = _heights(problem, wanted, penalties)
        if plates:
            thickness = float(wanted[1:].sum() / 2 / sign.size - problem.weight / penalties[1])
        placed = _placed(heights, thickness, plates)
        mixed = OVER_RELAXATION * placed + (1 - OVER_RELAXATION) * split
        before, split = split, mixed + dual
        split[0] = sign * np.maximum(sign * split[0], 1.0)
        if plates:
            split[1:] = np.maximum(split[1:], problem.reach)
        dual = dual + mixed - split
        errors = [
            (float(np.abs(placed[b] - split[b]).max()), float(np.abs(split[b] - before[b]).max()))
            for b in blocks
        ]
        if max(map(max, errors)) < enough:
            break
        if iteration % 20 == 0:
            for k, (primal, change) in enumerate(errors):
                if not 0.2 < primal / max(change, 1e-300) < 5:
                    factor = 2.0 if primal > change else 0.5
                    penalties[k] *= factor
                    dual[blocks[k]] /= factor
    return _State(split, dual, penalties, heights, thickness)


def _begun(problem: _Problem, gap: np.ndarray, pressing: np.ndarray) -> _State:
    """As stage A left the cell, with what finishing left of its forces."""
    penalty = _penalty(problem)
    dual = -problem.sign * pressing / penalty
    return _State(gap[None], dual[None], np.array([penalty, 0.0]), (gap, gap), 0.0)


def _scaled(state: _State, penalty: float) -> _State:
    """The same forces under another penalty of the gap."""
    dual, penalties = state.dual.copy(), state.penalties.copy()
    dual[0] *= penalties[0] / penalty
    penalties[0] = penalty
    return replace(state, dual=dual, penalties=penalties)


def _penalty(problem: _Problem) -> float:
    """Between the softest and the stiffest mode of the gap, in which both yarn systems give way."""
    warp, weft = problem.stiffness
    resist = warp * weft / np.maximum(warp + weft, 1e-300)
    stiff = resist[resist > 0]
    return float(np.sqrt(stiff.min() * stiff.max()))


def _between_plates(problem: _Problem, state: _State) -> _State:
    """Plates laid on yarns in balance without them; the middle of the cloth comes to lie halfway."""
    top, bottom = _extremes(state.heights, problem.reach)
    thickness, middle = top - bottom, (top + bottom) / 2
    heights = state.heights[0] - middle, state.heights[1] - middle
    placed = _placed(heights, thickness, True)
    placed[0] = state.split[0]
    dual = np.concatenate([state.dual, np.zeros((4, *problem.sign.shape))])
    return _State(placed, dual, np.full(2, state.penalties[0]), heights, thickness)


def _extremes(heights: tuple[np.ndarray, np.ndarray], reach: np.ndarray) -> tuple[float, float]:
    """The highest and the lowest point of all yarns."""
    top = max(float((h + up).max()) for h, up in zip(heights, reach[::2], strict=True))
    return top, min(float((h - down).min()) for h, down in zip(heights, reach[1::2], strict=True))


def _placed(heights: tuple[np.ndarray, np.ndarray], thickness: float, plates: bool) -> np.ndarray:
    warp, weft = heights
    if not plates:
        return (warp - weft)[None]
    half = thickness / 2
    return np.stack([warp - weft, half - warp, half + warp, half - weft, half + weft])


def _heights(problem: _Problem, wanted: np.ndarray, penalties: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Heights of both yarn systems that answer what the split variables ask: a 2 x 2 system in every mode."""
    gap = rfft2(wanted[0]) * penalties[0]
    right = [problem.pushed[0] + gap, problem.pushed[1] - gap]
    own = penalties[0]
    if len(wanted) > 1:
        own = own + 2 * penalties[1]
        right[0] = right[0] + penalties[1] * rfft2(wanted[2] - wanted[1])
        right[1] = right[1] + penalties[1] * rfft2(wanted[4] - wanted[3])
    first, second = problem.stiffness[0] + own, problem.stiffness[1] + own
    determinant = first * second - penalties[0] ** 2
    determinant = np.where(determinant > 1e-14 * first * second, determinant, np.inf)
    warp = (second * right[0] + penalties[0] * right[1]) / determinant
    weft = (first * right[1] + penalties[0] * right[0]) / determinant
    if len(wanted) == 1:  # the cloth as a whole floats: its middle stays where it is
        middle = wanted[0].sum() / 2
        warp[0, 0], weft[0, 0] = middle, -middle
    shape = problem.sign.shape
    return np.asarray(irfft2(warp, s=shape)), np.asarray(irfft2(weft, s=shape))
