"""The recipe `robe_on_figure`: panels cut flat, sewn and draped on a figure whose arms come down."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from sim_core.body import Beneath, Pose
from sim_core.cloth import Checkpoint, Contact, Drape, Holds, Material, Phase, drape
from sim_core.cloth.step import schedule
from sim_core.garment.pattern.cloth import Cloth
from sim_core.garment.pattern.pattern import Pattern
from sim_core.garment.placement.flat import Laying, laid
from sim_core.garment.recipes.halves import Half, half_sheet, whole_holds
from sim_core.garment.recipes.schedule import GRAVITY, LIMIT, SHELL, UNTANGLE, Schedule
from sim_core.garment.settled import Settled
from sim_core.weave import ClothParameters, Weave, parameters_of, solve

__all__ = ["FigureLike", "Worn", "dress"]

OVER = 0.012  # [m] of the laid cloth above shoulders and arms
SAG = 0.0013  # strain under the coat's own weight if spread evenly; at a neckline on sloping shoulders it is not
FOLD = 1.3  # bending length (B / rho g)^(1/3) in edges: below 1.15 folds look like crumpled paper
GAP = 0.004  # [m] from the middle, which the fronts do not pass
# On a figure that moves cloth needs room; on one that stands still the same room only squeezes it where it is narrow.
DRESSING = Contact(0.004, 0.002, SHELL, speed_limit=2.5, untangle=UNTANGLE, partly=True)
SETTLING = replace(DRESSING, clearance=0.003, sample_clearance=0.0015, separation=0.3, partly=False)


class FigureLike(Protocol):
    """What a robe is dressed on: closed mesh and distance field of any pose of its arms, mirrored in x = 0."""

    @property
    def name(self) -> str: ...
    @property
    def origin(self) -> tuple[float, float, float]: ...
    @property
    def cell(self) -> float: ...
    def field(self, pose: Pose) -> np.ndarray: ...
    def mesh(self, pose: Pose) -> tuple[np.ndarray, np.ndarray]: ...
    def beneath(self, pose: Pose) -> Beneath: ...


@dataclass(frozen=True)
class Worn:
    """A dressed half: the cut cloth, its draped pattern vertices (P, 3), all runs, the seam gap before welding [m]."""

    cloth: Cloth
    positions: np.ndarray
    half: Half
    runs: tuple[Drape, ...]
    gap: float
    materials: list[Material]
    choices: dict[str, str]
    settled: Settled


def dress(
    pattern: Pattern,
    weave: Weave,
    figure: FigureLike,
    *,
    edge: float,
    timing: Schedule,
    stitch: tuple[float, float, float] | None = None,
    progress: Callable[[float, str], None] | None = None,
    on_frame: Callable[[int, np.ndarray, Pose], None] | None = None,
    checkpoint: Path | None = None,
) -> Worn:
    """Dresses one half; on_frame(index, pattern positions (P, 3), pose) hears 25 frames a second.

    stitch: the fronts stay closer to the middle than the third number [m] between two heights below the shoulder
    [m], as a display stitch keeps them. checkpoint: file to go on from; two more are written beside it.
    """
    cloth = pattern.cloth(edge)
    materials, kind, choices = robe_materials(
        parameters_of(weave, solve(weave, particles=True)), pattern, cloth, edge
    )
    apart = np.array([number if panel.along else 0 for number, panel in enumerate(pattern.panels)])[
        cloth.panel
    ]
    body = timing.body(figure.origin, figure.cell, figure.field, figure.name)
    start = laid(pattern, cloth, _laying(figure))
    stages = _Stages(cloth, timing, progress, on_frame)

    open_ = half_sheet(cloth, cloth.joined, materials, kind, apart, even=True)
    x = open_.gathered(start)
    holds = robe_holds(pattern, cloth, open_, stitch, x)
    sewn = drape(
        open_.sheet,
        x,
        timing.sewing(),
        collider=body,
        contact=DRESSING,
        holds=holds,
        checkpoint=checkpoint and Checkpoint(checkpoint, keep=True),
        **stages.hooks(open_, 0, timing.sewing()),
    )
    gap = seam_gap(cloth, open_, sewn.positions)

    shut = half_sheet(cloth, cloth.closed, materials, kind, apart, even=True)
    x = shut.gathered(sewn.positions[open_.number])
    v = shut.gathered(sewn.velocities[open_.number])
    v[shut.middle, 0] = 0.0
    nape, runs = nape_pins(pattern, cloth, shut), [sewn]
    files = [checkpoint.with_name(f"{checkpoint.name}.{number}") if checkpoint else None for number in (2, 3)]
    courses = (timing.dressing(nape), DRESSING), (timing.settling(nape), SETTLING)
    for (phases, contact), file in zip(courses, files, strict=True):
        runs.append(
            drape(
                shut.sheet,
                x,
                phases,
                velocities=v,
                collider=body,
                contact=contact,
                holds=robe_holds(pattern, cloth, shut, stitch, x),
                checkpoint=file and Checkpoint(file, keep=True),
                **stages.hooks(shut, sum(run.frames for run in runs), phases),
            )
        )
        x, v = runs[-1].positions, runs[-1].velocities
    for file in (checkpoint, *files):
        if file:
            file.unlink(missing_ok=True)
    last = timing.settling(())[-1]
    holds = whole_holds(robe_holds(pattern, cloth, shut, stitch, x), shut, cloth)
    settled = Settled(SETTLING, last, holds, figure.beneath(timing.pose))
    return Worn(cloth, x[shut.number], shut, tuple(runs), gap, materials, choices, settled)


class _Stages:
    """Turns frames and progress of all runs into those of one."""

    def __init__(
        self,
        cloth: Cloth,
        timing: Schedule,
        progress: Callable[[float, str], None] | None,
        on_frame: Callable[[int, np.ndarray, Pose], None] | None,
    ) -> None:
        self._cloth, self._timing, self._progress, self._on_frame = cloth, timing, progress, on_frame

    def hooks(self, half: Half, first: int, phases: tuple[Phase, ...]) -> dict[str, Any]:
        """The keyword arguments of `drape` that report one run whose first frame is number `first`."""
        own = _frames(phases)
        timing = self._timing
        whole = sum(_frames(part) for part in (timing.sewing(), timing.dressing(()), timing.settling(())))
        poses = _poses(self._timing, phases)

        def told(fraction: float, label: str) -> None:
            assert self._progress is not None
            self._progress((first + fraction * own) / whole, label)

        def heard(index: int, x: np.ndarray) -> None:
            assert self._on_frame is not None
            self._on_frame(first + index, x[half.number], poses[min(index, len(poses) - 1)])

        return {"progress": told if self._progress else None, "on_frame": heard if self._on_frame else None}


def _frames(phases: tuple[Phase, ...]) -> int:
    return len(schedule(phases))


def _poses(dressing: Schedule, phases: tuple[Phase, ...]) -> list[Pose]:
    """The figure's pose at the end of every frame."""
    return [dressing.pose_of(frame.body[1]) for frame in schedule(phases)]


