"""The recipe `scarf_on_stand`: a gauze scarf (披帛) laid over the bar of a dress stand."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from sim_core import metrics
from sim_core.body import Beneath
from sim_core.body.stand import Stand
from sim_core.cloth import Contact, Drape, Holds, Material, Phase, Sheet, drape
from sim_core.cloth.run.drape_run import ENGINE_VERSION
from sim_core.errors import SimCoreError
from sim_core.garment.garment import Garment
from sim_core.garment.pattern.pattern import Pattern
from sim_core.garment.placement.over_bar import Gathering, gathered_strip
from sim_core.garment.recipes.records import Clock, versions
from sim_core.garment.recipes.schedule import GRAVITY, LIMIT, UNTANGLE
from sim_core.garment.settled import Settled
from sim_core.weave import ClothParameters, Weave, parameters_of, solve

SAG = 0.005  # strain at the bar under the hanging end's own weight; more stretch than this would be seen
PHASES = (
    Phase(0.08, (0.0, 0.0), 400.0, 1.0, "letting go"),
    Phase(0.28, (0.0, 2.0), 15.0, 1.0, "letting go"),
    Phase(0.60, (2.0, 9.81), 5.0, None, "falling"),
    Phase(1.40, (9.81, 9.81), 3.0, None, "swinging"),
    # 6 1/s is about critical for a metre of hanging cloth: quicker to rest than more or less.
    Phase(2.00, (9.81, 9.81), 6.0, None, "settling", rest=5e-5),
)


def scarf_on_stand(
    pattern: Pattern,
    weave: Weave,
    *,
    edge: float | None = None,
    seed: int = 0,
    stand: Stand | None = None,
    gathering: Gathering | None = None,
    phases: tuple[Phase, ...] = PHASES,
    progress: Callable[[float, str], None] | None = None,
    on_frame: Callable[[int, np.ndarray], None] | None = None,
    checkpoint: Path | None = None,
) -> Garment:
    """Drapes the pattern's strip, woven as `weave`, over the stand's bar; equal inputs give equal bits on one machine.

    edge: mesh step [m], None: the pattern's own; on_frame(index, positions (V, 3) float32) hears 25 frames a second;
    checkpoint: file to go on from. Raises SimCoreError where the strip does not fit the stand.
    """
    stand, step = stand or Stand(), pattern.step(edge)
    width = float(np.ptp(pattern.outline[:, 0]))
    gathering = gathering or Gathering().resolved(width, step)
    _check_fits(pattern, stand, gathering)
    clock = Clock()
    panel = pattern.mesh(step)
    clock.lap("mesh")
    parameters = parameters_of(weave, solve(weave, particles=True))
    material, choices = scarf_material(parameters, gathering.front, step)
    clock.lap("weave")
    sheet = Sheet.of(panel.vertices, panel.faces, material)
    start = gathered_strip(panel.vertices, stand.height, gathering, np.random.default_rng(seed))
    solid, contact = stand.collider(), scarf_contact(step, stand.bar_radius)
    hooks: dict[str, Any] = {"progress": progress, "on_frame": on_frame, "checkpoint": checkpoint}
    holds = Holds.of(len(start), limit=(1.0, LIMIT))
    result = drape(sheet, start, phases, collider=solid, contact=contact, holds=holds, **hooks)
    clock.lap("drape")
    errors = _measured(sheet, result, stand)
    clock.lap("check")
    if progress:
        progress(1.0, "done")
    facts = {
        "inputs": _hash(pattern, weave, step, seed, stand, gathering, phases, contact),
        "seed": seed,
        "edge": step,
        "stand": asdict(stand),
        "gathering": asdict(gathering),
        "seconds": clock.laps,
        "errors": errors,
    }
    material_facts = {**asdict(material), "choices": choices, "provenance": dict(parameters.provenance)}
    settled = Settled(contact, phases[-1], holds, Beneath(stand=stand), even=False)
    return _garment(pattern, weave, sheet, result, material_facts, settled).noted(**facts)


def _garment(
    pattern: Pattern,
    weave: Weave,
    sheet: Sheet,
    result: Drape,
    material: dict[str, Any],
    settled: Settled,
) -> Garment:
    solver = {"simulated": result.frames / 25, "substeps": result.substeps, "rollbacks": result.rollbacks}
    return Garment(
        name=pattern.name,
        pattern=sheet.rest,
        pattern_faces=sheet.faces,
        weld=np.arange(len(sheet.rest), dtype=np.int32),
        panel=np.zeros(len(sheet.faces), np.int32),
        positions=result.positions,
        cut=pattern.to_dict(),
        weave=weave.to_dict(),
        material=material,
        provenance={"recipe": "scarf_on_stand", "versions": versions(), **solver},
        dye=pattern.dye,
        settled=settled,
    )


def scarf_material(
    parameters: ClothParameters, hanging: float, edge: float
) -> tuple[Material, dict[str, str]]:
    """The weave's material as far as the scene needs it, and what was simplified, in words.

    hanging: longest free length [m]; edge: mesh step [m]. Silk hardly stretches, and a solver that resolved
    its true stiffness would spend its time on strains of 1e-5; stiffness is lowered until the cloth's own
    weight strains it by SAG. Bending takes the lower bound, fibres free to slide (degummed silk), but no
    less than the mesh resolves: (B / rho g)^(1/3) >= 1.15 edge, below which folds look like crumpled paper.
    """
    density = float(parameters.density)
    enough = density * GRAVITY * hanging / SAG
    stretch = [min(float(k), enough) for k in (parameters.stretch_weft, parameters.stretch_warp)]
    free = [float(parameters.bounds[name][0]) for name in ("bend_warp", "bend_weft")]
    resolved = density * GRAVITY * (1.15 * edge) ** 3
    material = Material(
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
    choices = {
        "stretch": f"{stretch[0]:.0f} N/m instead of {parameters.stretch_weft:.0f}: {SAG:.1%} strain at the bar",
        "bend": f"lower bounds, warp {free[0]:.2e} and weft {free[1]:.2e} N m (fibres free), at least {resolved:.2e} "
        f"for a {edge * 1e3:.0f} mm mesh",
        "poisson": f"{material.poisson:.2f} instead of {parameters.poisson:.2f}: crimp interchange needs tension",
    }
    return material, choices


def scarf_contact(edge: float, bar_radius: float) -> Contact:
    """Clearance of the vertices such that chords and centroids of the mesh stay off the round bar."""
    sagitta = edge * edge / (6 * bar_radius)  # centroids lie lower than midpoints: L^2 / 6R against L^2 / 8R
    return Contact(0.0012 + sagitta, 0.0008, 0.003, speed_limit=2.5, untangle=UNTANGLE)


def _check_fits(pattern: Pattern, stand: Stand, gathering: Gathering) -> None:
    width, length = (float(s) for s in np.ptp(pattern.outline, axis=0))
    longest = max(gathering.front, length - gathering.front)
    if not 0.1 < gathering.front < length - 0.1:
        raise SimCoreError(
            f"pattern {pattern.name}: {length:.2f} m long – needs more than front {gathering.front} + 0.1 m"
        )
    if longest > stand.height - 0.05:
        raise SimCoreError(
            f"pattern {pattern.name}: an end of {longest:.2f} m touches the floor – raise the stand's bar"
        )
    if max(gathering.at_bar, gathering.at_end) > stand.span - 0.1 or gathering.at_end > width:
        raise SimCoreError(
            f"pattern {pattern.name}: gathered to {gathering.at_end} m – between stand and cloth width"
        )


def _measured(sheet: Sheet, result: Drape, stand: Stand) -> dict[str, Any]:
    """The figures a visitor may be told, all from `sim_core.metrics`."""
    solid_vertices, solid_faces = stand.mesh(48)
    inside = metrics.penetration(result.positions, sheet.faces, solid_vertices, solid_faces)
    strain = np.abs(metrics.area_strain(sheet.rest, result.positions, sheet.faces))
    return {
        "inside_vertices": inside.vertices,
        "inside_midpoints": inside.midpoints,
        "inside_centroids": inside.centroids,
        "clearance_m": list(inside.clearance),
        "area_strain_p95": float(np.percentile(strain, 95)),
        "area_strain_max": float(strain.max()),
        "rest_p99_m": result.rest_p99,
        "rest_max_m": result.rest_max,
        "self_intersections": metrics.intersections(result.positions, sheet.faces),
        "mass_kg": float(sheet.mass.sum()),
    }


def _hash(pattern: Pattern, weave: Weave, edge: float, seed: int, *settings: object) -> str:
    parts = [pattern.outline.tolist(), pattern.dye, weave.to_dict(), edge, seed, [repr(s) for s in settings]]
    text = json.dumps([ENGINE_VERSION, *parts], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
