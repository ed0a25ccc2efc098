"""The recipe `pibo_on_figure`: a gauze scarf (披帛) round a figure's back and over its forearms."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from sim_core import metrics
from sim_core.body import Beneath, Surface
from sim_core.body.mannequin import Mannequin
from sim_core.body.pose import Pose
from sim_core.cloth import Checkpoint, Contact, Drape, Holds, Phase, drape
from sim_core.cloth.contact.distance_field import DistanceField, field_of, united
from sim_core.cloth.run.drape_run import ENGINE_VERSION
from sim_core.errors import SimCoreError
from sim_core.garment.garment import Garment
from sim_core.garment.pattern.cloth import Cloth
from sim_core.garment.pattern.pattern import Pattern
from sim_core.garment.placement.along_path import Accordion, arranged_path, swept
from sim_core.garment.recipes.halves import Half, half_sheet, whole_holds
from sim_core.garment.recipes.records import Clock, versions
from sim_core.garment.recipes.scarf import scarf_material
from sim_core.garment.recipes.schedule import LIMIT, UNTANGLE
from sim_core.garment.recipes.worn_solid import capped
from sim_core.garment.settled import Settled
from sim_core.weave import Weave, parameters_of, solve

__all__ = ["HELD", "PiboSettings", "field_under", "laid_along", "pibo_on_figure", "solids_under"]

HELD = Pose(58.0, 78.0)  # forearms forward, so that a scarf stays on them

FALLING = (
    Phase(0.12, (0.0, 0.0), 400.0, 1.0, "letting go"),
    Phase(0.28, (0.0, 2.0), 15.0, 1.0, "letting go"),
    Phase(0.52, (2.0, 9.81), 6.0, 1.0, "falling"),
    Phase(1.60, (9.81, 9.81), 2.5, 0.8, "swinging"),
    Phase(0.80, (9.81, 9.81), 6.0, 0.8, "settling"),
    Phase(0.80, (9.81, 9.81), 12.0, 0.8, "settling"),
)
# Then with more friction, on what lies beneath and of cloth on cloth.
SETTLING = (
    Phase(1.80, (9.81, 9.81), 7.0, 1.4, "coming to rest"),
    Phase(0.80, (9.81, 9.81), 12.0, 1.4, "coming to rest"),
)
# What is still tangled is left alone at last: taken apart in part, it would spring back frame by frame.
RESTING = (
    Phase(0.40, (9.81, 9.81), 30.0, 2.0, "coming to rest"),
    Phase(2.40, (9.81, 9.81), 80.0, 2.0, "at rest", rest=5e-6),
)

Phases = tuple[tuple[Phase, ...], ...]  # of each run; with the last alone nothing is taken apart in part


@dataclass(frozen=True)
class PiboSettings:
    """How the scarf is laid. Lengths in metres.

    robe: by how much the robe's surface is thickened; cell: of the distance field; reach: how far beyond the
    forearm the scarf falls; low: height of its middle behind, above the hip's mark.
    """

    robe: float = 0.004
    cell: float = 0.008
    reach: float = 0.075
    low: float = 0.02
    back: float = 0.22
    gap: float = 0.07
    arm: float = 0.18
    end: float = 0.24
    waves: float = 5.0
    clearance: float = 0.004
    shell: float = 0.0025
    spring: float = 0.03  # of the shell; softened later, stacked folds would sink through each other
    self_friction: tuple[float, ...] = (0.5, 0.7, 1.0)  # falling, settling, resting
    separation: float = 0.3  # of that speed, taken while resting, lest squeezed folds bounce in their shells


def pibo_on_figure(
    pattern: Pattern,
    weave: Weave,
    figure: Mannequin,
    *,
    beneath: Garment | None = None,
    pose: Pose = HELD,
    edge: float | None = None,
    seed: int = 0,
    settings: PiboSettings | None = None,
    phases: Phases = (FALLING, SETTLING, RESTING),
    progress: Callable[[float, str], None] | None = None,
    on_frame: Callable[[int, np.ndarray], None] | None = None,
    checkpoint: Path | None = None,
) -> Garment:
    """Drapes the pattern's strip, woven as `weave`, behind the figure and over its forearms.

    Equal inputs give equal bits on one machine. The pattern is one half of the strip (mirror = true), draped against
    its mirror image. beneath: a robe draped on the figure in the same pose. on_frame(index, positions (P, 3) of all
    pattern vertices) hears 25 frames a second; checkpoint: file to go on from. Raises SimCoreError where the strip is
    no half or too short.
    """
    if not pattern.panels or not pattern.mirror:
        raise SimCoreError(f"pattern {pattern.name}: pibo_on_figure needs one [[panel]] and mirror = true")
    s, step, clock = settings or PiboSettings(), pattern.step(edge), Clock()
    cloth = pattern.cloth(step)
    solids = solids_under(figure, pose, beneath)
    field = field_under(solids, s)
    clock.lap("field")
    path, forearm, accordion = laid_along(figure, pose, field, float(np.ptp(cloth.vertices[:, 0])), s)
    parameters = parameters_of(weave, solve(weave, particles=True))
    material, choices = scarf_material(parameters, float(np.ptp(cloth.vertices[:, 0])) / 2, step)
    half = half_sheet(cloth, cloth.closed, [material], *np.zeros((2, len(cloth.faces)), np.int32), even=True)
    start = half.gathered(swept(cloth.vertices, path, forearm, accordion, np.random.default_rng(seed)))
    clock.lap("laying")

    hooks = _Hooks(half, phases, progress, on_frame, checkpoint)
    worn = _draped(half, start, field, s, phases, hooks)
    clock.lap("drape")
    run = len(phases) - 1
    lying = _beneath(solids, field, s)
    settled = Settled(
        _contact(s, run, last=True), phases[-1][-1], whole_holds(_holds(half), half, cloth), lying
    )
    garment = _garment(pattern, weave, cloth, worn, half, {**asdict(material), "choices": choices}, settled)
    errors = pibo_errors(garment, solids) | {
        "rest_p99_m": worn.rest_p99,
        "rest_max_m": worn.rest_max,
        "mass_kg": 2 * float(half.sheet.mass[: half.real].sum()),
    }
    clock.lap("check")
    if progress:
        progress(1.0, "done")
    robe = beneath.digest() if beneath else None
    parts = [ENGINE_VERSION, pattern.to_dict(), weave.to_dict(), step, seed, asdict(s), asdict(pose), robe]
    parts += [repr(phases), figure.name, figure.vertices.sum(), len(figure.faces)]
    return garment.noted(
        recipe="pibo_on_figure",
        versions=versions(),
        inputs=hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:16],
        seed=seed,
        edge=step,
        pose=asdict(pose),
        settings=asdict(s),
        simulated=worn.frames / 25,
        substeps=worn.substeps,
        rollbacks=worn.rollbacks,
        seconds=clock.laps,
        errors=errors,
    )


Solid = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class _Hooks:
    """Who hears of the runs as if they were one, and where they are kept."""

    half: Half
    phases: Phases
    progress: Callable[[float, str], None] | None
    on_frame: Callable[[int, np.ndarray], None] | None
    checkpoint: Path | None

    def of(self, run: int, first: int) -> dict[str, Any]:
        """Keyword arguments of `drape` for one run whose first frame is number `first`."""
        seconds = [sum(phase.seconds for phase in phases) for phases in self.phases]
        before, own, whole = sum(seconds[:run]), seconds[run], sum(seconds)

        def told(share: float, label: str) -> None:
            assert self.progress is not None
            self.progress((before + share * own) / whole, label)

        def heard(index: int, x: np.ndarray) -> None:
            assert self.on_frame is not None
            left = x[self.half.number]
            self.on_frame(
                first + index, np.concatenate([left, left * np.array([-1.0, 1.0, 1.0], left.dtype)])
            )

        path, last = self.checkpoint, run == len(self.phases) - 1
        return {
            "progress": told if self.progress else None,
            "on_frame": heard if self.on_frame else None,
            "checkpoint": path and Checkpoint(path.with_name(f"{path.name}.{run}"), keep=not last),
        }

    def finished(self) -> None:
        """The checkpoints of all runs but the last are needed no longer."""
        for run in range(len(self.phases) - 1 if self.checkpoint else 0):
            assert self.checkpoint is not None
            self.checkpoint.with_name(f"{self.checkpoint.name}.{run}").unlink(missing_ok=True)


def _draped(
    half: Half, start: np.ndarray, field: DistanceField, s: PiboSettings, phases: Phases, hooks: _Hooks
) -> Drape:
    """All runs; frames and substeps of the result are those of all."""
    solid, holds, runs = field.solid(), _holds(half), []
    for run, course in enumerate(phases):
        contact = _contact(s, run, last=run == len(phases) - 1)
        runs.append(
            drape(
                half.sheet,
                runs[-1].positions if runs else start,
                course,
                velocities=runs[-1].velocities if runs else None,
                collider=solid,
                contact=contact,
                holds=holds,
                **hooks.of(run, sum(done.frames for done in runs)),
            )
        )
    hooks.finished()
    return replace(
        runs[-1],
        frames=sum(run.frames for run in runs),
        substeps=sum(run.substeps for run in runs),
        rollbacks=sum(run.rollbacks for run in runs),
    )


def _contact(s: PiboSettings, run: int, *, last: bool) -> Contact:
    """How the scarf touches in a run; with the last nothing is taken apart in part."""
    friction = s.self_friction[min(run, len(s.self_friction) - 1)]
    shell: dict[str, Any] = {"spring": s.spring, "self_friction": friction, "every": 2, "partly": not last}
    shell |= {"separation": s.separation} if last else {}
    return Contact(s.clearance, 0.5 * s.clearance, s.shell, speed_limit=2.5, untangle=UNTANGLE, **shell)


def _beneath(solids: dict[str, Solid], field: DistanceField, s: PiboSettings) -> Beneath:
    """Body and robe as both halves lie on them, with the nodes of the half's field and their mirror images."""
    surfaces = tuple(
        Surface(vertices, faces, thicker=s.robe if name == "robe" else 0.0)
        for name, (vertices, faces) in solids.items()
    )
    low, high = ([float(c) for c in corner] for corner in field.box())
    reach = s.cell * float(np.ceil(high[0] / s.cell))
    return Beneath(surfaces, cell=s.cell, box=((-reach, low[1], low[2]), (reach, high[1], high[2])))


