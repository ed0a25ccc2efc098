"""`simcore learn`: fine cloth from coarse – data to learn from, and what they are worth."""

from __future__ import annotations

import argparse
import json
import sys
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim_core.learn.command_parts import films_of, progress
from sim_core.validation.arguments import whole

if TYPE_CHECKING:
    from sim_core.learn.data import Floor, Manifest, Recipe

DESCRIPTION = """\
Fine cloth from coarse: what a coarse simulation leaves out, learned from a fine one.

  data      simulate a published scene's sequences, coarse and fine
  train     the learned steps, on the sequences that are not held back
  evaluate  errors and times of what makes fine cloth of coarse, on sequences held back
  infer     simulate coarse, get fine: a film by trained weights
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
"""

EVALUATE = """\
Compare ways from coarse to fine on the sequences that are held back (cases 3, 6, 9, 13, ...), frame by frame against
the fine film, every fifth measured: mean of how far vertices are off, Hausdorff distance (two-sided, vertices from
faces; mean and 95th percentile over frames), normals, strain.

  reference     the fine film against itself with half the time step: no error below three times this is claimed
  linear        the coarse surface
  biharmonic    the smoothest fine sheet with the coarse surface's means
  local_frames  that, and what frames of training add to it in closed form
  mfsr, mesh_conv, paper, ours    networks, of --weights; all but ours need torch

examples:
  simcore learn evaluate hanging --data data/hanging
  simcore learn evaluate flag --data data/flag --rows linear,local_frames --json
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
PLAIN = ("reference", "linear", "biharmonic", "local_frames")
ROWS = (*PLAIN, "mfsr", "mesh_conv", "paper", "ours")
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
    data.add_argument(
        "--workers", type=whole(1, 64), default=1, metavar="N", help="processes side by side (1)"
    )
    data.add_argument(
        "--floor",
        type=whole(0, 1000),
        default=40,
        metavar="N",
        help="frames the floor is told over; 0: not told (40)",
    )
    _add_infer(actions)
    train = _action(actions, "train", "train the learned steps", TRAIN)
    evaluate = _action(actions, "evaluate", "errors and times of ways from coarse to fine", EVALUATE)
    for reads in (train, evaluate):
        reads.add_argument(
            "--data", type=Path, required=True, metavar="DIR", help="what `simcore learn data` made"
        )
    train.add_argument("--out", type=Path, required=True, metavar="FILE.safetensors", help="the weights")
    train.add_argument(
        "--updates", type=whole(1, 1_000_000), default=12_000, metavar="N", help="of the weights (12,000)"
    )
    train.add_argument("--seed", type=whole(0, 1_000_000), default=0, metavar="N", help="(0)")
    train.add_argument("--row", choices=ROWS[4:], default="ours", help="the network (ours)")
    train.add_argument("--device", choices=DEVICES, default="auto", help="(auto: a GPU where there is one)")
    evaluate.add_argument(
        "--rows", type=_rows, metavar="NAMES", help=f"of {','.join(ROWS)} (all; networks with --weights)"
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
        "--floor", type=whole(5, 1000), default=40, metavar="N", help="frames of the reference (40)"
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


def _action(actions: Any, name: str, words: str, description: str) -> argparse.ArgumentParser:
    """What all of them take: a scene, and --json."""
    parser = actions.add_parser(
        name, help=words, description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scene", choices=("flag", "teapot", "hanging"), help="the published scene")
    parser.add_argument("--json", action="store_true", help="print a machine-readable summary")
    return parser


def _rows(text: str) -> tuple[str, ...]:
    names = tuple(name.strip() for name in text.split(","))
    for name in names:
        if name not in ROWS:
            raise argparse.ArgumentTypeError(f"{name!r} – there are {', '.join(ROWS)}")
    return names


def run(args: argparse.Namespace) -> int:
    """Does what was asked for; returns the exit status."""
    if args.action == "train":
        from sim_core.learn.training_command import train

        return train(args)
    if args.action == "infer":
        from sim_core.learn.inference_command import infer

        return infer(args)
    return {"data": data, "evaluate": evaluate}[args.action](args)


def evaluate(args: argparse.Namespace) -> int:
    """Measures rows on the sequences held back."""
    from dataclasses import replace

    from sim_core.errors import SimCoreError
    from sim_core.learn.data import split
    from sim_core.learn.inference import Trained, read_weights
    from sim_core.learn.rows import Biharmonic, Linear, LocalFrames, Ours, RivalRow, measured, reference

    given = {trained.row: (path, trained) for path in args.weights for trained in [read_weights(path)]}
    wanted = args.rows or (*PLAIN, *(row for row in ROWS[len(PLAIN) :] if row in given))
    for row in wanted:
        if row not in PLAIN and row not in given:
            raise SimCoreError(f"--rows {row} – give its --weights, which `simcore learn train` makes")
    films = {
        name: (recipe, replace(film, coarse=film.coarse[: args.frames], fine=film.fine[: args.frames]))
        for name, (recipe, film) in films_of(args).items()
    }
    parts = split([recipe for recipe, _ in films.values()])
    for path, trained in given.values():
        if seen := {one.name for one in parts.test} & set(trained.told.get("learned_from", ())):
            raise SimCoreError(f"{path}: learned from {', '.join(sorted(seen))}, which would be tested on")
    tested = [films[recipe.name] for recipe in parts.test]
    makers = {
        "linear": Linear,
        "biharmonic": Biharmonic,
        "local_frames": lambda: LocalFrames.fitted([films[recipe.name] for recipe in parts.train]),
    }
    for row, (_, trained) in given.items():
        made = Ours(trained) if isinstance(trained, Trained) else RivalRow(trained)
        makers[row] = lambda made=made: made
    told, rows = progress(), {}
    for number, name in enumerate(wanted):

        def share(part: float, words: str, number: int = number) -> None:
            told((number + part) / len(wanted), words)

        if name == "reference":
            found = reference(parts.test, args.floor, share)
            rows[name] = found.told() | {"net_ms": 0.0, "total_ms": round(found.milliseconds, 3)}
            continue
        facts = measured(makers[name](), tested, told=share).told()
        coarse = _middle([film.coarse_ms for _, film in tested])
        rows[name] = facts | {"total_ms": round(coarse + facts["net_ms"], 3)}
    told(1.0, "")
    summary = {"scene": args.scene, "tested": [recipe.name for recipe in parts.test], "rows": rows}
    sys.stdout.write(json.dumps(summary, indent=2) + "\n" if args.json else _table(summary))
    return 0


def _table(summary: dict[str, Any]) -> str:
    head = (
        f"{'mm':14}{'mean':>8}{'Hausdorff':>11}{'p95':>8}{'normals':>9}{'strain':>8}{'ms':>8}{'whole':>8}\n"
    )
    lines = [f"{summary['scene']}, tested on {', '.join(summary['tested'])}\n", head]
    for name, row in summary["rows"].items():
        lines.append(
            f"{name:14}{row['mean_mm']:8.3f}{row['hausdorff_mm']:11.2f}{row['p95_mm']:8.2f}{row['normal_deg']:8.2f}°"
            f"{row['strain']:8.4f}{row['net_ms']:8.2f}{row['total_ms']:8.2f}\n"
        )
    return "".join(lines)


def data(args: argparse.Namespace) -> int:
    """Makes the data and tells what they are worth."""
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    from sim_core.learn.data import Manifest, floor, generate, recipes

    wanted = recipes(args.scene, sequences=args.sequences, frames=args.frames, seed=args.seed)
    args.out.mkdir(parents=True, exist_ok=True)
    Manifest.matching(args.out, wanted)  # what cannot go on is refused before anything runs
    worth = floor(wanted[0], args.floor) if args.floor else None
    if worth is not None and not args.json:
        sys.stdout.write(_floor_words(wanted[0], worth))
        sys.stdout.flush()
    pool = nullcontext()
    if args.workers > 1:
        pool = ProcessPoolExecutor(args.workers, mp_context=get_context("spawn"))
    with pool as executor:
        manifest = generate(args.out, wanted, executor=executor, progress=progress())
    facts = _facts(args.out, manifest) | ({"floor": _floor_facts(worth)} if worth else {})
    sys.stdout.write(json.dumps(facts, indent=2) + "\n" if args.json else _words(facts))
    return 0


def _facts(folder: Path, manifest: Manifest) -> dict[str, Any]:
    kept = list(manifest.done.values())
    return {
        "folder": str(folder),
        "scene": manifest.recipes[0].scene,
        "sequences": len(kept),
        "frames": sum(one["frames"] for one in kept),
        "coarse_vertices": [one["coarse_vertices"] for one in kept],
        "fine_vertices": [one["fine_vertices"] for one in kept],
        "coarse_ms": _middle([one["coarse_ms"] for one in kept]),
        "fine_ms": _middle([one["fine_ms"] for one in kept]),
        "bytes": sum((folder / one["file"]).stat().st_size for one in kept),
    }


def _middle(values: list[float]) -> float:
    from statistics import median

    return round(median(values), 3)


def _floor_facts(worth: Floor) -> dict[str, Any]:
    halved, flat = worth.halved, worth.linear
    return {
        "frames": halved.frames,
        "hausdorff_mm": round(1000 * halved.mean.hausdorff, 4),
        "hausdorff_p95_mm": round(1000 * halved.p95.hausdorff, 4),
        "mean_mm": round(1000 * halved.mean.vertex, 4),
        "normal_deg": round(halved.mean.normal, 4),
        "linear_hausdorff_mm": round(1000 * flat.mean.hausdorff, 4),
        "linear_mean_mm": round(1000 * flat.mean.vertex, 4),
        "slack_mm": round(1000 * worth.slack, 4),
        "fine_ms": round(worth.fine_ms, 2),
        "halved_ms": round(worth.halved_ms, 2),
    }


def _floor_words(recipe: Recipe, worth: Floor) -> str:
    told = _floor_facts(worth)
    return (
        f"floor, {recipe.name}, {told['frames']} frames looked at: half the step moves the fine sheet by "
        f"{told['mean_mm']:.3g} mm (mean), {told['hausdorff_mm']:.3g} mm (Hausdorff; p95 "
        f"{told['hausdorff_p95_mm']:.3g})\n"
        f"  the coarse surface is {told['linear_mean_mm']:.3g} mm from it (mean), {told['linear_hausdorff_mm']:.3g} mm "
        f"(Hausdorff); the led means are {told['slack_mm']:.2g} mm off\n"
    )


def _words(facts: dict[str, Any]) -> str:
    return (
        f"{facts['folder']}: {facts['sequences']} sequences, {facts['frames']} frames of {facts['scene']}, "
        f"{facts['bytes'] / 1e6:.1f} MB; a frame takes {facts['coarse_ms']:.2f} ms coarse, {facts['fine_ms']:.1f} ms "
        "fine and led\n"
    )
