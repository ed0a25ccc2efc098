"""`simcore weave`: a weave by name, file or motif becomes facts, maps, yarns and WIF."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from sim_core.errors import WeaveError, WrongArgument
from sim_core.validation.arguments import ending, whole
from sim_core.weave.chart.command import add_drawing, check_drawing, draw
from sim_core.weave.draft.draft import plain
from sim_core.weave.files.profiles import unit_of
from sim_core.weave.files.sources import Source, blocked_source, dressed, source_of
from sim_core.weave.files.wif.model import wif_of
from sim_core.weave.files.wif.writer import write_wif
from sim_core.weave.maps.figured_maps import FiguredMaps, drawn_maps
from sim_core.weave.maps.surface import SurfaceMaps, lit_cloth
from sim_core.weave.maps.tubes import write_yarns
from sim_core.weave.model import Weave
from sim_core.weave.summary import beside_published, facts_of, summary_of, summary_text
from sim_core.weave.yarns.geometry import FiguredGeometry, YarnGeometry
from sim_core.weave.yarns.particles.cell import (
    MOST_STEPS,
    NotAtRest,
    ParticleCell,
    is_figure,
    relax_particles,
)
from sim_core.weave.yarns.particles.figures import STATIC
from sim_core.weave.yarns.paths import strands
from sim_core.weave.yarns.progress import progress_report
from sim_core.weave.yarns.solver import solve

__all__ = ["add_parser", "run"]

PER = 8  # particles a crossing and yarn
MOST_PARTICLES = 4_000_000  # of a repeat: about 1 GB
MOST_WORK = 3_000_000_000  # particles x steps of a large repeat: about five minutes

MOST_UNASKED = (
    4_096  # crossings of another program's draft that are relaxed without being asked for: a second or two
)
MOST_OURS = 16_384  # of a weave of ours

DESCRIPTION = """\
From draft to yarn to cloth.

SOURCE is one of
  plain                     1/1
  twill:2/1                 over 2, under 1; Z, advancing one end a pick
  satin:8/3                 warp-faced, the one weft point of pick i on end 3 i mod 8
    suffixes                :S mirrors, :weft takes the weft-faced weave (twill:3/1:S, satin:8/3:weft)
  FILE.toml                 a weave file, such as those in assets/weaves; where a motif file says what is woven where,
                            it is relaxed and drawn by its cells, one for each number of the motif
  FILE.wif, FILE.dtx        a draft of another program (WIF 1.0 or 1.1, Fiberworks), read tolerantly
  FILE.json                 what Weave.to_dict or draft_to_dict wrote
  FILE.png, .jpg ...        a motif, one pixel a crossing: dark becomes figure of a satin damask

What needs no physics is told of every draft that can be read, up to 4,000 x 4,000 crossings and, where it is treadled,
20,000 ends and picks: repeat, floats, colours, and whether it hangs together. What the reader had to replace is told
as remarks. Then yarn heights of one repeat are brought into force balance: at the crossings (stage A, beams in
contact), and with --relax in three dimensions (stage B: stretch, bending, contact, friction, flattened sections).
Leno and compound weaves stay at stage A, and so do figures of more than 250,000 crossings or that do not come to rest
in minutes, which a note in the summary says. Large drafts are relaxed only for --relax, --maps or --yarns; where that
cannot be done, the summary is printed all the same, one line says why, and the exit status is 1.
A bare draft is woven of an assumed silk, which the summary says.

The cloth is then tested as the instruments of Kawabata's evaluation system (KES) do it, in SI units and theirs: pressed
between plates (T0, TM), bent (B, 2HB), sheared (G, 2HG), pulled (EMT, LT, WT, RT), and what a weave file says that
others published of such a cloth is told beside; beyond 4,096 crossings without.

