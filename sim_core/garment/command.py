"""`simcore garment`: a pattern and a weave become a draped garment and its two GLB models."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim_core.garment.model import Garment

DESCRIPTION = """\
Drapes the panel of PATTERN.toml, woven as WEAVE.toml says, by a recipe, and writes to --out:

  garment.npz   rest mesh, drape, weave, material and provenance with measured errors
  close.glb     fine mesh, the weave's maps at true scale
  hall.glb      the cheapest mesh within --budget of the fine one, mean colour and a coarser relief
  garment.png   with --picture: the drape from three sides

The recipe scarf_on_stand lays a long strip over the bar of a dress stand. Interrupted runs go on where they
stopped when the same command is given again.
"""


def add_parser(subparsers: Any) -> None:
    """Adds `garment` to the parsers of `simcore`."""
    parser = subparsers.add_parser(
        "garment",
        help="drape a garment and write its models",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("pattern", type=Path, metavar="PATTERN.toml")
    parser.add_argument("--weave", type=Path, required=True, metavar="WEAVE.toml")
    parser.add_argument("--recipe", choices=("scarf_on_stand",), default="scarf_on_stand")
    parser.add_argument("--edge", type=float, help="mesh step in metres (default: the pattern's)")
    parser.add_argument("--seed", type=int, default=0, help="of the folds' irregularity (default 0)")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--budget", type=float, default=0.0013, help="hall model's p99 distance in metres")
    parser.add_argument("--pixels", type=int, default=512, help="width of the weave maps (default 512)")
    parser.add_argument("--picture", action="store_true", help="also draw the drape")
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")


def run(args: argparse.Namespace) -> int:
    """Runs the recipe and writes the files; returns the exit status."""
    from sim_core.garment import Pattern, choose_detail, scarf_on_stand, write_glb
    from sim_core.weave import Weave, relax, texture_maps

    pattern, weave = Pattern.load(args.pattern), Weave.load(args.weave)
    args.out.mkdir(parents=True, exist_ok=True)
    garment = scarf_on_stand(
        pattern,
        weave,
        edge=args.edge,
        seed=args.seed,
        progress=None if args.json else _progress,
        checkpoint=args.out / "drape.checkpoint",
    )
    maps = texture_maps(weave, relax(weave), pixels=args.pixels)
    hall = choose_detail(garment, args.budget)
    garment.save(args.out / "garment.npz")
    sizes = {
        "close.glb": write_glb(args.out / "close.glb", garment, maps, precision="close"),
        "hall.glb": write_glb(args.out / "hall.glb", hall, maps, precision="hall"),
    }
    if args.picture:
        _draw(args.out / "garment.png", garment)
    _report(args, garment, hall.provenance["detail"], sizes)
    return 0


def _progress(fraction: float, label: str) -> None:
    sys.stderr.write(f"\r{100 * fraction:5.1f} %  {label:<12}" + ("\n" if fraction >= 1 else ""))
    sys.stderr.flush()


def _report(args: argparse.Namespace, garment: Garment, level: dict[str, Any], sizes: dict[str, int]) -> None:
    facts = {key: garment.provenance[key] for key in ("seconds", "simulated", "substeps", "errors", "inputs")}
    if args.json:
        summary = {"out": str(args.out), "digest": garment.digest(), "bytes": sizes, "hall": level, **facts}
        sys.stdout.write(json.dumps(summary, indent=2) + "\n")
        return
    e = facts["errors"]
    inside = e["inside_vertices"] + e["inside_midpoints"] + e["inside_centroids"]
    lines = [
        f"{garment.name}: {len(garment.positions)} vertices, {len(garment.faces)} triangles -> {args.out}",
        f"  inside the stand {inside}, area strain p95 {e['area_strain_p95']:.2%}, "
        f"self-intersections {e['self_intersections']}, moving {e['rest_p99_m'] * 1e3:.3f} mm per 1/25 s (p99)",
        f"  hall: {level['triangles']} triangles, {sizes['hall.glb'] / 1e6:.2f} MB; "
        f"close: {len(garment.faces)} triangles, {sizes['close.glb'] / 1e6:.2f} MB",
        f"  seconds: {', '.join(f'{name} {value:.1f}' for name, value in facts['seconds'].items())}",
    ]
    sys.stdout.write("\n".join(lines) + "\n")


def _draw(path: Path, garment: Garment) -> None:
    """The garment on its stand from the front, from the side and from behind."""
    import numpy as np

    from sim_core.garment.glb import LACQUER
    from sim_core.garment.stand import Stand
    from sim_core.picture import Camera, Surface, render, save_png

    stand = Stand(**garment.provenance["stand"])
    colour = garment.dye or (0.86, 0.82, 0.74)
    surfaces = [
        Surface(*stand.mesh(), LACQUER, gloss=0.25),
        Surface(garment.positions, garment.faces, colour, alpha=0.7, gloss=0.12, sheen=0.5, through=0.55),
    ]
    middle = (0.0, 0.55 * stand.height, 0.0)
    eyes = ((0.5, 1.25, 3.6), (2.9, 1.2, 2.0), (-1.4, 1.2, -3.2))
    pictures = [render(surfaces, Camera(eye, middle, 27), (520, 840)) for eye in eyes]
    save_png(path, np.concatenate(pictures, axis=1))
