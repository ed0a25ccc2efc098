"""What the machine does with the cloth engine: two processes at once, and how long a second start takes."""

from __future__ import annotations

import json
import multiprocessing
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from cloth_runs import simulate

from sim_core.cloth.scenes import hang_edge
from sim_core.cloth.step import FRAME

Told = Callable[[str], None]
SPINS = 20_000_000
ROOT = Path(__file__).parents[2]


def _work(frames: int) -> float:
    made = hang_edge(0.02)
    simulate(made, FRAME, substeps=200)
    begin = time.perf_counter()
    simulate(made, FRAME * frames, substeps=200)
    return frames / (time.perf_counter() - begin)


def _spin(count: int) -> float:
    begin, total = time.perf_counter(), 0
    for k in range(count):
        total += k & 3
    return count / (time.perf_counter() - begin)


def together(frames: int, rounds: int, tell: Told) -> dict:
    """Throughput of two processes over that of one, for the engine and for a spin loop: medians of turns, and all."""
    kinds = {"engine": (_work, frames), "spin": (_spin, SPINS)}
    ratios: dict[str, list[float]] = {name: [] for name in kinds}
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        for work, size in ((_work, 3), (_spin, 1000)):
            pool.map(work, [size, size], chunksize=1)
        for turn in range(rounds):
            for name, (work, size) in kinds.items():
                tell(f"{name}, round {turn + 1} of {rounds}")
                one = pool.map(work, [size])[0]
                ratios[name].append(sum(pool.map(work, [size, size], chunksize=1)) / one)
    return {
        name: {"ratio": statistics.median(found), "range": [min(found), max(found)]}
        for name, found in ratios.items()
    }


def second_start(scenes: tuple[str, ...], rounds: int, tell: Told) -> dict:
    """Seconds from starting `simcore cloth SCENE --frames 1` to its end, wall and processor, when all is compiled.

    `own`: without the time of the frame itself.
    """
    rows, env = [], os.environ | {"PYTHONPATH": str(ROOT)}
    for name in scenes:
        walls, spent, frame = [], [], []
        for turn in range(rounds + 1):
            tell(f"{name}, start {turn + 1} of {rounds + 1}")
            before, begin = os.times(), time.perf_counter()
            word = [sys.executable, "-m", "sim_core.cli", "cloth", name, "--frames", "1", "--json"]
            told = subprocess.run(word, check=True, capture_output=True, env=env, text=True).stdout
            walls.append(time.perf_counter() - begin)
            after = os.times()
            spent.append(sum(after[2:4]) - sum(before[2:4]))
            frame.append(json.loads(told)["seconds"])
        rows.append(
            {
                "scene": name,
                "wall_s": statistics.median(walls[1:]),
                "cpu_s": statistics.median(spent[1:]),
                "frame_s": statistics.median(frame[1:]),
            }
        )
    return {"rows": rows}