def _laying(figure: FigureLike) -> Laying:
    """Over the highest point of arms and shoulders, the neck left out."""
    vertices, _ = figure.mesh(Pose())
    return Laying(top=float(vertices[np.abs(vertices[:, 0]) > 0.1, 1].max()) + OVER)


def robe_materials(
    parameters: ClothParameters, pattern: Pattern, cloth: Cloth, edge: float
) -> tuple[list[Material], np.ndarray, dict[str, str]]:
    """Single and doubled cloth, which each face (F,) is of, and what was simplified, in words.

    As far as the scene needs it: stretch is lowered until the robe's weight strains it by SAG, bending takes the
    weave's lower bound (fibres free to slide) but no less than the mesh resolves. Doubled: twice the mass and
    stretch, six times the bending (two layers that slide a little).
    """
    density = float(parameters.density)
    length = float(np.abs(cloth.vertices[:, 1]).max())
    enough = density * GRAVITY * length / SAG
    stretch = [min(float(k), enough) for k in (parameters.stretch_weft, parameters.stretch_warp)]
    free = [float(parameters.bounds[name][0]) for name in ("bend_warp", "bend_weft")]
    resolved = density * GRAVITY * (FOLD * edge) ** 3
    single = Material(
        density=density,
        stretch=stretch[0],
        stretch_warp=stretch[1],
        shear=min(float(parameters.shear), min(stretch) / 2.6),
        poisson=min(float(parameters.poisson), 0.3),
        bend=max(free[1], resolved),
        bend_warp=max(free[0], resolved),
        friction=float(parameters.friction),
        mass_damping=2.0,
        stiffness_damping=2e-5,
    )
    twice = replace(
        single,
        density=2 * density,
        stretch=2 * stretch[0],
        stretch_warp=2 * stretch[1],
        shear=2 * (single.shear or 0.0),
        bend=6 * single.bend,
        bend_warp=6 * max(free[0], resolved),
    )
    doubled = np.array([panel.doubled for panel in pattern.panels])
    choices = {
        "stretch": f"{stretch[0]:.0f} N/m instead of {parameters.stretch_weft:.0f}: {SAG:.2%} strain by its weight",
        "bend": f"lower bounds, warp {free[0]:.2e} and weft {free[1]:.2e} N m (fibres free), at least {resolved:.2e} "
        f"for a {edge * 1e3:.0f} mm mesh",
        "doubled": "bands: twice the mass and stretch, six times the bending",
    }
    return [single, twice], doubled[cloth.panel].astype(np.int32), choices


