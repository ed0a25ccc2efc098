"""`simcore learn`: fine cloth from coarse – data to learn from, and what they are worth."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from sim_core.learn.commands.evaluation import NETWORKS, ROWS, evaluate
from sim_core.learn.commands.generation import data
from sim_core.validation.arguments import whole

DESCRIPTION = """\
Fine cloth from coarse: what a coarse simulation leaves out, learned from a fine one.

  data      simulate a published scene's sequences, coarse and fine
  train     the learned steps, on the sequences that are not held back
  evaluate  errors and times of what makes fine cloth of coarse, on sequences held back
  infer     simulate coarse, get fine: a film by trained weights
  draw      coarse, made fine and fine side by side, coloured by error: a PNG
  show      coarse, made fine and fine side by side, moving: for the close-up of an exhibit
"""

DATA = """\
Simulate the sequences of a published scene: flag (10 of 600 frames, 6,176 vertices), teapot (16 of 400, 3,030) or
hanging (18 of 1,200, 6,569). Each is simulated twice: a coarse sheet of a quarter of the vertices is let go, then a
fine one follows it softly, so that frame by frame the two show the same cloth: left to themselves they part within a
second. A flag is let fly for two seconds first.

DIR holds manifest.json and a file a sequence (16-bit places, compressed). Whatever ends the run, the same command goes
on with the sequences that are missing; a folder with other settings is refused.

The floor is told first, over --floor frames of the first sequence: how far the fine film is from itself with half the
time step. An error that is claimed from these data has to be at least three times that.

examples:
  simcore learn data hanging --out data/hanging --workers 2
  simcore learn data flag --sequences 2 --frames 50 --out data/try --json
  simcore learn data flag --cluster tcp://10.0.0.7:8786 --out data/flag    # needs the extra `cluster` (Dask)
"""

TRAIN = """\
Train the learned steps on a scene's sequences, all but those that are held back (cases 3, 6, 9, 13, ...). Needs torch
(pip install '.[learn]'); what comes out does not: a .safetensors file of some 170 kB. --row trains what they are
compared with: mfsr (geometry images), mesh_conv (spirals of 9, quadric pooling), paper (spirals of 100, pooling by
Gauss curvature). A GPU is used where there is one, and told; there the last bits of a training are not fixed.

A record beside it is written every minute: whatever ends the run, the same command goes on, to the same weights.

examples:
  simcore learn train hanging --data data/hanging --out hanging.safetensors
  simcore learn train flag --data data/flag --updates 500 --out try.safetensors
  simcore learn train flag --data data/flag --row paper --updates 2000 --out paper.safetensors
  simcore learn train flag --data data/flag --share .25 --out flag-25.safetensors    # fine from a quarter of itself
"""

EVALUATE = """\
Compare ways from coarse to fine on the sequences that are held back (cases 3, 6, 9, 13, ...), frame by frame against
the fine film, every fifth measured: mean of how far vertices are off, Hausdorff distance (two-sided, vertices from
faces; mean and 95th percentile over frames), normals, strain.

  reference     the fine film against itself with half the time step: no error below three times this is claimed
  coarse        the coarse sheet as it is, its own vertices against their places on the fine one
  linear        the coarse surface at the fine vertices
  biharmonic    the smoothest fine sheet with the coarse surface's means
  local_frames  that, and what frames of training add to it in closed form
  mfsr, mesh_conv, paper, ours    networks, of --weights; all but ours need torch
  physics, physics_70, _50, _35    the engine at its quickest, led as the fine film is, on all its vertices or so many
                of a hundred and the smoothest sheet through them; only where named, over the frames of --floor

Winds that were learned from blow at 2 to 8 m/s; --wind tells how a row fares in another.

A frame counts where its floor is a third or less of every error there; half of every sequence has to (--floor says over
how many frames that is measured).

--share S reconstructs instead: less than a share of the fine frame's vertices is given, chosen by quadric errors over
frames of training, and the others are made; means are over these. Two more rows begin with what the published pooling
keeps: curvature_linear, curvature_biharmonic.

examples:
  simcore learn evaluate hanging --data data/hanging
  simcore learn evaluate hanging --data data/hanging --share .6
  simcore learn evaluate flag --data data/flag --rows linear,local_frames --json
  simcore learn evaluate flag --data data/flag --weights flag.safetensors --wind 12,0,1
