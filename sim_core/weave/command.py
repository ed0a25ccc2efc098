"""`simcore weave`: a weave by name, file or motif becomes facts, maps, yarns and WIF."""

import argparse
import json
import sys
from pathlib import Path
from time import perf_counter

from sim_core.arguments import ending, whole

__all__ = ["add_parser", "run"]

PER = 8  # particles a crossing and yarn
MOST_PARTICLES = 4_000_000  # of a repeat: about 1 GB
MOST_WORK = 3_000_000_000  # particles x steps of a large repeat: about five minutes

DESCRIPTION = """\
From draft to yarn to cloth.

SOURCE is one of
  plain                     1/1
  twill:2/1                 over 2, under 1; Z, advancing one end a pick
  satin:8/3                 warp-faced, the one weft point of pick i on end 3 i mod 8
    suffixes                :S mirrors, :weft takes the weft-faced weave (twill:3/1:S, satin:8/3:weft)
  FILE.toml                 a weave file, such as those in assets/weaves
  FILE.wif                  WIF 1.0 or 1.1, read tolerantly
  FILE.json                 what Weave.to_dict or draft_to_dict wrote
  FILE.png, .jpg ...        a motif, one pixel a crossing: dark becomes figure of a satin damask

Yarn heights of one repeat are brought into force balance: at the crossings (stage A, beams in contact), and with
--relax in three dimensions (stage B: stretch, bending, contact, friction, flattened sections). Leno and compound
weaves stay at stage A, and so do figures of more than 250,000 crossings or that do not come to rest in minutes, which a
note in the summary says. A bare draft is woven of an assumed silk, which the summary says.

Written on demand:
  --maps DIR    albedo normal height roughness direction opacity yarn lit .png, tileable, and parameters.json
  --yarns FILE  the yarns of one repeat: tubes as .glb, axes as .ply
  --wif FILE    WIF 1.1; what WIF cannot say goes into a private section

example:
  simcore weave satin:8/3 --relax --maps satin --size 1024 --json
"""


def add_parser(subparsers) -> None:
    """Describe the command to argparse."""
    parser = subparsers.add_parser(
        "weave",
        help="draft, WIF or motif -> yarns, texture maps, cloth parameters",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "source", metavar="SOURCE", help="plain, twill:2/1, satin:8/3, a file or a motif picture"
    )
    parser.add_argument("--relax", action="store_true", help="relax the yarns in three dimensions (stage B)")
    parser.add_argument("--maps", type=Path, metavar="DIR", help="folder for the maps")
    parser.add_argument(
        "--size", type=whole(32, 4096), default=1024, metavar="N", help="pixels of the maps (default 1024)"
    )
    parser.add_argument("--yarns", type=ending(".glb", ".ply"), metavar="FILE", help="yarn tubes or axes")
    parser.add_argument("--wif", type=ending(".wif"), metavar="FILE", help="the draft as WIF 1.1")
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")


def run(args: argparse.Namespace) -> int:
    """Relax, draw and write; returns the exit status."""
    from sim_core.weave.draft import plain
    from sim_core.weave.particles import relax_particles
    from sim_core.weave.report import summary_of
    from sim_core.weave.words import dressed, weave_of

    for path in (args.yarns, args.wif):  # refused before the work, not after it
        if path is not None and not path.parent.is_dir():
            raise NotADirectoryError(f"{path}: no such folder – make {path.parent} first")
        if path is not None and path.is_dir():
            raise IsADirectoryError(f"{path}: a folder – give the name of a file")
    if args.maps and any(place.exists() and not place.is_dir() for place in (args.maps, *args.maps.parents)):
        raise NotADirectoryError(f"{args.maps}: a file is in the way – give the name of a folder")
    weave, origin = weave_of(args.source)
    if args.maps:
        args.maps.mkdir(parents=True, exist_ok=True)
    if args.relax:  # compiled before the clock runs: `seconds` is what the relaxation takes
        relax_particles(dressed(plain()), tolerance=0.1)
    begin = perf_counter()
    geometry, note = _relaxed(weave, args.relax)
    summary = summary_of(weave, geometry, perf_counter() - begin, origin) | note
    if args.wif:
        from sim_core.weave.wif import wif_of
        from sim_core.weave.wif_write import write_wif

        write_wif(wif_of(weave), args.wif)
    if args.yarns:
        from sim_core.weave.strands import strands
        from sim_core.weave.tubes import write_yarns

        write_yarns(strands(weave, geometry), args.yarns)
    if args.maps:
        _write(args.maps, weave, geometry, args.size, summary)
    text = json.dumps(summary, ensure_ascii=False, indent=2) if args.json else _text(weave.name, summary)
    sys.stdout.write(text + "\n")
    return 0


def _relaxed(weave, particles: bool):
    """Yarn geometry, and {"note": why it is stage A} where a large repeat was too much for the particles.

    Satins and twills are no large repeats: one pick of them is relaxed, or pins bring them to rest soon.
    """
    from sim_core.weave.particles import MOST_STEPS, NotAtRest, is_figure
    from sim_core.weave.progress import shown
    from sim_core.weave.solve import solve

    count = 2 * PER * weave.draft.lift.size
    large = particles and is_figure(weave.draft.lift)
    with shown(weave.name) as watch:
        if large and count > MOST_PARTICLES:
            reason = f"a repeat of {count:,} particles, more than {MOST_PARTICLES:,}"
            return solve(weave), {"note": f"stage A, at the crossings: {reason}"}
        try:
            most = min(MOST_STEPS, max(1, MOST_WORK // count)) if large else MOST_STEPS
            return solve(weave, particles=particles, per=PER, watch=watch, most=most), {}
        except NotAtRest as error:
            if not large:
                raise
            return solve(weave), {"note": f"stage A, at the crossings: {error}"}


def _write(folder: Path, weave, geometry, size: int, summary: dict) -> None:
    from PIL import Image

    from sim_core.weave.surface import lit_cloth, surface_maps

    maps = surface_maps(weave, geometry, pixels=size)
    for name, picture in {**maps.pictures(), "lit": lit_cloth(maps)}.items():
        Image.fromarray(picture).save(folder / f"{name}.png")
    tile = {"size": list(maps.size), "relief": maps.relief, "repeats": list(maps.repeats), "unit": "m"}
    text = json.dumps({**summary, "tile": tile}, ensure_ascii=False, indent=2)
    (folder / "parameters.json").write_text(text + "\n", "utf-8")


def _text(name: str, summary: dict) -> str:
    repeat, floats, crimp = summary["repeat"], summary["floats"], summary["crimp"]
    lines = [
        f"{name}: {repeat['ends']} ends x {repeat['picks']} picks, {summary['face']} face, longest float "
        f"{floats['warp']['longest']} warp {floats['weft']['longest']} weft, "
        f"{'hangs together' if summary['integral'] else 'FALLS APART'}",
        f"  crimp {crimp['warp']:.2%} warp {crimp['weft']:.2%} weft, {summary['thickness'] * 1e6:.0f} um thick, "
        f"{summary['areal_density'] * 1e3:.1f} g/m2",
    ]
    for key, entry in summary["parameters"].items():
        if isinstance(entry, dict) and "value" in entry:
            band = entry.get("band")
            between = f"   between {band[0]:.3g} and {band[1]:.3g}" if band else ""
            lines.append(f"  {key:<13}{entry['value']:10.3g} {entry['unit']}{between}")
    if "note" in summary:
        lines.append(f"  {summary['note']}")
    return "\n".join(lines)
