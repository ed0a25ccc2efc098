"""`simcore dress`: an outfit becomes dressed garments, a model and a picture."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim_core.errors import WrongArgument
from sim_core.validation.arguments import number
from sim_core.validation.files import check_target, written_whole

if TYPE_CHECKING:
    from sim_core.garment import Garment, Outfit

STEPS = (0.026, 0.013)  # [m] of a study
FIGURE = 1.65  # [m] that a picture shows from as far as its eyes are
PICTURED = 0.002  # [m] of a repeat in pictures, at most
DESCRIPTION = """\
Dresses what OUTFIT.toml says, layer by layer from the skin outwards, and writes what is asked for:

  --out FILE.npz       the outermost garment: rest mesh, drape, what it was settled with, measured errors
                       (of several layers the others as FILE-NAME.npz beside it)
  --glb FILE.glb       a model of everything, the weaves' maps at true scale
  --picture FILE.png   a drawing from the front, the side and behind
  --study FILE.json    how far the drape depends on its mesh: dressed at several steps, each against the next finer
  --motion FILE.npz    how it moves by the outfit's motion, 25 frames a second: wearer and layers, vertices by frame;
                       --motion FILE.toml beside it: by that motion file instead (`simcore motion --help`)

An outfit file:

  name = "beizi"
  wearer = "mannequins/woman.npz"     # or a [stand] table: height, span, bar_radius in metres
  size = 1.0                          # how many times as tall the figure is
  pose = "display"                    # `simcore figure --list` lists them; or { name, joints, shift }
  motion = "motions/walk.toml"        # how it moves once dressed; `simcore motion --help` teaches such files

  [[layer]]                           # from the skin outwards
  pattern = "patterns/beizi.toml"
  weave = "weaves/ling.toml"
  weaves = { band = "weaves/juan.toml" }        # of single panels
  dye = "#c39c50"                     # dyes = { band = "#2c4464" } of single panels; a cloth woven of several
                                      # colours keeps them
  origin = [0, 960]                   # where a corner of the weave's repeat lies in the pattern's axes, in mm, so that
                                      # bands and badges fall where they should; origins = { panel = [x, y] }
  measures = { length = 1180 }        # of the pattern, in millimetres
  edge = 0.013                        # mesh step in metres; below 0.009 it is sewn and posed at 0.015 first
  start = "t"                         # pose the wearer begins in (wrapped, along_path), which a pose step leaves
  [layer.place]
  way = "flat"                        # flat, wrapped, upright, over_bar, along_path, folded; each has its keys
                                      # flat: over = "left", the front that lies outside; what it has beyond the side,
                                      # of panels cut for that side alone (side = "left"), goes on round the back
  [[layer.step]]                      # only where the usual steps do not do
  do = "sew"                          # sew, weld, pin, release, close, pose, settle, rest
  seconds = 0.9                       # gravity, damping, friction, speed, still, touch, label
                                      # close: ties, or belt = { length = 0.72, mark = "waist", rise = 0.0 }
  [[layer.then]]                      # steps that follow on the usual ones, or on those of [[layer.step]]
  do = "rest"
  seconds = 6.0

