"""Cloth: time and error together, for every published scene.

    simcore bench cloth [--quick] [--part PART …] [--json FILE] [--plot FILE.png]
    simcore bench cloth --peers …    beside Newton, MuJoCo and Blender, see cloth_against.py

Parts, all of them if none is named:

    time       every scene with the settings its README names, other steps and the implicit scheme: processor
               milliseconds a frame of 1/25 s (median, quartiles over all rounds) and vertex distance from the engine's
               own limit dt -> 0, which is the run with most substeps (the floor is what half of them still changes)
    mesh       distance of sheets with edges of 40, 20 and 10 mm from 5 mm at the same material points, and the order
    growth     microseconds a substep from 1 000 to 100 000 vertices, and the exponent
    horizon    when two runs of the flag with dt and dt/2 part: from there on it is chaotic
    layers     the teapot without and with self-contact: cost, and what crosses itself in the end
    start      a second `simcore cloth`, from call to end
    processes  throughput of two processes over one, beside two spin loops (wants both cores to itself)

--json keeps the parts of the file that are not run again, so that each can be measured when the machine is idle.
`python tests/bench/readme_cloth.py` writes docs/figures/cloth.json into sim_core/cloth (README.md, DETAILS.md).
"""

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from cloth_curves import plot
from cloth_machine import second_start, together
from cloth_measures import Setting, Told, growth, horizon, layers, meshes, timed
from cloth_runs import simulate
from signature import processor, signed

from sim_core.cloth.scenes import Scene, hang_edge, scene

FINEST = 2048
FIXED = (180, 256, 400, 560)


def published(quick: bool) -> dict[str, tuple[Scene, float, bool, list[Setting]]]:
    """Scene, seconds, undamped or not, and the settings that are told of it beside the fixed steps."""
    count, edge = (600, 0.04) if quick else (None, 0.0134)
    own, single = Setting(), Setting(precision="single")
    return {
        "hanging by an edge, undamped": (hang_edge(edge), 0.2, True, [own]),
        "hanging by an edge": (hang_edge(edge), 1.0, False, [own, single]),
        "hanging by two corners": (
            scene("hanging", vertices=count),
            1.0,
            False,
            [own, Setting(courant=0.7), single],
        ),
        "flag": (scene("flag", vertices=count), 0.4, False, [own, Setting(courant=0.35), single]),
        "teapot": (scene("teapot", vertices=count), 0.4, False, [own, Setting(courant=0.35)]),
    }


def times(quick: bool, rounds: int, tell: Told) -> dict:
    """Every scene with every setting."""
    steps = (64, 128) if quick else FIXED
    others = [*(Setting("explicit", n) for n in steps), *(Setting("implicit", n) for n in (1, 8))]
    simulate(hang_edge(0.2), 0.04)
    return {
        name: timed(
            made,
            seconds,
            [*settings, *others],
            rounds=rounds,
            finest=512 if quick else FINEST,
            undamped=undamped,
            tell=lambda text, name=name: tell(f"{name}, {text}"),
        )
        for name, (made, seconds, undamped, settings) in published(quick).items()
    }


def mesh_errors(quick: bool, tell: Told) -> dict:
    """The mesh error of the sheet and of the flag, before it is chaotic."""
    edges = [0.08, 0.04, 0.02] if quick else [0.04, 0.02, 0.01, 0.005]
    return {
        "hanging by an edge": meshes(hang_edge, (1.0, 1.0), 0.4, edges, tell),
        "flag": meshes(lambda e: scene("flag", vertices=_count(1.5, e)), (1.5, 1.0), 0.2, edges, tell),
    }


def _count(area: float, edge: float) -> int:
    return round(area * 2 / np.sqrt(3) / edge**2)


def _parts(quick: bool, rounds: int) -> dict[str, Callable[[Told], dict]]:
    counts = [300, 1000, 3000] if quick else [1000, 3000, 10_000, 30_000, 100_000]
    coarse = 600 if quick else None
    return {
        "time": lambda tell: times(quick, rounds, tell),
        "mesh": lambda tell: mesh_errors(quick, tell),
        "growth": lambda tell: growth(counts, rounds, tell),
        "horizon": lambda tell: horizon(0.4 if quick else 2.0, coarse or 6182, tell),
        "layers": lambda tell: layers((1,) if quick else (1, 13), 20 if quick else 200, coarse, tell),
        "start": lambda tell: second_start(("hanging", "flag", "teapot"), 2 if quick else 5, tell),
        "processes": lambda tell: together(60 if quick else 200, rounds, tell),
    }


class Progress:
    """Says on stderr which part of the bench is at what, in one line if it is a terminal."""

    def __init__(self, total: int) -> None:
        self.total, self.number, self.part, self.begin = total, 0, "", time.perf_counter()

    def enter(self, part: str) -> None:
        self.number, self.part, self.begin = self.number + 1, part, time.perf_counter()
        if not sys.stderr.isatty():
            print(f"bench cloth: {part} ({self.number} of {self.total})", file=sys.stderr, flush=True)

    def tell(self, text: str) -> None:
        if sys.stderr.isatty():
            gone = time.perf_counter() - self.begin
            line = f"\r{self.part} ({self.number} of {self.total}), {gone:.0f} s: {text}\x1b[K"
            print(line, end="", file=sys.stderr, flush=True)

    def leave(self) -> None:
        if sys.stderr.isatty():
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)


def main() -> int:
    if "--peers" in sys.argv[1:]:
        from cloth_against import main as against

        return against()
    parser = argparse.ArgumentParser(
        prog="simcore bench cloth",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    names = tuple(_parts(True, 1))
    parser.add_argument("--quick", action="store_true", help="coarse meshes: does it run at all?")
    parser.add_argument("--part", action="append", choices=names, help="only this one; may be repeated")
    parser.add_argument("--rounds", type=int, default=3, help="runs of every setting, in turns (default: 3)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="keep the figures here, part by part")
    parser.add_argument("--plot", type=Path, metavar="FILE.png", help="draw speed against error")
    args = parser.parse_args()
    if args.rounds < 1:
        parser.error("--rounds: at least 1")
    known = json.loads(args.json.read_text("utf-8")) if args.json and args.json.is_file() else {}
    wanted = {
        name: part for name, part in _parts(args.quick, args.rounds).items() if name in (args.part or names)
    }
    progress = Progress(len(wanted))
    for name, part in wanted.items():
        progress.enter(name)
        known[name] = part(progress.tell)
        known["quick"] = args.quick or known.get("quick", False)
        known["processor"] = processor()
        known |= signed(known, [name])
        progress.leave()
        print(f"{name}: {json.dumps(known[name])}" if not args.json else f"{name}: done", flush=True)
        if args.json:
            args.json.parent.mkdir(parents=True, exist_ok=True)
            args.json.write_text(json.dumps(known, indent=1) + "\n", "utf-8")
    from readme_cloth import tables

    print(tables(known))
    if args.plot and "time" in known:
        args.plot.parent.mkdir(parents=True, exist_ok=True)
        plot(known["time"], args.plot)
    return 0


if __name__ == "__main__":
    sys.exit(main())