"""

INFER = """\
Fine cloth at the price of coarse: a sequence's coarse sheet is simulated, and every frame of it made fine by weights of
`simcore learn train`. Those of the row `ours` need no torch.

FILE.npz holds coarse (T, C, 3) and fine (T, V, 3) [m], coarse_faces and fine_faces. --coarse takes the array `coarse`
of another file instead of simulating: the scene's own coarse sheet, moved as you like.

examples:
  simcore learn infer hanging --weights hanging.safetensors --out hanging.npz
  simcore learn infer flag --weights flag.safetensors --case 3 --frames 200 --seed 7 --out new.npz
  simcore learn infer flag --weights flag.safetensors --coarse mine.npz --out fine.npz --json
"""

DRAW = """\
Draw meshes of a frame side by side: the coarse sheet, what makes it fine (the smoothest sheet, then every network of
--weights that has learned the scene) coloured by how far its vertices are off, and the fine sheet. A row a folder of
data, of its first sequence that is held back; the frame is the one whose mean error is the middle one of them all.

examples:
  simcore learn draw --data data/flag --weights flag.safetensors --out flag.png
  simcore learn draw --data data/flag data/teapot data/hanging --weights *.safetensors --out figure.jpg
"""

SHOW = """\
Make what the close-up of an exhibit shows under "Compare": the coarse sheet, what the network makes of it and the fine
sheet, side by side and moving by one clock, of the first sequence that is held back.

DIR gets comparison.glb, comparison.clip (the hall takes 2 MB) and comparison.toml, the table for exhibit.toml: vertices
of each, the Hausdorff distance from the fine sheet (mean over the frames shown), milliseconds a frame of one core.

examples:
  simcore learn show hanging --data data/hanging --weights hanging.safetensors --out comparison
  simcore learn show flag --data data/flag --weights flag.safetensors --begin 200 --frames 50 --out comparison
