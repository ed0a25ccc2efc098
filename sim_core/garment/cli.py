"""`simcore garment`: a pattern and a weave become a draped garment and its two GLB models."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim_core.validation.arguments import number, whole

if TYPE_CHECKING:
    import numpy as np

    from sim_core.body.pose import Pose
    from sim_core.body.wearer import Figure
    from sim_core.garment import Garment, Pattern
    from sim_core.garment.glb import Shown
    from sim_core.weave import Weave

HALL_FIGURE = 1800  # triangles of the figure in the hall's model

DESCRIPTION = """\
Drapes what PATTERN.toml cuts, woven as WEAVE.toml says, by a recipe, and writes to --out:

  garment.npz   rest mesh, drape, weave, material and provenance with measured errors
  close.glb     fine mesh, the weave's maps at true scale
  hall.glb      the cheapest mesh within --budget of the fine one, mean colour and a coarser relief
  garment.png   with --picture: the drape from three sides

The recipe scarf_on_stand lays a long strip over the bar of a dress stand; robe_on_figure sews the pattern's panels
on a mannequin (--mannequin) with its arms out, lowers them and lets the robe come to rest. Interrupted runs go on
where they stopped when the same command is given again.
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
    parser.add_argument("--recipe", choices=("scarf_on_stand", "robe_on_figure"), default="scarf_on_stand")
    parser.add_argument("--mannequin", type=Path, metavar="FIGURE.npz", help="who wears a robe_on_figure")
    parser.add_argument(
        "--arm", type=number(-10, 80, " degrees"), default=45.0, help="degrees its arms hang (default 45)"
    )
    parser.add_argument(
        "--elbow", type=number(0, 110, " degrees"), default=12.0, help="degrees its elbows bend (default 12)"
    )
    parser.add_argument(
        "--edge", type=number(0.0005, 0.2, " m"), help="mesh step in metres (default: the pattern's)"
    )
    parser.add_argument(
        "--seed", type=whole(0, 2**32 - 1), default=0, help="of the folds' irregularity (default 0)"
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument(
        "--budget", type=number(1e-6, 0.1, " m"), default=0.0013, help="hall model's p99 distance in metres"
    )
    parser.add_argument(
        "--pixels", type=whole(32, 4096), default=512, help="width of the weave maps (default 512)"
    )
    parser.add_argument("--picture", action="store_true", help="also draw the drape")
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")


def run(args: argparse.Namespace) -> int:
    """Runs the recipe and writes the files; returns the exit status."""
    from sim_core.garment import Pattern, choose_detail, write_glb
    from sim_core.weave import Weave, solve, surface_maps

    pattern, weave = Pattern.load(args.pattern), Weave.load(args.weave)
    worn_by = _figure(args)
    args.out.mkdir(parents=True, exist_ok=True)
    garment = _draped(args, pattern, weave, worn_by)
    maps = surface_maps(weave, solve(weave, particles=True), pixels=args.pixels)
    hall = choose_detail(garment, args.budget)
    garment.save(args.out / "garment.npz")
    sizes = {
        "close.glb": write_glb(
            args.out / "close.glb",
            garment,
            maps,
            precision="close",
            figure=_shown(worn_by, args, garment, None),
        ),
        "hall.glb": write_glb(
            args.out / "hall.glb",
            hall,
            maps,
            precision="hall",
            figure=_shown(worn_by, args, hall, HALL_FIGURE),
        ),
    }
    if args.picture:
        _draw(args.out / "garment.png", garment, worn_by and worn_by.mesh(_pose(args)))
    _report(args, garment, hall.provenance["detail"], sizes)
    return 0


def _pose(args: argparse.Namespace) -> Pose:
    from sim_core.body.pose import Pose

    return Pose.arms(args.arm, args.elbow)


def _figure(args: argparse.Namespace) -> Figure | None:
    """Who wears it, None for a recipe without a figure."""
    from sim_core.body.mannequin import Mannequin
    from sim_core.body.wearer import Figure
    from sim_core.errors import FileProblem, SimCoreError, WrongArgument

    if args.recipe != "robe_on_figure":
        return None
    if args.mannequin is None:
        raise WrongArgument(
            "--mannequin: robe_on_figure needs a figure – give mannequins/woman.npz or another"
        )
    figure = Figure(Mannequin.load(args.mannequin))
    try:
        figure.field(_pose(args))
    except SimCoreError as error:  # an open mesh, hands without points: told before the drape, with the file
        raise FileProblem(f"{args.mannequin}: {error}") from error
    return figure


def _draped(args: argparse.Namespace, pattern: Pattern, weave: Weave, figure: Figure | None) -> Garment:
    from sim_core.garment import robe_on_figure, scarf_on_stand
    from sim_core.garment.recipes.schedule import Schedule

    hooks: dict[str, Any] = {
        "edge": args.edge,
        "progress": None if args.json else _progress,
        "checkpoint": args.out / "drape.checkpoint",
    }
    if figure is None:
        return scarf_on_stand(pattern, weave, seed=args.seed, **hooks)
    return robe_on_figure(pattern, weave, figure, schedule=Schedule(_pose(args)), **hooks)


def _shown(
    figure: Figure | None, args: argparse.Namespace, garment: Garment, triangles: int | None
) -> Shown | None:
    from sim_core.garment.levels.figure import shown_figure

    if figure is None:
        return None
    return shown_figure(*figure.mesh(_pose(args)), garment.positions, garment.faces, triangles=triangles)


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
        f"  inside stand or figure {inside}, area strain p95 {e['area_strain_p95']:.2%}, "
        f"self-intersections {e['self_intersections']}, moving {e['rest_p99_m'] * 1e3:.3f} mm per 1/25 s (p99)",
        f"  hall: {level['triangles']} triangles, {sizes['hall.glb'] / 1e6:.2f} MB; "
        f"close: {len(garment.faces)} triangles, {sizes['close.glb'] / 1e6:.2f} MB",
        f"  seconds: {', '.join(f'{name} {value:.1f}' for name, value in facts['seconds'].items())}",
    ]
    sys.stdout.write("\n".join(lines) + "\n")


def _draw(path: Path, garment: Garment, figure: tuple[np.ndarray, np.ndarray] | None) -> None:
    """The garment on its stand or figure from the front, from the side and from behind."""
    import numpy as np

    from sim_core.body.stand import Stand
    from sim_core.garment.glb import LACQUER, LINEN
    from sim_core.picture import Camera, Surface, render, save_png

    sheer = figure is None
    surfaces = [Surface(*figure, LINEN)] if figure else []
    if "stand" in garment.provenance:
        surfaces.append(Surface(*Stand(**garment.provenance["stand"]).mesh(), LACQUER, gloss=0.25))
    dyes = [garment.dye_of(number) for number in range(len(garment.panels))]
    for dye in dict.fromkeys(dyes):
        faces = garment.faces[np.isin(garment.panel, [k for k, own in enumerate(dyes) if own == dye])]
        surfaces.append(
            Surface(
                garment.positions,
                faces,
                dye or (0.86, 0.82, 0.74),
                alpha=0.7 if sheer else 1.0,
                gloss=0.12,
                sheen=0.5,
                through=0.55 if sheer else 0.0,
            )
        )
    middle = (0.0, 0.825, 0.0)
    eyes = ((0.5, 1.25, 3.6), (2.9, 1.2, 2.0), (-1.4, 1.2, -3.2))
    pictures = [render(surfaces, Camera(eye, middle, 27), (520, 840)) for eye in eyes]
    save_png(path, np.concatenate(pictures, axis=1))
