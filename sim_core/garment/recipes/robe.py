"""The recipe `robe_on_figure` as a whole: dressed, measured, told as a Garment."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from sim_core import metrics
from sim_core.body.pose import Pose
from sim_core.cloth.run.drape_run import ENGINE_VERSION
from sim_core.errors import SimCoreError
from sim_core.garment.garment import Garment
from sim_core.garment.pattern.pattern import Pattern
from sim_core.garment.recipes.dressing import FigureLike, Worn, dress
from sim_core.garment.recipes.records import Clock, versions
from sim_core.garment.recipes.schedule import Schedule
from sim_core.weave import Weave

__all__ = ["robe_on_figure"]


def robe_on_figure(
    pattern: Pattern,
    weave: Weave,
    figure: FigureLike,
    *,
    edge: float | None = None,
    schedule: Schedule | None = None,
    progress: Callable[[float, str], None] | None = None,
    on_frame: Callable[[int, np.ndarray, Pose], None] | None = None,
    checkpoint: Path | None = None,
) -> Garment:
    """Dresses the figure in the pattern's panels, woven as `weave`; equal inputs give equal bits on one machine.

    The pattern is one half (mirror = true): it is dressed against its own mirror image, so that the robe hangs alike
    on both sides and neither front passes the middle. on_frame(index, positions (P, 3) of all pattern vertices, pose)
    hears 25 frames a second; checkpoint: file to go on from. Raises SimCoreError where the pattern is no half.
    """
    if not pattern.panels or not pattern.mirror:
        raise SimCoreError(f"pattern {pattern.name}: robe_on_figure needs [[panel]] tables and mirror = true")
    schedule, step, clock = schedule or Schedule(), pattern.step(edge), Clock()
    busy = time.process_time()

    def heard(index: int, half: np.ndarray, pose: Pose) -> None:
        assert on_frame is not None
        on_frame(index, np.concatenate([half, half * [-1.0, 1.0, 1.0]]), pose)

    worn = dress(
        pattern,
        weave,
        figure,
        edge=step,
        timing=schedule,
        progress=progress and (lambda share, label: progress(0.94 * share, label)),
        on_frame=heard if on_frame else None,
        checkpoint=checkpoint,
    )
    clock.lap("drape")
    clock.laps["drape_cpu"] = round(time.process_time() - busy, 2)
    garment = _garment(pattern, weave, worn).noted(edge=step)
    if progress:
        progress(0.95, "checking")
    errors = robe_errors(garment, *figure.mesh(schedule.pose))
    errors |= {
        "seam_gap_sewn_m": worn.gap,
        "rest_p99_m": worn.runs[-1].rest_p99,
        "rest_max_m": worn.runs[-1].rest_max,
        "mass_kg": 2 * float(worn.half.sheet.mass[: worn.half.real].sum()),
    }
    clock.lap("check")
    if progress:
        progress(1.0, "done")
    parts = [ENGINE_VERSION, pattern.to_dict(), weave.to_dict(), step, _told(schedule), figure.name]
    return garment.noted(
        recipe="robe_on_figure",
        versions=versions(),
        inputs=hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:16],
        schedule=_told(schedule),
        figure=figure.name,
        simulated=sum(run.frames for run in worn.runs) / 25,
        substeps=sum(run.substeps for run in worn.runs),
        rollbacks=sum(run.rollbacks for run in worn.runs),
        seconds=clock.laps,
        errors=errors,
    )


def _told(schedule: Schedule) -> dict[str, Any]:
    """The schedule as a table of plain values."""
    return asdict(schedule) | {"pose": schedule.pose.table()}


def robe_errors(garment: Garment, figure_vertices: np.ndarray, figure_faces: np.ndarray) -> dict[str, Any]:
    """The figures a visitor may be told, all from `sim_core.metrics`, of both halves."""
    inside = metrics.penetration(garment.positions, garment.faces, figure_vertices, figure_faces)
    strain = np.abs(metrics.area_strain(garment.rest_corners(), garment.positions, garment.faces))
    worn = garment.worn()
    half = len(worn) // 2
    return {
        "inside_vertices": inside.vertices,
        "inside_midpoints": inside.midpoints,
        "inside_centroids": inside.centroids,
        "clearance_m": list(inside.clearance),
        "area_strain_p95": float(np.percentile(strain, 95)),
        "area_strain_max": float(strain.max()),
        "self_intersections": metrics.intersections(garment.positions, garment.faces),
        "seam_gap_m": _seam_gap(Pattern.from_dict(garment.cut), garment),
        "asymmetry_m": float(np.linalg.norm(worn[half:] - worn[:half] * [-1.0, 1.0, 1.0], axis=1).max()),
    }


def _seam_gap(pattern: Pattern, garment: Garment) -> float:
    """Largest distance [m] between the two sides of any seam of the left half, as draped."""
    cloth, worn = pattern.cloth(garment.provenance["edge"]), garment.worn()
    gaps = [0.0]
    for seam in pattern.seams:
        a = cloth.along(seam.a, pattern.panel(seam.a.panel))
        b = a + len(cloth.vertices) if seam.b is None else cloth.along(seam.b, pattern.panel(seam.b.panel))
        gaps.append(float(np.linalg.norm(worn[a] - worn[b], axis=1).max()))
    return max(gaps)


def _garment(pattern: Pattern, weave: Weave, worn: Worn) -> Garment:
    cloth = worn.cloth.mirrored()
    x = np.concatenate([worn.positions, worn.positions * [-1.0, 1.0, 1.0]])
    positions = np.zeros((int(cloth.closed.max()) + 1, 3))
    positions[cloth.closed] = x
    single, doubled = (asdict(material) for material in worn.materials)
    return Garment(
        name=pattern.name,
        pattern=cloth.vertices,
        pattern_faces=cloth.faces,
        weld=cloth.closed,
        panel=cloth.panel,
        positions=positions,
        panels=cloth.names,
        dyes=tuple(panel.dye for panel in pattern.panels) * 2,
        cut=pattern.to_dict(),
        weave=weave.to_dict(),
        material={**single, "doubled": doubled, "choices": worn.choices},
        dye=pattern.dye,
        settled=worn.settled,
    )
