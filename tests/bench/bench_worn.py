"""What a worn garment costs a frame: standing, raising its arms, walking; prints a table, writes JSON.

    python tests/bench/bench_worn.py [--only standing raising walking] [--frames 12] [--rounds 3]
        [--garment FILE.npz] [--beside CHECKOUT] [--json FILE]

The garment is carried on by `follow` from where it came to rest, with what it was settled with. --beside runs another
checkout of the project in turn with this one, round by round. Beside the time stands what the cloth is like at the end:
points inside the wearer, crossings of the cloth with itself, area strain. One process and one core at a time; a frame
is 1/25 s; the first frame of each run, which compiles, is not counted.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import astuple
from pathlib import Path
from statistics import median, quantiles
from typing import Any

HERE = Path(__file__).resolve()
ROOT = HERE.parents[2]
CASES = ("standing", "raising", "walking")
STRIDE = 25  # frames of a whole stride, in place


def bodies(case: str, frames: int, settled: Any) -> Iterator[Any]:
    """The wearer's vertices (B, 3) at the begin and at the end of every frame."""
    import numpy as np

    from sim_core.body import Mannequin, Pose, pose_named

    woman = Mannequin.load(ROOT / "assets/mannequins/woman.npz")
    display, raised = pose_named("display"), pose_named("t")
    for k in range(frames + 1):
        if case == "raising":
            yield woman.posed(display.towards(raised, k / 50))
            continue
        phase = 2 * np.pi * k / STRIDE
        swing = {side: sign * 16 * np.sin(phase) for side, sign in (("l", 1.0), ("r", -1.0))}
        joints = {f"hip_{s}": (-swing[s], 0.0, 0.0) for s in swing}
        joints |= {f"knee_{s}": (max(0.0, 1.2 * swing[s]), 0.0, 0.0) for s in swing}
        pose = display.and_also(Pose.from_rotvecs(joints))
        bob = 0.015 * (1 - np.cos(2 * phase))
        yield woman.posed(pose.shifted(0.0, bob, 0.0).facing(4 * np.sin(phase)))


def measure(case: str, frames: int, file: Path) -> dict[str, Any]:
    """One run in this process."""
    import numpy as np

    from sim_core import metrics
    from sim_core.garment import Garment, follow

    garment = Garment.load(file)
    if garment.settled is None:
        sys.exit(f"{file}: a garment that does not say what it was settled with – dress it anew")
    ends = [time.process_time()]

    def heard(index: int, x: np.ndarray) -> None:
        ends.append(time.process_time())

    if case == "standing":
        end = follow(garment, seconds=frames / 25, on_frame=heard)
        surface = garment.settled.beneath.surfaces[0]
        body, faces = surface.vertices, surface.faces
    else:
        path = np.stack(list(bodies(case, frames, garment.settled)))
        faces = garment.settled.beneath.surfaces[0].faces
        end = follow(garment, path, faces, on_frame=heard)
        body = path[-1]
    x = end.positions
    counts = astuple(metrics.penetration(x, garment.faces, body, faces))
    strain = metrics.area_strain(garment.rest_corners(), x, garment.faces)
    return {
        "ms": [1000 * (b - a) for a, b in zip(ends[1:], ends[2:], strict=False)],
        "substeps": end.substeps / frames,
        "inside": sum(counts[:3]),
        "crossings": int(metrics.intersections(x, garment.faces)),
        "strain_p95": float(np.percentile(np.abs(strain), 95)),
        "p99_m": float(end.trace[-1][0]),
        "rollbacks": int(end.rollbacks),
    }


def elsewhere(checkout: Path, case: str, arguments: argparse.Namespace) -> dict[str, Any]:
    """One run by a checkout's code, in a process of its own on one core."""
    command = [sys.executable, str(HERE), "--measure", case, "--frames", str(arguments.frames)]
    command += ["--garment", str(arguments.garment)]
    environment = os.environ | {"PYTHONPATH": str(checkout), "PYTHONSAFEPATH": "1"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(done.stderr.strip().splitlines()[-1])
    return json.loads(done.stdout.splitlines()[-1])


def row(name: str, case: str, runs: list[dict[str, Any]]) -> str:
    """A line of the table."""
    ms = [value for run in runs for value in run["ms"]]
    low, _, high = quantiles(ms, n=4)
    last = runs[-1]
    return (
        f"{case:<9} {name:<7} {median(ms):8.0f} ({low:.0f}–{high:.0f}) {last['substeps']:9.0f}"
        f" {last['inside']:7d} {last['crossings']:10d} {100 * last['strain_p95']:7.2f}% {1e6 * last['p99_m']:9.1f}"
    )


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--garment", type=Path, default=ROOT / "assets/exhibits/beizi/baked/garment.npz")
    parser.add_argument("--beside", type=Path, help="another checkout, in turn with this one")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--measure", choices=CASES, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.frames < 3:
        parser.error("--frames: give 3 or more – the first is not counted")
    if arguments.measure:
        print(json.dumps(measure(arguments.measure, arguments.frames, arguments.garment)))
        return 0
    trees = {"here": ROOT} | ({"beside": arguments.beside.resolve()} if arguments.beside else {})
    found: dict[str, dict[str, list[dict[str, Any]]]] = {}
    print(
        f"{'':9} {'':7} {'ms a frame':>18} {'substeps':>9} {'inside':>7} {'crossings':>10}"
        f" {'strain95':>8} {'p99 µm':>9}"
    )
    for case in arguments.only:
        runs = {name: [] for name in trees}
        for _ in range(arguments.rounds):
            for name, tree in trees.items():
                runs[name].append(elsewhere(tree, case, arguments))
        for name in trees:
            print(row(name, case, runs[name]), flush=True)
        found[case] = runs
    if arguments.json:
        arguments.json.write_text(json.dumps({"frames": arguments.frames, "cases": found}, indent=1), "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
