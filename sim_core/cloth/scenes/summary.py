"""What comes of `simcore cloth`: the summary, the frames as npz and as a film."""

from __future__ import annotations

import argparse
import json
import os
import sys
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from sim_core.cloth.run.drape_run import Drape
    from sim_core.cloth.scenes.catalogue import Scene


def summary_of(
    args: argparse.Namespace, made: Scene, result: Drape, settings: dict[str, Any], penetrations: int
) -> dict[str, Any]:
    """The figures of a run by their names in --json; whoever timed it sets `seconds` and `compile_seconds`."""
    summary = {
        "scene": args.scene,
        "vertices": len(made.positions),
        "frames": result.frames,
        "seconds": 0.0,
        "compile_seconds": 0.0,
        "ms_per_frame": _middle(result.frame_seconds),
        "substeps": round(result.substeps / max(result.frames, 1), 1),
        "integrator": settings["integrator"],
        "precision": settings["precision"],
        "fallbacks": result.fallbacks,
        "worst_stretch": round(result.worst_stretch, 4),
        "penetrations": penetrations,
        "intersections": _crossed(made, result),
        "seed": args.seed,
    }
    if result.certificate is not None:
        told = asdict(result.certificate)
        spent = told.pop("seconds") / max(len(result.frame_seconds), 1)
        del told["intersections"]
        summary["certified"] = told | {"ms_per_frame": round(1e3 * spent, 2)}
    if settings.get("why"):
        summary["why"] = settings["why"]
    if args.scene == "drape":
        from sim_core.cloth.scenes.catalogue import drape_coefficient

        width = float(np.ptp(made.sheet.rest[:, 0]))
        coefficient = drape_coefficient(result.positions, made.sheet.faces, width)
        summary["drape_coefficient"] = round(coefficient, 4)
    return summary


def _middle(seconds: tuple[float, ...]) -> float | None:
    """The median [ms]; None where every frame was there already, in the state that was gone on from."""
    return round(1e3 * float(np.median(seconds)), 2) if seconds else None


def _crossed(made: Scene, result: Drape) -> int:
    """(edge, face) pairs that pass through each other at the end."""
    from sim_core.metrics import intersections

    if result.certificate is not None:
        return result.certificate.intersections
    return intersections(result.positions, made.sheet.faces)


def write(args: argparse.Namespace, made: Scene, film: list[np.ndarray], settings: dict[str, Any]) -> None:
    """--out and --video, whole or not at all."""
    if args.out and film:
        told = {
            k: v for k, v in vars(args).items() if k not in ("run", "out", "video", "resume", "json", "debug")
        }
        told |= {"material": asdict(made.sheet.material)} | settings
        beside = args.out.with_name(args.out.name + ".part")
        with beside.open("wb") as stream:
            np.savez(
                stream,
                positions=np.stack(film).astype(np.float32),
                faces=made.sheet.faces,
                uv=made.sheet.rest,
                pins=np.array(made.pins, np.int64),
                dt=np.array(1 / 25),
                settings=np.array(json.dumps(told)),
            )
        os.replace(beside, args.out)
    if args.video and film:
        from sim_core.cloth.scenes.film import write_film

        write_film(
            args.video,
            film,
            made.sheet.faces,
            around=np.concatenate(film[:: max(1, len(film) // 20)]),
            solid=made.solid,
        )


def tell(args: argparse.Namespace, summary: dict[str, Any]) -> None:
    """Prints the summary, as JSON or in a line."""
    if args.json:
        sys.stdout.write(json.dumps(summary, indent=2) + "\n")
        return
    s = summary
    line = f"{s['scene']}: {s['vertices']} vertices, {s['frames']} frames in {s['seconds']:.1f} s"
    pace = "all of them kept" if s["ms_per_frame"] is None else f"{s['ms_per_frame']:.1f} ms a frame (median)"
    line += f", {pace}, {s['substeps']:.0f} substeps, {s['integrator']}"
    line += f", stretch at most {s['worst_stretch']:.3f}, {s['penetrations']} penetrations"
    line += f", {s['intersections']} intersections"
    sys.stdout.write(line + "\n")
    if "drape_coefficient" in s:
        sys.stdout.write(f"drape coefficient {100 * s['drape_coefficient']:.1f} %\n")
    if "why" in s:
        sys.stdout.write(s["why"] + "\n")