Files are found beside the folder `outfits` the file lies in, or in --content. What cannot be dressed is refused
before anything runs, a belt tighter than what is worn beneath before its layer does. Interrupted, the same command goes
on where it stopped and comes to the same result: with --out, --glb or --picture, beside which states are kept until all
of them are written. Without any nothing is kept.
"""


def add_parser(subparsers: Any) -> None:
    """Adds `dress` to the parsers of `simcore`."""
    parser = subparsers.add_parser(
        "dress",
        help="dress an outfit",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("outfit", type=Path, metavar="OUTFIT.toml")
    parser.add_argument("--content", type=Path, metavar="DIR", help="folder the outfit's paths are read from")
    parser.add_argument("--out", type=Path, metavar="FILE.npz", help="where the garment goes")
    parser.add_argument("--glb", type=Path, metavar="FILE.glb", help="where its model goes")
    parser.add_argument("--picture", type=Path, metavar="FILE.png", help="where its picture goes")
    parser.add_argument(
        "--motion",
        type=Path,
        action="append",
        metavar="FILE",
        help="FILE.npz: where its motion goes; FILE.toml: the motion, instead of the outfit's",
    )
    parser.add_argument(
        "--edge",
        type=number(0.002, 0.2, " m"),
        help="mesh step of all layers in metres (default: the outfit's)",
    )
    parser.add_argument(
        "--study",
        type=Path,
        metavar="FILE.json",
        help="dress at several mesh steps instead and write how far the drapes lie apart",
    )
    parser.add_argument(
        "--steps",
        type=_steps,
        default=STEPS,
        metavar="M,M,…",
        help="mesh steps of --study in metres (default: 0.026,0.013)",
    )
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")


def run(args: argparse.Namespace) -> int:
    """Dresses and writes; returns the exit status."""
    from sim_core.cloth import Checkpoint
    from sim_core.garment import dress, load_outfit
    from sim_core.garment.dressing import forget

    named, args.motion = _motions(args.motion or [])
    _check_kinds(args)
    outfit = load_outfit(args.outfit, args.content)
    if named is not None:
        outfit = _moved_by(outfit, named, args.outfit)
    if args.edge is not None:
        outfit = outfit.coarser(args.edge)
    if args.study is not None:
        return _study(args, outfit)
    files = _garment_files(args, outfit)
    if args.motion is not None and outfit.motion is None:
        raise WrongArgument(f'--motion: {args.outfit} names none – add motion = "motions/….toml" to it')
    for path in (*files.values(), args.glb, args.picture, args.motion):
        if path is not None:
            check_target(path)
    kept = _checkpoint(args)
    checkpoint = kept and Checkpoint(kept, keep=True)
    garments = dress(outfit, progress=None if args.json else _progress, checkpoint=checkpoint)
    for garment in garments:
        if garment.name in files:
            garment.save(files[garment.name])
    if args.glb is not None:
        _write_model(args.glb, outfit, garments)
    if args.picture is not None:
        _draw(args.picture, outfit, garments)
    if args.motion is not None:
        _move(args.motion, outfit, garments, progress=None if args.json else _progress)
    if kept is not None:
        forget(kept)
    _report(args, garments, files)
    return 0


def _steps(text: str) -> tuple[float, ...]:
    """Two mesh steps or more, in metres."""
    step = number(0.002, 0.2, " m")
    steps = tuple(step(part) for part in text.split(","))
    if len(set(steps)) < 2:
        raise argparse.ArgumentTypeError("two steps or more are compared, e.g. 0.026,0.013")
    return steps


def _study(args: argparse.Namespace, outfit: Outfit) -> int:
    """Dresses at several mesh steps and writes what was found."""
    from sim_core.garment.step_study import forget_study, step_study

    check_target(args.study)
    found = step_study(outfit, args.study, args.steps, None if args.json else _progress)
    text = json.dumps(found, indent=1, ensure_ascii=False) + "\n"
    with written_whole(args.study) as stream:
        stream.write(text.encode())
    forget_study(args.study, args.steps)
    if args.json:
        sys.stdout.write(text)
        return 0
    for layer in found["layers"]:
        scatter, edge = layer["scatter"], layer["edges"][0]
        lines = [f"{layer['name']}: scatter at {1000 * edge:.1f} mm {_distance(scatter)}"]
        pairs = zip(layer["edges"], layer["edges"][1:], layer["apart"], strict=False)
        lines += [f"  {1000 * a:.1f} to {1000 * b:.1f} mm: {_distance(apart)}" for a, b, apart in pairs]
        sys.stdout.write("\n".join(lines) + "\n")
    return 0


def _distance(apart: dict[str, float]) -> str:
    return f"mean {1000 * apart['mean_m']:.2f} mm, p99 {1000 * apart['p99_m']:.2f} mm"


def _motions(paths: Sequence[Path]) -> tuple[Path | None, Path | None]:
    """The motion file (.toml) and where the motion goes, of what --motion was given."""
    named = [path for path in paths if path.suffix == ".toml"]
    targets = [path for path in paths if path.suffix != ".toml"]
    if len(named) > 1 or len(targets) > 1:
        raise WrongArgument(
            f"--motion: {' '.join(map(str, paths))} – give one FILE.toml and one FILE.npz at most"
        )
    if named and not targets:
        raise WrongArgument(
            f"--motion: {named[0]} says how it moves – add --motion FILE.npz, where its motion goes"
        )
    return (named or [None])[0], (targets or [None])[0]


def _moved_by(outfit: Outfit, path: Path, source: Path) -> Outfit:
    """The outfit with the motion of a file instead of its own."""
    from dataclasses import replace

    from sim_core.garment import load_motion

    if outfit.wearer is None:
        raise WrongArgument(
            f"--motion: {source} has a stand, which does not move – give an outfit with a wearer"
        )
    return replace(outfit, motion=load_motion(path))


def _check_kinds(args: argparse.Namespace) -> None:
    """Raises WrongArgument for the name of a file of another kind."""
    for name, suffix in (
        ("out", ".npz"),
        ("glb", ".glb"),
        ("picture", ".png"),
        ("motion", ".npz"),
        ("study", ".json"),
    ):
        path = getattr(args, name)
        if path is not None and path.suffix != suffix:
            raise WrongArgument(f"--{name}: {path} – name a file that ends in {suffix}")


def _garment_files(args: argparse.Namespace, outfit: Outfit) -> dict[str, Path]:
    """Where each layer is saved, by its name."""
    if args.out is None:
        return {}
    *beneath, outermost = (layer.name for layer in outfit.layers)
    files = {name: args.out.with_name(f"{args.out.stem}-{name}.npz") for name in beneath}
    return {**files, outermost: args.out}


def _checkpoint(args: argparse.Namespace) -> Path | None:
    """Beside what is written first, so that an interrupted run is found again."""
    target = args.out or args.glb or args.picture or args.motion
    if target is None:
        return None
    return target.with_name(f"{target.stem}.part")


def _progress(fraction: float, label: str) -> None:
    sys.stderr.write(f"\r{100 * fraction:5.1f} %  {label:<28}" + ("\n" if fraction >= 1 else ""))
    sys.stderr.flush()


def _write_model(path: Path, outfit: Outfit, garments: Sequence[Garment]) -> None:
    from sim_core.garment import Clothed, opaque, write_glb
    from sim_core.garment.levels import shown_figure

    clothed = [
        Clothed.woven(garment, loom=layer.loom)
        for garment, layer in zip(garments, outfit.layers, strict=True)
    ]
    figure = None
    if outfit.wearer is not None:
        body = outfit.wearer.posed(outfit.pose), outfit.wearer.faces
        figure = shown_figure(*body, *opaque(clothed), worn=outfit.wearer.worn())
    write_glb(path, clothed, figure=figure)


def _move(
    path: Path,
    outfit: Outfit,
    garments: Sequence[Garment],
    *,
    progress: Callable[[float, str], None] | None,
) -> None:
    """Frames of the wearer and of every layer, with their faces."""
    import numpy as np

    from sim_core.garment import move

    assert outfit.wearer is not None
    played = move(outfit, garments, progress=progress)
    body = np.stack([outfit.wearer.posed(pose) for pose in played.poses])
    arrays = {"wearer": body.astype(np.float32), "wearer_faces": outfit.wearer.faces}
    for garment, positions in zip(garments, played.frames, strict=True):
        arrays |= {garment.name: positions, f"{garment.name}_faces": garment.faces}
    with written_whole(path) as stream:
        np.savez_compressed(stream, **arrays)  # pyright: ignore[reportArgumentType]


def _draw(path: Path, outfit: Outfit, garments: Sequence[Garment]) -> None:
    """Everything from the front, from the side and from behind."""
    import numpy as np

    from sim_core.garment.glb import LACQUER, LINEN, Clothed
    from sim_core.picture import Camera, Fabric, Surface, render, save_png, split_along
    from sim_core.weave.maps import SHEER, coverage, seen_afar, srgb

    surfaces = []
    if outfit.wearer is not None:
        vertices, faces = outfit.wearer.posed(outfit.pose), outfit.wearer.faces
        surfaces.append(Surface(vertices, faces[outfit.wearer.bare()], LINEN))
        for piece in outfit.wearer.worn():
            surfaces.append(Surface(vertices, faces[piece.faces(faces)], piece.dye))
    if outfit.stand is not None:
        surfaces.append(Surface(*outfit.stand.mesh(), LACQUER, gloss=0.25))
    for garment, layer in zip(garments, outfit.layers, strict=True):
        clothed = Clothed.woven(garment, loom=layer.loom)
        places = garment.cloth_places()[garment.pattern_faces]
        split, welded = split_along(garment.faces, garment.creases())
        looks: dict[Any, list[int]] = {}
        for own in range(len(garment.panels)):
            looks.setdefault((garment.dye_of(own), id(clothed.of(own))), []).append(own)
        for (dye, _), which in looks.items():
            mine, maps = np.isin(garment.panel, which), clothed.of(which[0])
            share, (picture, colour) = coverage(maps), seen_afar(maps, dye, PICTURED)
            sheer = share < SHEER
            surfaces.append(
                Surface(
                    garment.positions[welded],
                    split[mine],
                    tuple(srgb(colour)),
                    alpha=max(share, 0.5) if sheer else 1.0,
                    gloss=0.12,
                    sheen=0.5,
                    through=0.55 if sheer else 0.0,
                    fabric=None if picture is None else Fabric(picture, maps.size),
                    corners=places[mine],
                )
            )
    points = np.concatenate([surface.vertices for surface in surfaces])
    low, high = points.min(0), points.max(0)
    middle, size = 0.5 * (low + high), max(high[1] - low[1], 0.75 * (high[0] - low[0])) / FIGURE
    eyes = ((0.5, 0.42, 3.6), (2.9, 0.38, 2.0), (-1.4, 0.38, -3.2))
    pictures = [
        render(surfaces, Camera(tuple(middle + size * np.array(eye)), tuple(middle), 27), (620, 840))
        for eye in eyes
    ]
    save_png(path, np.concatenate(pictures, axis=1))


def _report(args: argparse.Namespace, garments: Sequence[Garment], files: dict[str, Path]) -> None:
    kept = ("way", "whole", "coarse", "seconds", "simulated", "substeps", "errors", "inputs")
    if args.json:
        layers = [
            {
                "name": garment.name,
                "file": str(files[garment.name]) if garment.name in files else None,
                "digest": garment.digest(),
                "vertices": len(garment.positions),
                "triangles": len(garment.faces),
                **{key: garment.provenance[key] for key in kept if key in garment.provenance},
            }
            for garment in garments
        ]
        sys.stdout.write(json.dumps({"outfit": str(args.outfit), "layers": layers}, indent=2) + "\n")
        return
    for garment in garments:
        e = garment.provenance["errors"]
        inside = sum(e[f"inside_{what}"] for what in ("vertices", "midpoints", "centroids", "edges"))
        lines = [
            f"{garment.name}: {len(garment.positions)} vertices, {len(garment.faces)} triangles, "
            f"{1000 * e['mass_kg']:.1f} g" + (f" -> {files[garment.name]}" if garment.name in files else ""),
            f"  inside what lies beneath {inside}, area strain p95 {e['area_strain_p95']:.2%}, "
            f"self-intersections {e['self_intersections']}, wrong order {e['layer_order']}, "
            f"moving {e['rest_p99_m'] * 1e3:.4f} mm per 1/25 s (p99)"
            + (f", seams eased up to {e['seam_ease']:.2%}" if "seam_ease" in e else ""),
            "  seconds: " + ", ".join(f"{k} {v:.1f}" for k, v in garment.provenance["seconds"].items()),
        ]
        sys.stdout.write("\n".join(lines) + "\n")
