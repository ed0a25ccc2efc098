"""`simcore weave`: a weave file becomes texture maps and parameters."""

import argparse
import json
import sys
from pathlib import Path
from time import perf_counter

from sim_core.arguments import whole

__all__ = ["add_parser", "run"]

DESCRIPTION = """\
Relax the yarns of a weave and draw it.

The weave file (TOML, see assets/weaves) states draft, yarns and sett in SI units. The yarn heights of one repeat
are brought into force balance (beams with contact, periodic), then drawn as tileable maps, and homogenised into
the parameters a cloth solver needs.

With --out DIR these files are written:
  albedo.png normal.png height.png opacity.png   tileable maps; normal as glTF has it (y up the picture)
  lit.png                                        a lit picture of 2 x 2 tiles, to look at
  parameters.json                                cloth parameters with units, bounds and the formula of each

example:
  simcore weave assets/weaves/gauze.toml --out gauze --pixels 1024
"""

UNITS = {
    "density": "kg/m2",
    "thickness": "m",
    "stretch_warp": "N/m",
    "stretch_weft": "N/m",
    "shear": "N/m",
    "poisson": "1",
    "bend": "N m",
    "bend_warp": "N m",
    "bend_weft": "N m",
    "friction": "1",
}


def add_parser(subparsers) -> None:
    """Describe the command to argparse."""
    parser = subparsers.add_parser(
        "weave",
        help="weave file -> texture maps and cloth parameters",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE.toml", help="weave file")
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder for the maps and parameters.json")
    parser.add_argument(
        "--pixels", type=whole(32, 4096), default=512, help="width and height of the maps (default 512)"
    )
    parser.add_argument(
        "--seed", type=whole(0, 2**32 - 1), default=0, help="of the yarns' irregularity (default 0)"
    )
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")


def run(args: argparse.Namespace) -> int:
    """Relax, draw and write; returns the exit status."""
    from sim_core.weave import Weave, cloth_parameters, relax, texture_maps

    weave = Weave.load(args.file)
    if args.out:
        args.out.mkdir(parents=True, exist_ok=True)  # refused before the work, not after it
    begin = perf_counter()
    geometry = relax(weave)
    seconds = {"relax": perf_counter() - begin}
    parameters = cloth_parameters(weave, geometry)
    begin = perf_counter()
    maps = texture_maps(weave, geometry, pixels=args.pixels, seed=args.seed) if args.out else None
    seconds["maps"] = perf_counter() - begin
    summary = _summary(weave, geometry, parameters, maps, seconds)
    if maps is not None:
        _write(args.out, maps, summary)
    text = json.dumps(summary, ensure_ascii=False, indent=2) if args.json else _text(summary, args.out)
    sys.stdout.write(text + "\n")
    return 0


def _summary(weave, geometry, parameters, maps, seconds) -> dict:
    values = parameters.to_dict()
    summary = {
        "weave": weave.name,
        "draft": weave.draft.name,
        "face": weave.draft.face,
        "openness": weave.openness,
        "crimp_warp": float(geometry.warp_crimp.mean()),
        "crimp_weft": float(geometry.weft_crimp.mean()),
        "residual": geometry.residual,
        "penetration": geometry.penetration,
        "seconds": seconds,
        "parameters": {key: values[key] for key in UNITS},
        "units": UNITS,
        "bounds": {key: list(bound) for key, bound in values["bounds"].items()},
        "provenance": values["provenance"],
    }
    if maps is not None:
        summary["tile"] = {
            "pixels": len(maps.height),
            "size": list(maps.size),
            "relief": maps.relief,
            "seam": maps.seam,
            "cover": float(maps.opacity.mean() / 255),
        }
    return summary


def _write(folder: Path, maps, summary: dict) -> None:
    from PIL import Image

    from sim_core.weave.drawing import lit_picture

    pictures = {name: getattr(maps, name) for name in ("albedo", "normal", "height", "opacity")}
    pictures["lit"] = lit_picture(maps, tiles=2)
    for name, picture in pictures.items():
        Image.fromarray(picture).save(folder / f"{name}.png")
    (folder / "parameters.json").write_text(json.dumps(summary, ensure_ascii=False, indent=2) + "\n", "utf-8")


def _text(summary: dict, out: Path | None) -> str:
    lines = [
        f"{summary['weave']}: {summary['draft']}, {summary['face']} face, {summary['openness']:.0%} open, crimp "
        f"{summary['crimp_warp']:.2%} warp {summary['crimp_weft']:.2%} weft"
    ]
    for key, value in summary["parameters"].items():
        bound = summary["bounds"].get(key)
        between = f"   between {bound[0]:.3g} and {bound[1]:.3g}" if bound else ""
        lines.append(f"  {key:<13}{value:10.3g} {UNITS[key]}{between}")
    if "tile" in summary:
        tile = summary["tile"]
        lines.append(
            f"  maps: {tile['pixels']} pixels over {tile['size'][0] * 1e3:.2f} x {tile['size'][1] * 1e3:.2f} mm, "
            f"seam {tile['seam'] * 255:.0f}/255, in {out}"
        )
    return "\n".join(lines)
