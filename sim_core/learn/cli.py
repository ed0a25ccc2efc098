"""`simcore learn`: fine cloth from coarse – data to learn from, and what they are worth."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim_core.validation.arguments import whole

if TYPE_CHECKING:
    from sim_core.learn.data import Film, Floor, Manifest, Recipe

DESCRIPTION = """\
Fine cloth from coarse: what a coarse simulation leaves out, learned from a fine one.

  data      simulate a published scene's sequences, coarse and fine
  train     the learned steps, on the sequences that are not held back
  evaluate  errors and times of what makes fine cloth of coarse, on sequences held back
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
(pip install '.[learn]'); what comes out does not: a .safetensors file of some 170 kB.

A record beside it is written every minute: whatever ends the run, the same command goes on, to the same weights.

examples:
  simcore learn train hanging --data data/hanging --out hanging.safetensors
  simcore learn train flag --data data/flag --updates 500 --out try.safetensors
"""

EVALUATE = """\
Compare ways from coarse to fine on the sequences that are held back (cases 3, 6, 9, 13, ...), frame by frame against
the fine film, every fifth measured: mean of how far vertices are off, Hausdorff distance (two-sided, vertices from
faces; mean and 95th percentile over frames), normals, strain.

  reference     the fine film against itself with half the time step: no error below three times this is claimed
  linear        the coarse surface
  biharmonic    the smoothest fine sheet with the coarse surface's means
  local_frames  that, and what frames of training add to it in closed form
  ours          the learned steps of --weights

examples:
  simcore learn evaluate hanging --data data/hanging
  simcore learn evaluate flag --data data/flag --rows linear,local_frames --json
"""
ROWS = ("reference", "linear", "biharmonic", "local_frames", "ours")


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
    evaluate.add_argument(
        "--rows", type=_rows, metavar="NAMES", help=f"of {','.join(ROWS)} (all; ours with --weights)"
    )
    evaluate.add_argument(
        "--weights", type=Path, metavar="FILE", help="of `simcore learn train`, for the row ours"
    )
    evaluate.add_argument(
        "--frames", type=whole(1, 100_000), metavar="N", help="of every sequence, the first so many (all)"
    )
    evaluate.add_argument(
        "--floor", type=whole(5, 1000), default=40, metavar="N", help="frames of the reference (40)"
    )


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
    return {"data": data, "train": train, "evaluate": evaluate}[args.action](args)


def train(args: argparse.Namespace) -> int:
    """Trains on the sequences that are not held back, and writes the weights."""
    from importlib.util import find_spec

    from sim_core.cloth.run import ENGINE_VERSION
    from sim_core.errors import SimCoreError
    from sim_core.learn.data import split
    from sim_core.learn.inference import Settings, Trained, write_weights

    if args.out.suffix != ".safetensors":
        raise SimCoreError(f"--out: {args.out} – name a file that ends in .safetensors")
    if find_spec("torch") is None:
        raise SimCoreError("torch is not installed – pip install '.[learn]'; to use weights it is not needed")
    from sim_core.learn.networks import Schedule
    from sim_core.learn.networks import train as trained

    films = _films(args)
    parts = split([recipe for recipe, _ in films.values()])
    began, settings = time.monotonic(), Settings()
    schedule = Schedule(updates=args.updates, seed=args.seed)
    told = _progress()
    weights = trained(
        [films[recipe.name] for recipe in parts.train],
        settings,
        schedule,
        record=args.out.with_suffix(".record"),
        told=lambda share, words: told(share, f"loss {words}"),
    )
    told(1.0, "")
    facts = {
        "scene": args.scene,
        "learned_from": [recipe.name for recipe in parts.train],
        "engine": ENGINE_VERSION,
        "updates": args.updates,
        "seed": args.seed,
        "device": "cpu",
    }
    write_weights(args.out, Trained(settings, weights, facts))
    facts |= {"file": str(args.out), "parameters": sum(value.size for value in weights.values())}
    facts |= {"seconds": round(time.monotonic() - began, 1)}
    words = (
        f"{args.out}: {facts['parameters']:,} numbers, {args.updates:,} updates in {facts['seconds']:.0f} s\n"
    )
    sys.stdout.write(json.dumps(facts, indent=2) + "\n" if args.json else words)
    return 0


def _films(args: argparse.Namespace) -> dict[str, tuple[Recipe, Film]]:
    from sim_core.errors import SimCoreError
    from sim_core.learn.data import read_films

    every = read_films(args.data)
    if (found := next(iter(every.values()))[0].scene) != args.scene:
        raise SimCoreError(f"{args.data}: holds {found} – give the folder of {args.scene}")
    return every


def evaluate(args: argparse.Namespace) -> int:
    """Measures rows on the sequences held back."""
    from dataclasses import replace

    from sim_core.errors import SimCoreError
    from sim_core.learn.data import split
    from sim_core.learn.inference import read_weights
    from sim_core.learn.rows import Biharmonic, Linear, LocalFrames, Ours, measured, reference

    wanted = args.rows or (ROWS if args.weights else ROWS[:-1])
    if "ours" in wanted and args.weights is None:
        raise SimCoreError("--rows ours – give its --weights, which `simcore learn train` makes")
    ours = read_weights(args.weights) if args.weights else None
    films = {
        name: (recipe, replace(film, coarse=film.coarse[: args.frames], fine=film.fine[: args.frames]))
        for name, (recipe, film) in _films(args).items()
    }
    parts = split([recipe for recipe, _ in films.values()])
    if ours and (seen := {one.name for one in parts.test} & set(ours.told.get("learned_from", ()))):
        raise SimCoreError(
            f"{args.weights}: learned from {', '.join(sorted(seen))}, which would be tested on"
        )
    tested = [films[recipe.name] for recipe in parts.test]
    makers = {
        "linear": Linear,
        "biharmonic": Biharmonic,
        "local_frames": lambda: LocalFrames.fitted([films[recipe.name] for recipe in parts.train]),
    }
    if ours is not None:
        made = Ours(ours)
        makers["ours"] = lambda: made
    told, rows = _progress(), {}
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
        manifest = generate(args.out, wanted, executor=executor, progress=_progress())
    facts = _facts(args.out, manifest) | ({"floor": _floor_facts(worth)} if worth else {})
    sys.stdout.write(json.dumps(facts, indent=2) + "\n" if args.json else _words(facts))
    return 0


def _progress() -> Callable[[float, str], None]:
    """Tells the share and the time left on stderr, where someone looks."""
    began, first = time.monotonic(), None

    def told(share: float, words: str) -> None:
        nonlocal first
        if first is None:
            first = share
        gone = time.monotonic() - began
        left = gone * (1.0 - share) / (share - first) if share > first else 0.0
        if sys.stderr.isatty():
            sys.stderr.write(f"\r{100 * share:5.1f} %  {words:<12} {left / 60:5.1f} min left ")
            sys.stderr.write("\n" if share >= 1.0 else "")
            sys.stderr.flush()

    return told


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