Written on demand:
  --maps DIR    albedo normal height roughness direction opacity yarn lit .png, tileable, and parameters.json; of a
                figured weave its whole repeat, number.png (which cell lies where), and each cell's maps in cell-0 ...
  --yarns FILE  the yarns of one repeat: tubes as .glb, axes as .ply; of a figured weave of each cell, FILE-0 ...
  --wif FILE    WIF 1.1; what WIF cannot say goes into a private section
  --draft FILE  threading, tie-up, treadling and drawdown with heddles a shaft, repeats, colours, sett and yarn counts:
                .svg to print, on the smallest sheet on which its cells can be read (pages FILE-1, FILE-2 ... beyond 500
                ends or picks), or .png (beyond 4,000); with --paper A4 on as many of these as readable cells need.
                Print at 100 %; the foot has a line of 50 mm to check that.
  --cards FILE  one pixel a crossing, black where the warp is up; the lowest row is pick 1, the left column end 1
  --pegs FILE   the same of the lift plan: one pixel a shaft and pick

examples:
  simcore weave scarf.wif                                          what the file says, and what had to be replaced
  simcore weave satin:8/3 --relax --maps satin --size 1024 --json
  simcore weave scarf.wif --draft scarf.svg --floats 5             the draft, floats over 5 marked
  simcore weave scarf.wif --draft scarf.svg --paper letter         on pages of a home printer
  simcore weave twill:2/1 --draft twill.svg --times 6,4            six repeats side by side, four one after the other
  simcore weave scarf.wif --draft look.png --view colour           in the colours of its yarns
  simcore weave scarf.dtx --draft part.svg --part 1-120,1-80       a part of it
  simcore weave profile.wif --blocks summer-winter --wif cloth.wif --draft cloth.svg
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
    add_drawing(parser)
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")


def run(args: argparse.Namespace) -> int:
    """Tell, relax, draw and write; returns the exit status."""
    _check_words(args)
    _check_places(args)
    source = source_of(args.source)
    if args.blocks:
        source = blocked_source(source, args.blocks)
    summary = facts_of(source)
    cloth, failed = _cloth(args, source)
    if cloth is not None:
        summary |= cloth.summary
        if source.made is not None and source.wif is None:
            summary |= beside_published(cloth.summary, source.published)
    elif failed:
        summary["note"] = f"not relaxed: {failed}"
    if args.wif:
        _write_wif(source, args.wif)
    if cloth is not None and args.yarns:
        _write_yarns(cloth, args.yarns)
    if cloth is not None and args.maps:
        _write(args.maps, cloth, args.size, summary)
    drawn = draw(args, source)
    if drawn:
        summary["drawn"] = [str(path) for path in drawn]
    for remark in () if args.json else source.remarks:
        sys.stderr.write(f"simcore weave: {args.source}: {remark}\n")
    text = (
        json.dumps(summary, ensure_ascii=False, indent=2) if args.json else summary_text(source.name, summary)
    )
    sys.stdout.write(text + "\n")
    if failed and (args.relax or args.maps or args.yarns):
        raise WeaveError(failed)
    return 0


def _check_words(args: argparse.Namespace) -> None:
    """Arguments that say nothing without others, and structures that are none, are refused before the work."""
    check_drawing(args)
    if args.blocks:
        try:
            unit_of(args.blocks)
        except WeaveError as error:
            raise WrongArgument(f"--blocks {error}") from error


def _check_places(args: argparse.Namespace) -> None:
    """Files and folders that cannot be written are refused before the work, not after it."""
    for path in (args.yarns, args.wif, args.draft, args.cards, args.pegs):
        if path is not None and not path.parent.is_dir():
            raise NotADirectoryError(f"{path}: no such folder – make {path.parent} first")
        if path is not None and path.is_dir():
            raise IsADirectoryError(f"{path}: a folder – give the name of a file")
    if args.maps and any(place.exists() and not place.is_dir() for place in (args.maps, *args.maps.parents)):
        raise NotADirectoryError(f"{args.maps}: a file is in the way – give the name of a folder")


@dataclass(frozen=True, eq=False)
class _Cloth:
    """A weave that was relaxed, and what its summary says."""

    weave: Weave
    geometry: YarnGeometry | ParticleCell | FiguredGeometry
    summary: dict


