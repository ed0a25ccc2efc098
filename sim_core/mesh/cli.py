"""`simcore mesh`: a panel outline becomes a triangle mesh."""

import argparse
import json
import sys
import warnings
from pathlib import Path
from time import perf_counter

import numpy as np

from sim_core.errors import OutlineError, OutlineWarning, WrongArgument
from sim_core.mesh.files import mesh_picture, write_mesh, write_picture
from sim_core.mesh.outline.size_field import SizeField, read_size_field
from sim_core.mesh.panel import panel_mesh
from sim_core.metrics.compile_time import compile_clock
from sim_core.validation.arguments import ending, number

__all__ = ["add_parser", "run"]

DESCRIPTION = """\
Triangulate a pattern panel: equal steps along the outline that keep its corners, staggered points inside
(Eq. 1-8 of the paper), redundant points removed, growth triangulation (Eq. 9), and a check of the result.

The outline file is JSON in metres, y down; either direction, first point repeated or not:
  {"outline": [[0, 0], [0.6, 0], [0.6, 0.9], [0, 0.9]], "holes": [[[0.2, 0.2], [0.4, 0.2], [0.3, 0.4]]],
   "constraints": [[[0.1, 0], [0.1, 0.9]]]}
or a pattern sheet (.svg, .dxf, GarmentCode's .json, or a pattern file .toml) with one piece or many:
  --list                 name the pieces: layer or material, size in mm, holes, notches, grain; --picture draws them
  --piece NAME           the piece to mesh, where there are several
  --line cut|sew         along its cutting line (default) or its sewing line
  --allowance MM         where the sheet draws one of the two lines only, the other lies so far outside or inside it
  --layer NAME           only pieces of this layer or material (1, lining, ...)
  --units mm|cm|in|...   what a drawing unit is, where the sheet does not say or says it wrong
  --pattern FILE         the pieces as a pattern file (.toml) or for GarmentCode (.json), seams where the sheet has them
A line is what its layer, class or group says: AAMA and ASTM layer numbers, FreeSewing's classes, words such as "cut",
"seam", "notch", "grain". What says nothing is an outline where it is closed and outermost, a sewing line where it
follows an outline at the distance of an allowance, a hole where it lies in one, a fold or an inner line where it is
open: edges of the mesh follow those. What is no part of a piece (text, logos, scale boxes) is left out, and a line on
stderr names it.

--quality fair is the paper's method and nothing else; best adds a row of points along the outline, smoothing,
insertion and deletion. Where angles below 30 degrees are left, best puts points in and divides outline steps, so that
edges grade away from what is small there: all angles are 30 or more then, but those of corners that are sharper
themselves, and of slits so long and narrow that the mesh would have many times its points.
A size field is JSON {"points": [[x, y, size], ...], "gradation": 0.2}: the edge length is
the least of --edge and size + gradation x distance over its points.
The npz holds vertices (V, 2), faces (F, 3), boundary with boundary_start (one index loop per contour) and lines.

The summary states how good the mesh is:
  min_angle_deg       smallest angle of any triangle (60 = equilateral)
  quality             q = 4 sqrt(3) area / sum of squared edges, mean and worst (1 = equilateral)
  edge_ratio          shortest / longest edge of a triangle, mean and worst
  conformity          fraction of outline steps that are mesh edges (must be 1)
  area_error          relative to the polygon meshed (below 1e-12)
  outline_deviation   Hausdorff distance [m] between the given outline and the meshed one
  compile_seconds     machine code of the kernels, made once and cached; never part of seconds

examples:
  simcore mesh panel.json --edge 0.012 --out panel.ply --picture panel.png
  simcore mesh shirt.svg --list --picture shirt.png
  simcore mesh shirt.svg --piece sleeve --line sew --edge 0.01 --out sleeve.npz
  simcore mesh shirt.dxf --pattern shirt.toml --line sew
  simcore mesh beizi.toml --pattern beizi.json
"""


def add_parser(subparsers) -> None:
    """Describe the command to argparse."""
    parser = subparsers.add_parser(
        "mesh",
        help="panel outline -> triangle mesh",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "file", type=Path, metavar="OUTLINE", help="outline or sheet: .json, .svg, .dxf, .toml"
    )
    parser.add_argument(
        "--edge",
        type=number(1e-9, 1e6, " m"),
        metavar="M",
        help="length of a mesh edge [m]; may be left out with --list and --pattern (0.01)",
    )
    _add_sheet(parser)
    parser.add_argument(
        "--quality",
        choices=("fair", "best"),
        default="fair",
        help="fair: no smoothing (default); best: no small angle",
    )
    parser.add_argument("--size-field", type=Path, metavar="FILE", help="shorter edges by place (JSON)")
    parser.add_argument(
        "--threshold",
        type=number(0.5, 0.9),
        default=0.7,
        help="points nearer to the outline than this x edge are dropped (0.7)",
    )
    parser.add_argument(
        "--out", type=ending(".npz", ".ply", ".obj"), metavar="FILE", help="mesh file: .npz, .ply or .obj"
    )
    parser.add_argument(
        "--picture",
        type=ending(".png", ".jpg"),
        metavar="FILE",
        help="picture (.png, .jpg) of the mesh, coloured by quality, or of a sheet's pieces",
    )
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")