"""
DEVICES = ("auto", "cpu", "cuda")


def add_parser(subparsers: Any) -> None:
    """Adds `learn` to the parsers of `simcore`."""
    parser = subparsers.add_parser(
        "learn",
        help="coarse cloth -> fine cloth: data, training, errors",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    data = _action(actions, "data", "simulate a scene's sequences, coarse and fine", DATA)
    data.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="the folder; goes on where it was"
    )
    data.add_argument("--sequences", type=whole(1, 18), metavar="N", help="the first so many (all)")
    data.add_argument("--frames", type=whole(1, 100_000), metavar="N", help="of 1/25 s each (as published)")
    data.add_argument(
        "--seed", type=whole(0, 1_000_000), default=0, metavar="N", help="of the flags' gusts (0)"
    )
    who = data.add_mutually_exclusive_group()
    who.add_argument(
        "--workers", type=whole(1, 64), default=1, metavar="N", help="processes side by side (1)"
    )
    who.add_argument("--cluster", metavar="ADDRESS", help="a Dask scheduler's, whose workers do it")
    data.add_argument(
        "--floor",
        type=whole(0, 1000),
        default=40,
        metavar="N",
        help="frames the floor is told over; 0: not told (40)",
    )
    _add_infer(actions)
    _add_draw(actions)
    _add_show(actions)
    train = _action(actions, "train", "train the learned steps", TRAIN)
    evaluate = _action(actions, "evaluate", "errors and times of ways from coarse to fine", EVALUATE)
    for reads in (train, evaluate):
        reads.add_argument(
            "--data", type=Path, required=True, metavar="DIR", help="what `simcore learn data` made"
        )
        reads.add_argument(
            "--share",
            type=_share,
            metavar="S",
            help="reconstruct from less than this share of the fine vertices, 0 to 1, instead",
        )
    train.add_argument("--out", type=Path, required=True, metavar="FILE.safetensors", help="the weights")
    train.add_argument(
        "--updates", type=whole(1, 1_000_000), default=12_000, metavar="N", help="of the weights (12,000)"
    )
    train.add_argument("--seed", type=whole(0, 1_000_000), default=0, metavar="N", help="(0)")
    train.add_argument("--row", choices=NETWORKS, default="ours", help="the network (ours)")
    train.add_argument("--device", choices=DEVICES, default="auto", help="(auto: a GPU where there is one)")
    evaluate.add_argument(
        "--rows",
        type=_rows,
        metavar="NAMES",
        help=f"of {','.join(ROWS)} (all but physics; networks with --weights)",
    )
    evaluate.add_argument(
        "--weights",
        type=Path,
        nargs="+",
        default=[],
        metavar="FILE",
        help="of `simcore learn train`, for networks",
    )
    evaluate.add_argument(
        "--frames", type=whole(1, 100_000), metavar="N", help="of every sequence, the first so many (all)"
    )
    evaluate.add_argument(
        "--wind",
        type=_wind,
        metavar="X,Y,Z",
        help="[m/s] test on a flag in this wind, simulated now (100 frames), instead",
    )
    evaluate.add_argument(
        "--floor",
        type=whole(5, 100_000),
        default=40,
        metavar="N",
        help="frames of each sequence that the reference is measured over (40)",
    )


def _add_infer(actions: Any) -> None:
    infer = _action(actions, "infer", "a fine film from a coarse one, by weights", INFER)
    infer.add_argument("--weights", type=Path, required=True, metavar="FILE", help="of `simcore learn train`")
    infer.add_argument("--out", type=Path, required=True, metavar="FILE.npz", help="both films")
    infer.add_argument("--case", type=whole(1, 18), default=1, metavar="N", help="which sequence (1)")
    infer.add_argument("--frames", type=whole(1, 100_000), default=100, metavar="N", help="to simulate (100)")
    infer.add_argument(
        "--seed", type=whole(0, 1_000_000), default=0, metavar="N", help="of a flag's gusts (0)"
    )
    infer.add_argument("--coarse", type=Path, metavar="FILE.npz", help="a coarse film of your own")


def _add_draw(actions: Any) -> None:
    draw = _action(actions, "draw", "meshes side by side, coloured by error", DRAW, scene=False)
    draw.add_argument(
        "--data",
        type=Path,
        nargs="+",
        required=True,
        metavar="DIR",
        help="of `simcore learn data`, a row each",
    )
    draw.add_argument(
        "--weights", type=Path, nargs="+", default=[], metavar="FILE", help="of `simcore learn train`"
    )
    draw.add_argument("--out", type=Path, required=True, metavar="FILE", help="the picture, .png or .jpg")
    draw.add_argument("--frame", type=whole(1, 100_000), metavar="N", help="another frame")


def _add_show(actions: Any) -> None:
    show = _action(actions, "show", "meshes side by side, moving, for an exhibit", SHOW)
    show.add_argument(
        "--data", type=Path, required=True, metavar="DIR", help="what `simcore learn data` made"
    )
    show.add_argument("--weights", type=Path, required=True, metavar="FILE", help="of `simcore learn train`")
    show.add_argument("--out", type=Path, required=True, metavar="DIR", help="the folder for all three")
    show.add_argument("--begin", type=whole(1, 100_000), default=1, metavar="N", help="the first frame (1)")
    show.add_argument("--frames", type=whole(2, 10_000), default=75, metavar="N", help="how many (75: 3 s)")


def _action(
    actions: Any, name: str, words: str, description: str, *, scene: bool = True
) -> argparse.ArgumentParser:
    """What they take alike: a scene, but for who reads it from the data, and --json."""
    parser = actions.add_parser(
        name, help=words, description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    if scene:
        parser.add_argument("scene", choices=("flag", "teapot", "hanging"), help="the published scene")
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")
    return parser


def _share(text: str) -> float:
    try:
        share = float(text)
    except ValueError:
        share = 0.0
    if not 0.0 < share <= 1.0:
        raise argparse.ArgumentTypeError(f"{text!r} – above 0, to 1")
    return share


def _wind(text: str) -> tuple[float, float, float]:
    try:
        x, y, z = (float(speed) for speed in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} – three speeds in m/s, such as 12,0,1") from None
    return x, y, z


def _rows(text: str) -> tuple[str, ...]:
    names = tuple(name.strip() for name in text.split(","))
    for name in names:
        if name not in ROWS:
            raise argparse.ArgumentTypeError(f"{name!r} – there are {', '.join(ROWS)}")
    return names


def run(args: argparse.Namespace) -> int:
    """Does what was asked for; returns the exit status."""
    if args.action == "train":
        from sim_core.learn.commands.training import train

        return train(args)
    if args.action == "infer":
        from sim_core.learn.commands.inference import infer

        return infer(args)
    if args.action == "draw":
        from sim_core.learn.commands.drawing import draw

        return draw(args)
    if args.action == "show":
        from sim_core.learn.commands.showing import show

        return show(args)
    return {"data": data, "evaluate": evaluate}[args.action](args)
