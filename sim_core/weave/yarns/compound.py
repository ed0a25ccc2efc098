"""Compound weaves at rest: the yarns of a unit share one place, the one that shows over those that do not.

Stage A with a second kind of contact. Stacked yarns z (ends of 经锦, picks of 纬锦) and those that cross them w are
beams over each other's places; they minimise

    1/2 z K z + 1/2 w K w   subject to   s (z - w) >= (height_z + height_w) / 2,   s = +1 where z lies above,
                                         z_shows - z_hidden >= height_z            where both lie on one side of w.

What is constrained is A (z, w), differences of yarns at one place, the same at every place; only the sides change. So
the linear step of ADMM is one small matrix, K + rho A'A of the yarns of a unit and the one that crosses them, for each
Fourier mode of the repeat. Yarns that do not show lie side by side: nothing holds them apart from one another.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.model import Weave
from sim_core.weave.yarns.beams import beam_stiffness, crimp_of
from sim_core.weave.yarns.geometry import YarnGeometry
from sim_core.weave.yarns.splines import resampled

__all__ = ["relax_compound"]

TOLERANCE = 1e-8
ITERATIONS = 20_000
MOST_WORK = 400_000_000  # gaps times iterations, a minute or so
LEAST = 1e-9  # stiffness of the mode in which all yarns rise together, of the largest
SLOW = 1000  # steps after which that mode is taken out: its rounding, a milliard times the rest's, holds up many series


@dataclass(frozen=True, eq=False)
class _Stack:
    """A compound repeat with its stacked yarns first, whichever system they are of.

    above, shows: (series, units, crossed) bool, whether a stacked yarn lies above the one it crosses, and whether it is
    the one that is seen.  stiff: (crossed,) K of a stacked yarn over the yarns it crosses; across: (units,) K of those
    over the units [N/m]; apart: distance of two axes that touch at a crossing, and of two of a unit [m].  by_warp:
    whether the stacked yarns are ends; steps: places of a stacked yarn, and units, lie so far apart [m].
    """

    above: np.ndarray
    shows: np.ndarray
    stiff: np.ndarray
    across: np.ndarray
    apart: tuple[float, float]
    by_warp: bool
    steps: tuple[float, float]

    @staticmethod
    def of(weave: Weave) -> _Stack:
        channels, lift = weave.draft.channels, weave.draft.lift
        assert channels.layer is not None
        by_warp = channels.end_series is not None
        series = channels.end_series if by_warp else channels.pick_series
        assert series is not None
        count = 1 + int(series.max())
        if len(series) % count or (series != np.tile(np.arange(count), len(series) // count)).any():
            raise WeaveError(
                f"weave {weave.name}: series {series[: 2 * count].tolist()} … – yarns of a unit are numbered 0 to "
                f"{count - 1}, unit by unit"
            )
        stacked, crossing = (weave.warp, weave.weft) if by_warp else (weave.weft, weave.warp)
        steps = (weave.end_spacing, weave.pick_spacing)
        step, between = steps if by_warp else steps[::-1]

        def by_unit(values: np.ndarray) -> np.ndarray:
            lines = values.T if by_warp else values
            return lines.reshape(-1, count, lines.shape[1]).swapaxes(0, 1)

        above = by_unit(lift if by_warp else ~lift)
        return _Stack(
            above,
            by_unit(channels.layer) == 0,
            beam_stiffness(above.shape[2], between, stacked.stiffness, stacked.tension),
            beam_stiffness(above.shape[1], count * step, crossing.stiffness, crossing.tension),
            ((stacked.height + crossing.height) / 2, stacked.height),
            by_warp,
            (between, count * step),
        )

    def limits(self) -> tuple[np.ndarray, np.ndarray]:
        """Signs and least distances (series + pairs, units, crossed) of what is held apart; sign 0: nothing is."""
        shows, above = self.shows, self.above
        signs: list[np.ndarray] = [np.where(above, 1.0, -1.0)]
        apart: list[np.ndarray] = [np.full(above.shape, self.apart[0])]
        for a, b in combinations(range(len(above)), 2):
            one = (above[a] == above[b]) & (shows[a] != shows[b])
            signs.append((one * np.where(shows[a], 1.0, -1.0))[None])
            apart.append(np.full((1, *above.shape[1:]), self.apart[1]))
        return np.concatenate(signs), np.concatenate(apart)


def relax_compound(weave: Weave, *, tolerance: float = TOLERANCE) -> YarnGeometry:
    """Yarn geometry of one repeat of a compound weave in force balance, its hidden yarns beneath those that show.

    Heights are of every yarn at its crossings, those of the yarns that cross the stacked ones on the spline through the
    units' places. tolerance: on distances and forces, of the distance at a crossing and the largest force. Slopes are
    taken as small, as `relax` does. Raises WeaveError where the iteration does not reach the tolerance.
    """
    stack = _Stack.of(weave)
    series = len(stack.above)
    differences = _differences(series)
    sign, least = stack.limits()
    scale, unit = stack.apart[0], float(max(stack.stiff.max(), stack.across.max()))
    least = least / scale
    stiffness = _stiffness(stack, unit)
    rho = float(np.sqrt(stiffness[stiffness > LEAST].min() * stiffness.max()))
    gap = sign * least
    dual = np.zeros_like(gap)
    solver, error, iteration = _solver(stiffness, differences, rho), np.inf, 0
    heights = np.zeros((series + 1, *gap.shape[1:]))
    for iteration in range(1, max(200, min(ITERATIONS, MOST_WORK // gap.size)) + 1):
        heights = _applied(solver, rho * np.tensordot(differences.T, gap - dual, 1))
        found = np.tensordot(differences, heights, 1)
        before, wanted = gap, found + dual
        gap = np.where(sign == 0, wanted, sign * np.maximum(sign * wanted, least))
        dual = wanted - gap
        primal = float(np.abs(found - gap).max())
        change = float(np.abs(gap - before).max())
        error = max(primal, change)
        if error < tolerance:
            break
        if iteration % 50 == 0 and error > 5 * min(primal, change):
            factor = 2.0 if primal > change else 0.5
            rho, dual = rho * factor, dual / factor
            solver = _solver(stiffness, differences, rho, lying=iteration >= SLOW)
        elif iteration == SLOW:
            solver = _solver(stiffness, differences, rho, lying=True)
    if error > 1e3 * tolerance:
        raise WeaveError(
            f"weave {weave.name}: compound yarns do not settle (error {error:.1e} after {iteration} steps) – bring the "
            "stiffness of warp and weft closer together"
        )
    force = unit * scale * np.maximum(-rho * dual * sign, 0.0)
    room = np.where(sign == 0, 0.0, sign * np.tensordot(differences, heights, 1) - least)
    peak = max(float(force.max()), 1e-300)
    return YarnGeometry(
        **_by_system(stack, scale * heights, force[:series]),
        residual=_unbalanced(sign * force, differences) / peak,
        penetration=scale * float(max(0.0, -room.min())),
        complementarity=float(np.abs(force * room).max()) / peak,
        iterations=iteration,
    )


def _differences(series: int) -> np.ndarray:
    """A (series + pairs, series + 1): each stacked yarn less the crossing one, and each pair of stacked ones."""
    rows = np.zeros((series + series * (series - 1) // 2, series + 1))
    rows[:series, :series], rows[:series, series] = np.eye(series), -1.0
    for row, (a, b) in enumerate(combinations(range(series), 2), series):
        rows[row, [a, b]] = 1.0, -1.0
    return rows


def _stiffness(stack: _Stack, unit: float) -> np.ndarray:
    """(units, crossed // 2 + 1, series + 1) K of each yarn in each mode of the repeat, in `unit`."""
    series, units, crossed = stack.above.shape
    modes = crossed // 2 + 1
    stiffness = np.zeros((units, modes, series + 1))
    stiffness[..., :series] = stack.stiff[:modes, None] / unit
    stiffness[..., series] = stack.across[:, None] / unit
    stiffness[0, 0] += LEAST
    return stiffness


def _solver(stiffness: np.ndarray, differences: np.ndarray, rho: float, *, lying: bool = False) -> np.ndarray:
    """(units, modes, yarns, yarns) inverse of K + rho A'A in each mode; lying: the cloth as a whole neither rises nor
    falls, so that a stiffness of LEAST is not divided by."""
    together = rho * (differences.T @ differences)
    inverse = np.linalg.inv(stiffness[..., None] * np.eye(len(together)) + together)
    if lying:
        risen = np.full_like(together, 1.0 / len(together))
        inverse[0, 0] = np.linalg.inv(together + rho * risen) - risen / rho
    return inverse


def _applied(solver: np.ndarray, pulls: np.ndarray) -> np.ndarray:
    """Heights (yarns, units, crossed) that answer pulls of the same shape."""
    spectrum = np.moveaxis(np.fft.rfft2(pulls), 0, -1)
    answer = np.einsum("umab,umb->uma", solver, spectrum)
    return np.fft.irfft2(np.moveaxis(answer, -1, 0), s=pulls.shape[1:])


def _unbalanced(force: np.ndarray, differences: np.ndarray) -> float:
    """The largest net force on any yarn, of signed forces (series + pairs, units, crossed)."""
    on_yarns = np.tensordot(differences.T, force, 1)
    return float(max(np.abs(on_yarns[:-1].sum(axis=2)).max(), np.abs(on_yarns[-1].sum(axis=0)).max()))


def _by_system(stack: _Stack, heights: np.ndarray, force: np.ndarray) -> dict[str, np.ndarray]:
    """Heights, crimps and crossing forces of warp and weft as `YarnGeometry` has them.

    heights: (series + 1, units, crossed) [m], the crossing yarn's last; force: (series, units, crossed) [N].
    """
    series, units, crossed = force.shape

    def lines(values: np.ndarray) -> np.ndarray:
        return values.swapaxes(0, 1).reshape(series * units, crossed)

    along, crossing = lines(heights[:series]), heights[series]
    # A unit's yarns lie about its middle; the first is counted half a unit before it.
    fine = resampled(crossing.T, 2 * series)
    across = fine[:, (2 * np.arange(series * units) - (series - 1)) % fine.shape[1]].T
    crimps = crimp_of(along, stack.steps[0], 1), crimp_of(crossing, stack.steps[1], 0)
    names = ("warp", "weft") if stack.by_warp else ("weft", "warp")

    def shaped(values: np.ndarray) -> np.ndarray:  # to (picks, ends)
        return values.T if stack.by_warp else values

    return {
        f"{names[0]}_height": shaped(along),
        f"{names[1]}_height": shaped(across),
        "force": shaped(lines(force)),
        f"{names[0]}_crimp": crimps[0],
        f"{names[1]}_crimp": crimps[1],
    }