def robe_holds(
    pattern: Pattern, cloth: Cloth, half: Half, stitch: tuple[float, float, float] | None, x: np.ndarray
) -> Holds:
    count = len(half.sheet.rest)
    low, high = np.full(count, -np.inf), np.full(count, np.inf)
    front = np.zeros(half.real, bool)
    fall = np.full(half.real, -np.inf)  # below the shoulder fold, of the fronts and the bands along them
    for number, panel in enumerate(pattern.panels):
        own = cloth.panel_of == number
        ahead = own & (cloth.vertices[:, 1] > 0)
        front[half.number[ahead]] = True
        if panel.along is not None:
            np.maximum.at(fall, half.number[ahead], cloth.vertices[ahead, 1])
    low[: half.real][front] = GAP
    if stitch is not None:
        high[: half.real][(fall > stitch[0]) & (fall < stitch[1])] = stitch[2]
    low[half.middle] = high[half.middle] = 0.0
    pairs = np.unique(np.sort(half.number[_sewn_twins(pattern, cloth)], axis=1), axis=0)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    return Holds.of(
        count, pairs=pairs, positions=x, low=low, high=high, slaves=half.slaves, limit=(LIMIT, LIMIT)
    )


def _sewn_twins(pattern: Pattern, cloth: Cloth) -> np.ndarray:
    """Pattern vertices (K, 2) that `sewn` seams bring together."""
    twins = [np.zeros((0, 2), np.int32)]
    for seam in pattern.seams:
        if seam.kind == "sewn" and seam.b is not None:
            sides = [cloth.along(path, pattern.panel(path.panel)) for path in (seam.a, seam.b)]
            twins.append(np.column_stack(sides))
    return np.concatenate(twins)


def seam_gap(cloth: Cloth, half: Half, positions: np.ndarray) -> float:
    """Largest distance [m] of two vertices that one point of the closed robe has."""
    x = positions[half.number]
    low, high = (np.full((cloth.closed.max() + 1, 3), fill) for fill in (np.inf, -np.inf))
    np.minimum.at(low, cloth.closed, x)
    np.maximum.at(high, cloth.closed, x)
    return float(np.linalg.norm(high - low, axis=1).max())


def nape_pins(pattern: Pattern, cloth: Cloth, half: Half) -> tuple[int, ...]:
    """The vertices pinned at the nape: on the middle where the band meets the body, and their neighbours there."""
    middle = cloth.vertices[cloth.middle]
    body = cloth.panel_of[cloth.middle] == 0
    top = int(half.number[cloth.middle[body][np.argmax(middle[body, 1])]])
    edges = half.sheet.edges
    near = edges[(edges == top).any(1)].ravel()
    return tuple(int(k) for k in np.unique(near[near < half.real]))
