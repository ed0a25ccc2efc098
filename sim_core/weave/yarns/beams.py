"""Stage A: yarn heights at the crossings in force balance, as beams with contact in one periodic repeat.

Between crossings a yarn carries no load, so a cubic spline through the crossings is the exact beam. Its energy in the
heights z is diagonal in the Fourier basis along the yarn, with the stiffness per crossing
    K(theta) = EI/p^3 (2 - 2 cos theta)^2 6 / (4 + 2 cos theta) + T/p W(theta),
W being p^2 times the mean squared slope of the spline mode (exact to first order in the tension T).
The heights minimise 1/2 zw K zw + 1/2 zf K zf subject to s (zw - zf) >= (height_w + height_f) / 2 with s = +1 where the
warp is on top. Both yarn systems together answer a pattern of crossing forces f with the gap H f, H = 1/Kw + 1/Kf, so
the alternating direction method of multipliers (ADMM) needs two 2-D FFTs an iteration and no matrix.
"""

from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft2, rfft2

from sim_core.errors import WeaveError
from sim_core.weave.model import Weave
from sim_core.weave.yarns.geometry import YarnGeometry
from sim_core.weave.yarns.jam import check_jam
from sim_core.weave.yarns.shifts import MANY, draft_shift, shifted_forces

__all__ = ["beam_stiffness", "crimp_of", "relax"]

TOLERANCE = 1e-9
TOLERANCE_MANY = 1e-6
ITERATIONS = 20_000
OVER_RELAXATION = 1.7


def beam_stiffness(count: int, spacing: float, stiffness: float, tension: float) -> np.ndarray:
    """K(theta) [N/m] for the `count` periodic modes of a beam over supports `spacing` [m] apart.

    stiffness: EI [N m2]; tension: T [N]. Returns (count,) float64, zero for the constant mode.
    """
    cosine = np.cos(2 * np.pi * np.arange(count) / count)
    wave = 2 - 2 * cosine
    return stiffness / spacing**3 * wave**2 * 6 / (4 + 2 * cosine) + tension / spacing * _slope_energy(cosine)


@dataclass(frozen=True, eq=False)
class _Problem:
    """The scaled problem: lengths in D, stiffnesses in `unit` [N/m]."""

    warp: np.ndarray  # (picks, 1) K of the ends, along the picks they cross
    weft: np.ndarray  # (1, ends)
    sign: np.ndarray  # (picks, ends) +1 where the warp is on top


def relax(
    weave: Weave,
    *,
    tension: tuple[float, float] = (0.0, 0.0),
    tolerance: float | None = None,
    crowded: bool = False,
    start: YarnGeometry | None = None,
) -> YarnGeometry:
    """Yarn geometry of one repeat in force balance (stage A), periodic and free of penetration.

    tension: (T of each warp end, T of each pick) [N], added to that of the yarns.  tolerance: on gap and force,
    relative to D and to the largest crossing force, 1e-9 unless there are more than 10,000 crossings, then 1e-6.
    crowded: whether yarns that find no room beside each other are taken all the same.  start: of a weave that differs
    little, to begin from.
    Slopes are taken as small: expect crimp up to a few per cent to be exact, near jam it is not.
    Raises WeaveError for a jammed sett, or where the iteration does not reach the tolerance.
    """
    if not crowded:
        check_jam(weave)
    picks, ends = weave.draft.lift.shape
    if tolerance is None:
        tolerance = TOLERANCE if picks * ends <= MANY else TOLERANCE_MANY
    pulls = weave.warp.tension + tension[0], weave.weft.tension + tension[1]
    warp = beam_stiffness(picks, weave.pick_spacing, weave.warp.stiffness, pulls[0])[:, None]
    weft = beam_stiffness(ends, weave.end_spacing, weave.weft.stiffness, pulls[1])[None, :]
    distance = (weave.warp.height + weave.weft.height) / 2
    unit = float(np.sqrt(warp.max() * weft.max()))
    problem = _Problem(warp / unit, weft / unit, np.where(weave.draft.lift, 1.0, -1.0))
    first = None
    if start is not None:
        first = (
            (start.warp_height - start.weft_height) / distance,
            problem.sign * start.force / (unit * distance),
        )
    shift = draft_shift(weave.draft.lift) if picks * ends > MANY else None
    exact = (
        None if shift is None else shifted_forces(problem.warp[:, 0], problem.weft[0], problem.sign, shift)
    )
    if exact is not None:
        return _geometry(weave, problem, *exact[:2], distance, unit, exact[2])
    force, gap, iterations, error = _contact_forces(problem, tolerance, first)
    if error > 1e3 * tolerance:
        raise WeaveError(
            f"weave {weave.name}: yarn heights do not settle (error {error:.1e} after {iterations} steps) – "
            "bring the stiffness of warp and weft closer together"
        )
    return _geometry(weave, problem, force, gap, distance, unit, iterations)


