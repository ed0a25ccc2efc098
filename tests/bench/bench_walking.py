"""Walking: time and error together.

    python tests/bench/bench_walking.py [--moves 1000000] [--seed 1] [--walks 60] [--content FOLDER] [--json FILE]

1. Random moves (all keys, any yaw, dt up to 5 s) among the solids of the shipped plan and of a dense synthetic
   floor; every pose after a move is tested by shapely against the exact polygons, without FCL.
2. The clearance grid for several cell sizes: bytes, seconds, error of the page's clearance, and how far the
   page's prediction strays from the server when W is held against corners and rounds (needs Chromium).
3. Free walks: random keys and turns in a real browser in a real hall, quiet and beside a process that spins on each
   core, 0 and 80 ms away: display against server for the same input (what an answer corrects) and at the same
   moment (what has not been answered yet, at most the page's horizon of walking).
"""

from __future__ import annotations

import argparse
import gzip
import json
import math
import multiprocessing
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "hall_app"))
sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[2]))
import shapely  # noqa: E402
from bench.browser import NoBrowserError, open_browser  # noqa: E402
from bench.free_walk import measure_all  # noqa: E402
from bench.signature import signed  # noqa: E402
from walk_moves import FLOOR, dense_floor, random_walk, room  # noqa: E402
from walk_page import Page, hold  # noqa: E402

from hall_app.walk import BODY, CELL, Floor, Keys, Pose, Round, bake, step, world_of  # noqa: E402

PROCESSES = 2