def solids_under(figure: Mannequin, pose: Pose, beneath: Garment | None) -> dict[str, Solid]:
    """Closed meshes under the scarf: the posed body and, its openings capped, the robe."""
    solids = {"body": (figure.posed(pose.arm, pose.elbow), figure.faces)}
    if beneath is not None:
        solids["robe"] = capped(beneath.positions, beneath.faces)
    return solids


def field_under(solids: dict[str, Solid], s: PiboSettings, *, whole: bool = False) -> DistanceField:
    """min(body, robe - thickness) over the left half and a little of the right, or over both."""
    points = np.concatenate([vertices for vertices, _ in solids.values()])
    low = np.array(
        [float(points[:, 0].min()) - 0.10 if whole else -2 * s.cell, -0.05, float(points[:, 2].min()) - 0.15]
    )
    high = points.max(0) + [0.10, 0.06, 0.08]
    fields = [field_of(*solid, cell=s.cell, band=0.08, box=(low, high)) for solid in solids.values()]
    field = fields[0]
    for other in fields[1:]:
        field = united(field, other, thicker=s.robe)
    return field


def laid_along(
    figure: Mannequin, pose: Pose, field: DistanceField, length: float, s: PiboSettings
) -> tuple[np.ndarray, np.ndarray, Accordion]:
    """The path of the left half, the forearm and the section along the path, from the figure's landmarks."""
    marks = figure.landmarks(pose.arm, pose.elbow)
    elbow, wrist, hip, waist = (marks[name] for name in ("elbow_l", "wrist_l", "hip", "waist"))
    arm = elbow + 0.5 * (wrist - elbow)
    gap = 0.5 * (waist + elbow)
    knots = np.array(
        [
            [0.0, hip[1] + s.low, hip[2] - 0.16],
            [0.10, hip[1] + s.low + 0.02, hip[2] - 0.155],
            [0.20, hip[1] + 0.09, hip[2] - 0.09],
            [gap[0] + 0.01, elbow[1] - 0.06, gap[2] - 0.03],
            [arm[0] - 0.055, arm[1] + 0.03, arm[2] - 0.01],
            [arm[0] + 0.01, arm[1] + 0.075, arm[2]],
            [arm[0] + s.reach, arm[1] + 0.01, arm[2]],
            [arm[0] + s.reach + 0.01, arm[1] - 0.10, arm[2]],
        ]
    )
    room = np.array([0.05, 0.05, 0.05, 0.04, 0.04, 0.045, 0.05, 0.05])
    path = arranged_path(knots, field, room, length)
    top = float(np.argmax(path[:, 1])) * 0.005
    stations = (0.0, top - 0.28, top - 0.12, top - 0.04, top + 0.08, length)
    return path, wrist - elbow, Accordion(stations, (s.back, s.gap, s.gap, s.arm, s.arm, s.end), s.waves)