def _contact_forces(
    problem: _Problem, tolerance: float, start=None
) -> tuple[np.ndarray, np.ndarray, int, float]:
    """ADMM on the gap g = zw - zf with a penalty that is balanced as it goes. Returns force on the warp, gap, ...

    start: gap and force to begin from.
    """
    together = np.maximum(problem.warp + problem.weft, 1e-300)
    resist = problem.warp * problem.weft / together  # 1 / H, zero where a yarn may move as a whole
    resist = resist[:, : problem.sign.shape[1] // 2 + 1]  # of a real pattern half the spectrum is enough
    stiff = resist[resist > 0]
    rho = float(np.sqrt(stiff.min() * stiff.max()))
    gap = problem.sign.copy()
    dual = np.zeros_like(gap)
    if start is not None:
        gap, dual = start[0], -start[1] / rho
    error = np.inf
    for iteration in range(1, ITERATIONS + 1):
        free = np.asarray(irfft2(rho / (rho + resist) * np.asarray(rfft2(gap - dual)), s=gap.shape))
        mixed = OVER_RELAXATION * free + (1 - OVER_RELAXATION) * gap
        before = gap
        gap = problem.sign * np.maximum(problem.sign * (mixed + dual), 1.0)
        dual = dual + mixed - gap
        primal = float(np.abs(free - gap).max())
        scale = max(float(np.abs(dual).max()), 1e-300)
        change = float(np.abs(gap - before).max()) / scale
        error = max(primal, change)
        if error < tolerance:
            break
        if iteration % 20 == 0 and max(primal, change) > 5 * min(primal, change):
            factor = 2.0 if primal > change else 0.5
            rho, dual = rho * factor, dual / factor
    return -rho * dual, gap, iteration, error


def _geometry(weave, problem, force, wanted, distance, unit, iterations) -> YarnGeometry:
    """Heights of both yarns, and everything measured on them. wanted: (picks, ends) gap / D."""
    force = np.where(problem.sign * force > 0, force, 0.0)
    warp, weft = _shared(problem, wanted) if force.size > MANY else _bent(problem, force, wanted)
    gap = problem.sign * (warp - weft) - 1
    pressure = problem.sign * force
    peak = max(float(pressure.max()), 1e-300)
    net = max(float(np.abs(force.sum(axis=0)).max()), float(np.abs(force.sum(axis=1)).max())) / peak
    return YarnGeometry(
        warp_height=warp * distance,
        weft_height=weft * distance,
        force=pressure * unit * distance,
        warp_crimp=crimp_of(warp * distance, weave.pick_spacing, 0),
        weft_crimp=crimp_of(weft * distance, weave.end_spacing, 1),
        residual=net,
        penetration=float(max(0.0, -gap.min())) * distance,
        complementarity=float(np.abs(pressure * gap).max()) / peak,
        iterations=iterations,
    )


def _bent(problem: _Problem, force: np.ndarray, wanted: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Heights that exactly answer the forces."""
    spectrum = np.fft.fft2(force)
    with np.errstate(divide="ignore", invalid="ignore"):
        warp = np.where(problem.warp > 0, spectrum / problem.warp, 0.0)
        weft = np.where(problem.weft > 0, -spectrum / problem.weft, 0.0)
    warp_mean, weft_mean = _means(wanted)
    return np.fft.ifft2(warp).real + warp_mean, np.fft.ifft2(weft).real + weft_mean


def _shared(problem: _Problem, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Heights that exactly make the gap, shared by the yarns' stiffness: long waves of a large repeat are so soft that
    the least error of a force would bend them through each other."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = problem.weft / (problem.warp + problem.weft)
    share[0, 0] = 0.5
    warp = np.fft.ifft2(np.fft.fft2(gap) * share).real
    return warp, warp - gap


def _means(gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean height of each end (1, ends) and pick (picks, 1): bending leaves them free, only the contact sets them."""
    half = gap.mean() / 2
    return gap.mean(axis=0, keepdims=True) - half, half - gap.mean(axis=1, keepdims=True)


def crimp_of(height: np.ndarray, spacing: float, axis: int) -> np.ndarray:
    """Excess length of each yarn, 1/2 mean of the squared slope of its periodic cubic spline."""
    count = height.shape[axis]
    theta = 2 * np.pi * np.arange(count) / count
    cosine = np.cos(theta)
    weight = _slope_energy(cosine) / spacing**2
    shape = [1, 1]
    shape[axis] = count
    power = np.abs(np.fft.fft(height, axis=axis) / count) ** 2
    return 0.5 * (power * weight.reshape(shape)).sum(axis=axis)


def _slope_energy(cosine: np.ndarray) -> np.ndarray:
    """Mean squared slope x p^2 of the periodic cubic spline through the samples of one unit Fourier mode."""
    # slopes m of the spline obey (4 + 2 cos) m = 6 i sin z / p; Hermite integral of the squared slope per interval
    sine_square = 1 - cosine**2
    slope = 36 * sine_square / (4 + 2 * cosine) ** 2
    coupling = 6 * sine_square / (4 + 2 * cosine)
    return 6 / 5 * (2 - 2 * cosine) - 2 / 5 * coupling + (4 - cosine) / 15 * slope