def measure_moves(name: str, floor: Floor, moves: int, seed: int) -> dict[str, Any]:
    """random_walk in PROCESSES processes, summed."""
    jobs = [(floor, moves // PROCESSES, seed * 1000 + k) for k in range(PROCESSES)]
    with multiprocessing.get_context("spawn").Pool(PROCESSES) as pool:
        parts = pool.map(random_walk, jobs)
    total = {key: sum(part[key] for part in parts) for key in parts[0]}
    return {
        "floor": name,
        "solids": len(floor.solids),
        "moves": int(total["moves"]),
        "penetrations": int(total["penetrations"]),
        "least_room_mm": 1000 * min(part["least"] for part in parts),
        "microseconds_per_move": 1e6 * total["seconds"] / total["moves"],
        "stopped_or_sliding": total["blocked"] / total["moves"],
        "kilometres": total["metres"] / 1000,
    }


def measure_frames(floor: Floor) -> dict[str, float]:
    """CPU [µs] of one 60 Hz input, free and in contact."""
    result = {}
    for name, pose in (("free", Pose(8.0, 6.5)), ("held against a corner", Pose(5.0, 4.2, -0.2))):
        began, count = time.process_time(), 2000
        for _ in range(count):
            after = step(pose, Keys(1, 0), 1 / 60, floor)
            pose = after if name != "free" else pose
        result[name] = 1e6 * (time.process_time() - began) / count
    return result


def contact_starts(floor: Floor, count: int, seed: int) -> list[Pose]:
    """Poses half a metre to two metres from a corner or a round, looking at it (nearly)."""
    rng, world, poses = np.random.default_rng(seed), world_of(floor), []
    while len(poses) < count:
        solid = floor.solids[rng.integers(len(floor.solids))]
        if isinstance(solid, Round):
            angle = rng.uniform(0, 2 * math.pi)
            target = np.array([solid.x, solid.z]) + solid.radius * np.array(
                [math.cos(angle), math.sin(angle)]
            )
        else:
            target = solid.points[rng.integers(len(solid.polygon))] + rng.normal(0, 0.1, 2)
        angle = rng.uniform(0, 2 * math.pi)
        x, z = target + rng.uniform(0.5, 2.0) * np.array([math.cos(angle), math.sin(angle)])
        if floor.shape.contains_properly(shapely.Point(x, z)) and world.clearance(x, z) > 0.02:
            dx, dz = target - (x, z)
            poses.append(Pose(float(x), float(z), math.atan2(-dx, -dz)))
    return poses


def measure_grid(tab: Any, cell: float, holds: int) -> dict[str, Any]:
    """Bytes, seconds and errors of one cell size on FLOOR; bytes and seconds also for a 24 x 16 m hall."""
    began = time.process_time()
    grid = bake(FLOOR, cell=cell)
    seconds = time.process_time() - began
    page, rng, world = Page(tab, grid), np.random.default_rng(3), world_of(FLOOR)
    places = rng.uniform((0, 0), (12, 8), (40_000, 2))
    places = places[np.abs(room(places, FLOOR) - BODY.skin) < 0.02]
    told = np.array(page.run("clearance", places=places.tolist()))
    true = np.array([world.contact(x, z) for x, z in places])
    turn = np.degrees(np.arccos(np.clip(np.sum(told[:, 1:] * true[:, 1:], axis=1), -1, 1)))
    tracks = [
        hold(page, FLOOR, pose, [1 / fps] * (3 * fps), rtt)
        for k, pose in enumerate(contact_starts(FLOOR, holds, 7))
        for fps, rtt in [((60, 24, 10)[k % 3], (0.0, 0.08)[k % 2])]
    ]
    misses = 1000 * np.array([track.misses.max(initial=0) for track in tracks])
    hall = 24 * 16 / (12 * 8)
    return {
        "cell_m": cell,
        "bytes_24x16": round(len(grid.to_bytes()) * hall),
        "gzip_24x16": round(len(gzip.compress(grid.to_bytes(), 6)) * hall),
        "bake_seconds_24x16": seconds * hall,
        "clearance_over_mm": 1000 * float((told[:, 0] - true[:, 0]).max()),
        "clearance_under_mm": 1000 * float((true[:, 0] - told[:, 0]).max()),
        "normal_p99_deg": float(np.quantile(turn, 0.99)),
        "miss_median_mm": float(np.median(misses)),
        "miss_p99_mm": float(np.quantile(misses, 0.99)),
        "miss_max_mm": float(misses.max()),
        "intrusion_mm": 1000 * max(0.0, *(float(-room(track.shown, FLOOR).min()) for track in tracks)),
    }


def shipped_floor(content: Path | None) -> Floor | None:
    """The floor of the content folder, None where there is none."""
    from hall_app.content import load, walking_floor

    folder = content or Path(__file__).parents[2] / "assets"
    if not (folder / "plan.toml").is_file():
        return None
    loaded = load(folder)
    return walking_floor(loaded.plan, loaded.exhibits)


def table(rows: list[dict[str, Any]]) -> str:
    """Rows as aligned text."""
    text = [list(rows[0])] + [
        [f"{v:.4g}" if isinstance(v, float) else str(v) for v in r.values()] for r in rows
    ]
    widths = [max(map(len, column)) for column in zip(*text, strict=True)]
    return "\n".join("  ".join(c.rjust(w) for c, w in zip(row, widths, strict=True)) for row in text)


def main() -> int:
    """Measure, print, write JSON; exit 1 on any penetration."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--moves", type=int, default=1_000_000, help="random moves in all (default 10^6)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--holds", type=int, default=150, help="held walks per cell size (default 150)")
    parser.add_argument(
        "--walks", type=float, default=60.0, help="seconds of each free walk (default 60, 0 none)"
    )
    parser.add_argument("--content", type=Path, help="content folder (default ./assets)")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    args = parser.parse_args()
    floors = {"dense": dense_floor(np.random.default_rng(args.seed))}
    if (shipped := shipped_floor(args.content)) is not None:
        floors["shipped"] = shipped
    moves = [
        measure_moves(name, floor, args.moves // len(floors), args.seed) for name, floor in floors.items()
    ]
    print(table(moves), "\n")
    frames = measure_frames(FLOOR)
    print(
        "one 60 Hz input, CPU:", ", ".join(f"{name} {value:.0f} µs" for name, value in frames.items()), "\n"
    )
    grids: list[dict[str, Any]] = []
    walks: list[dict[str, Any]] = []
    try:
        with open_browser() as browser:
            tab = browser.new_page()
            grids = [measure_grid(tab, cell, args.holds) for cell in (0.1, 0.05, 0.04, 1 / 32, 0.025)]
            print(f"clearance grid (shipped: cell {CELL} m)")
            print(table(grids), "\n")
            if args.walks > 0:
                walks = measure_all(browser, args.walks, args.seed)
                print("free walks by random keys and turns, display against server")
                print(table(walks))
    except NoBrowserError as error:
        print(f"grid errors and free walks not measured: {error}")
    if args.json:
        told = {"moves": moves, "frame_us": frames, "grids": grids, "walks": walks}
        args.json.write_text(json.dumps(signed(told), indent=1))
    return 1 if any(row["penetrations"] for row in moves) else 0


if __name__ == "__main__":
    sys.exit(main())
