"""`simcore cloth`: runs a small named scene and saves where the cloth came to lie."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sim_core.arguments import number

if TYPE_CHECKING:
    from sim_core.cloth.scenes import Scene

DESCRIPTION = """\
Simulates small named scenes with the explicit edge-tension solver.

  hang   a 1 x 1 m sheet let go with one edge pinned
  bar    a 0.3 x 0.8 m sheet dropped on a round bar, with friction and self-contact

Each writes SCENE.npz (rest, faces, positions) to --out and, with --picture, SCENE.png.
"""


def add_parser(subparsers: Any) -> None:
    """Adds `cloth` to the parsers of `simcore`."""
    parser = subparsers.add_parser(
        "cloth",
        help="simulate small cloth scenes",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("scenes", nargs="+", choices=("hang", "bar"), metavar="SCENE", help="hang or bar")
    parser.add_argument(
        "--edge", type=number(0.001, 0.25, " m"), help="mesh step in metres (default: the scene's own)"
    )
    parser.add_argument(
        "--seconds", type=number(0.04, 600, " s"), help="simulated time (default: the scene's own)"
    )
    parser.add_argument("--out", type=Path, default=Path("."), help="folder for the results (default: here)")
    parser.add_argument("--picture", action="store_true", help="also draw the end state")
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")


def run(args: argparse.Namespace) -> int:
    """Runs the named scenes; returns the exit status."""
    from sim_core.cloth.scenes import SCENES

    step = () if args.edge is None else (args.edge,)
    scenes = {name: SCENES[name](*step) for name in args.scenes}
    args.out.mkdir(parents=True, exist_ok=True)  # refused before the work, not after it
    summaries = [_run_scene(name, scene, args) for name, scene in scenes.items()]
    if args.json:
        sys.stdout.write(json.dumps(summaries, indent=2) + "\n")
    else:
        for s in summaries:
            line = f"{s['scene']}: {s['vertices']} vertices, {s['simulated']:.2f} s in {s['seconds']:.1f} s"
            sys.stdout.write(
                f"{line}, {s['substeps']} substeps, rest p99 {s['rest_p99_m'] * 1e3:.3f} mm/frame\n"
            )
    return 0


def _run_scene(name: str, scene: Scene, args: argparse.Namespace) -> dict[str, Any]:
    from sim_core import metrics
    from sim_core.cloth.draping import drape

    phases = scene.phases if args.seconds is None else (replace(scene.phases[0], seconds=args.seconds),)
    result = drape(
        scene.sheet, scene.positions, phases, collider=scene.collider, contact=scene.contact, pins=scene.pins
    )
    target = args.out / f"{name}.npz"
    np.savez_compressed(target, rest=scene.sheet.rest, faces=scene.sheet.faces, positions=result.positions)
    if args.picture:
        _draw(args.out / f"{name}.png", result.positions, scene.sheet.faces)
    strain = np.abs(metrics.area_strain(scene.sheet.rest, result.positions, scene.sheet.faces))
    return {
        "scene": name,
        "file": str(target),
        "vertices": len(scene.sheet.rest),
        "triangles": len(scene.sheet.faces),
        "simulated": result.frames / 25,
        "substeps": result.substeps,
        "rollbacks": result.rollbacks,
        "seconds": result.seconds,
        "rest_p99_m": result.rest_p99,
        "area_strain_p95": float(np.percentile(strain, 95)),
        "self_intersections": metrics.intersections(result.positions, scene.sheet.faces),
    }


def _draw(path: Path, positions: np.ndarray, faces: np.ndarray) -> None:
    from sim_core.picture import Camera, Surface, render, save_png

    middle, reach = positions.mean(0), float(np.ptp(positions, axis=0).max())
    eye = middle + np.array([0.5, 0.35, 1.0]) * 2.2 * reach
    camera = Camera((eye[0], eye[1], eye[2]), (middle[0], middle[1], middle[2]), 32)
    save_png(path, render([Surface(positions, faces, (0.55, 0.66, 0.72), sheen=0.3)], camera, (800, 600)))