def _cloth(args: argparse.Namespace, source: Source) -> tuple[_Cloth | None, str]:
    """The relaxed cloth, or None and the one line that says why there is none.

    A large draft is relaxed only for who asks for it: what needs no physics is answered at once.
    """
    asked = args.relax or args.maps or args.yarns
    crossings = source.factors.picks * source.factors.ends
    figured = (
        source.made is not None and source.made[0].figure is not None
    )  # relaxed by its cells, which are small
    if not asked and not figured and crossings > (MOST_OURS if source.made is not None else MOST_UNASKED):
        return None, f"{crossings:,} crossings are relaxed only with --relax, --maps or --yarns"
    try:
        weave, origin = source.weave
        if args.maps:
            args.maps.mkdir(parents=True, exist_ok=True)
        if args.relax:  # compiled before the clock runs: `seconds` is what the relaxation takes
            relax_particles(dressed(plain()), tolerance=0.1)
        begin = perf_counter()
        geometry, note = _relaxed(weave, args.relax)
        summary = summary_of(weave, geometry, perf_counter() - begin, origin)
        return _Cloth(weave, geometry, summary | note), ""
    except WeaveError as error:
        return None, str(error)


def _write_wif(source: Source, path: Path) -> None:
    """The file of another program as it stands, else our draft with all that WIF cannot say."""
    own = source.made is None and source.wif is not None
    write_wif(source.wif if own and source.wif is not None else wif_of(source.weave[0]), path)


def _relaxed(weave, particles: bool):
    """Yarn geometry, and {"note": why it is stage A} where a large repeat was too much for the particles.

    Satins and twills are no large repeats: one pick of them is relaxed, or pins bring them to rest soon.
    """
    count = 2 * PER * weave.draft.lift.size
    large = particles and weave.figure is None and is_figure(weave.draft.lift)
    with progress_report(weave.name) as watch:
        if large and count > MOST_PARTICLES:
            reason = f"a repeat of {count:,} particles, more than {MOST_PARTICLES:,}"
            return solve(weave), {"note": f"stage A, at the crossings: {reason}"}
        try:
            most = min(MOST_STEPS, max(1, MOST_WORK // count)) if large else MOST_STEPS
            geometry = solve(weave, particles=particles, per=PER, watch=watch, most=most)
            return geometry, _held_note(geometry)
        except NotAtRest as error:
            if not large:
                raise
            return solve(weave), {"note": f"stage A, at the crossings: {error}"}


def _held_note(geometry) -> dict[str, str]:
    """What has to be said of floats that slid until they were held."""
    static = max(
        (getattr(cell, "static", 0.0) for cell in getattr(geometry, "cells", (geometry,))), default=0.0
    )
    if static <= STATIC:
        return {}
    return {
        "note": "its floats slide together in this sett: they came to rest by a static friction of "
        f"{1 + static:.2f} times sliding friction – closer yarns or shorter floats would lie still"
    }


def _write_yarns(cloth: _Cloth, path: Path) -> None:
    """The yarns of one repeat; of a figured cloth those of each cell, in files of their own."""
    if not isinstance(cloth.geometry, FiguredGeometry):
        return write_yarns(strands(cloth.weave, cloth.geometry), path)
    for number, (cell, rest) in enumerate(zip(cloth.weave.cells, cloth.geometry.cells, strict=True)):
        write_yarns(strands(cell, rest), path.with_name(f"{path.stem}-{number}{path.suffix}"))


def _write(folder: Path, cloth: _Cloth, size: int, summary: dict) -> None:
    from PIL import Image

    maps = drawn_maps(cloth.weave, cloth.geometry, pixels=size)
    _write_pictures(folder, maps)
    if isinstance(maps, FiguredMaps):
        Image.fromarray(maps.number).save(folder / "number.png")
        for number, cell in enumerate(maps.cells):
            (folder / f"cell-{number}").mkdir(exist_ok=True)
            _write_pictures(folder / f"cell-{number}", cell)
    tile = {"size": list(maps.size), "relief": maps.relief, "repeats": list(maps.repeats), "unit": "m"}
    text = json.dumps({**summary, "tile": tile}, ensure_ascii=False, indent=2)
    (folder / "parameters.json").write_text(text + "\n", "utf-8")


def _write_pictures(folder: Path, maps: SurfaceMaps) -> None:
    from PIL import Image

    for name, picture in {**maps.pictures(), "lit": lit_cloth(maps)}.items():
        Image.fromarray(picture).save(folder / f"{name}.png")