def _add_sheet(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("pattern sheets (.svg, .dxf, GarmentCode's .json)")
    group.add_argument("--list", action="store_true", help="name the pieces and mesh nothing")
    group.add_argument("--piece", metavar="NAME", help="the piece to mesh")
    group.add_argument("--line", choices=("cut", "sew"), default="cut", help="along which line (cut)")
    group.add_argument("--layer", metavar="NAME", help="pieces of this layer or material only")
    group.add_argument(
        "--allowance",
        type=number(0, 200, " mm"),
        default=0.0,
        metavar="MM",
        help="between cutting and sewing line where only one is drawn",
    )
    group.add_argument("--units", choices=("mm", "cm", "m", "in", "pt", "px"), help="what a drawing unit is")
    group.add_argument(
        "--pattern", type=ending(".toml", ".json"), metavar="FILE", help="write the pieces as .toml or .json"
    )


def run(args: argparse.Namespace) -> int:
    """Read, mesh, write; returns the exit status."""
    if args.list or args.pattern:
        from sim_core.mesh.sheets.command import run_sheet

        return run_sheet(args)
    if args.edge is None:
        raise WrongArgument("--edge: missing – give the length of a mesh edge in metres, such as --edge 0.01")
    drawing, read = _drawing(args)
    sizes = read_size_field(args.size_field) if args.size_field else None
    with compile_clock(_tell_compiling):
        warm = _warm_up(args.quality, graded=sizes is not None)
        mesh, told = _meshed(args, drawing, sizes)
    for warning in [*read, *told]:
        sys.stderr.write(f"simcore mesh: {args.file}: {warning.message}\n")
    if args.out:
        write_mesh(args.out, mesh)
    if args.picture:
        write_picture(args.picture, mesh_picture(mesh))
    summary = _summary(mesh, warm + mesh.report.compile_seconds)
    sys.stdout.write((json.dumps(summary, indent=2) if args.json else _text(args.file, summary)) + "\n")
    return 0


def _meshed(args: argparse.Namespace, drawing, sizes):
    """The mesh, and the warnings that came with it."""
    try:
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always", OutlineWarning)
            mesh = panel_mesh(
                drawing.outline,
                edge=args.edge,
                holes=drawing.holes,
                constraints=drawing.constraints,
                sizes=sizes,
                threshold=args.threshold,
                quality=args.quality,
            )
    except OutlineError as error:
        raise OutlineError(f"{args.file}: {error}") from error
    return mesh, told


def _tell_compiling() -> None:
    sys.stderr.write("simcore mesh: making machine code, once; the next run has it ready\n")


def _drawing(args: argparse.Namespace) -> tuple:
    """What is to be meshed, and the warnings of its reader."""
    from sim_core.mesh.sheets.outline_file import drawing_of, read_outline
    from sim_core.mesh.sheets.reading import Choice, sheet_of_code

    choice = Choice(args.piece, args.line, args.layer, args.allowance / 1000)
    with warnings.catch_warnings(record=True) as read:
        warnings.simplefilter("always", OutlineWarning)
        if args.file.suffix.lower() == ".toml":
            sheet = sheet_of_code(args.file, args.pattern_code(args.file), args.layer)
            return drawing_of(args.file, sheet, choice), read
        return read_outline(args.file, choice, args.units), read


def _warm_up(quality: str, *, graded: bool) -> float:
    """Load or compile every kernel on a small panel, so that `seconds` is the work alone."""
    begin = perf_counter()
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    line = [[0.2, 0.1], [0.2, 0.9]]
    field = SizeField(np.zeros((1, 2)), np.array([0.05])) if graded else None
    panel_mesh(square, edge=0.1, holes=[square / 3 + 0.4], constraints=[line], quality=quality, sizes=field)
    return perf_counter() - begin


def _summary(mesh, compile_seconds: float) -> dict:
    report = mesh.report
    return {
        "vertices": len(mesh.vertices),
        "faces": len(mesh.faces),
        "seconds": report.seconds,
        "compile_seconds": compile_seconds,
        "min_angle_deg": report.min_angle_deg,
        "quality": {"mean": report.mean_quality, "worst": report.worst_quality},
        "edge_ratio": {"mean": report.mean_edge_ratio, "worst": report.worst_edge_ratio},
        "conformity": report.conformity,
        "area_error": report.area_error,
        "outline_deviation": report.outline_deviation,
    }


def _text(path: Path, summary: dict) -> str:
    return (
        f"{path}: {summary['vertices']} vertices, {summary['faces']} faces in {summary['seconds'] * 1e3:.1f} ms "
        f"(kernels {summary['compile_seconds']:.1f} s)\n"
        f"  smallest angle {summary['min_angle_deg']:.1f} degrees, quality mean {summary['quality']['mean']:.4f} worst "
        f"{summary['quality']['worst']:.3f}, edge ratio mean {summary['edge_ratio']['mean']:.4f}\n"
        f"  conformity {summary['conformity']:.0%}, area error {summary['area_error']:.1e}, outline deviation "
        f"{summary['outline_deviation'] * 1e3:.3f} mm"
    )