def _holds(half: Half) -> Holds:
    count = len(half.sheet.rest)
    low, high = np.full(count, -np.inf), np.full(count, np.inf)
    low[half.middle] = high[half.middle] = 0.0
    return Holds.of(count, low=low, high=high, slaves=half.slaves, limit=(1.0, LIMIT))


def _garment(
    pattern: Pattern,
    weave: Weave,
    cloth: Cloth,
    worn: Drape,
    half: Half,
    material: dict[str, Any],
    settled: Settled,
) -> Garment:
    own, both = worn.positions[half.number], cloth.mirrored()
    positions = np.zeros((int(both.closed.max()) + 1, 3))
    positions[both.closed] = np.concatenate([own, own * [-1.0, 1.0, 1.0]])
    return Garment(
        name=pattern.name,
        pattern=both.vertices,
        pattern_faces=both.faces,
        weld=both.closed,
        panel=both.panel,
        positions=positions,
        panels=both.names,
        dyes=tuple(panel.dye for panel in pattern.panels) * 2,
        cut=pattern.to_dict(),
        weave=weave.to_dict(),
        material=material,
        dye=pattern.dye,
        settled=settled,
    )


def pibo_errors(garment: Garment, solids: dict[str, Solid]) -> dict[str, Any]:
    """The figures a visitor may be told, all from `sim_core.metrics`, of both halves."""
    found = [metrics.penetration(garment.positions, garment.faces, *solid) for solid in solids.values()]
    strain = np.abs(metrics.area_strain(garment.rest_corners(), garment.positions, garment.faces))
    worn = garment.worn()
    half = len(worn) // 2
    return {
        "inside_vertices": sum(f.vertices for f in found),
        "inside_midpoints": sum(f.midpoints for f in found),
        "inside_centroids": sum(f.centroids for f in found),
        "clearance_m": [min(f.clearance[k] for f in found) for k in range(3)],
        "area_strain_p95": float(np.percentile(strain, 95)),
        "area_strain_max": float(strain.max()),
        "self_intersections": metrics.intersections(garment.positions, garment.faces),
        "asymmetry_m": float(np.linalg.norm(worn[half:] - worn[:half] * [-1.0, 1.0, 1.0], axis=1).max()),
    }
