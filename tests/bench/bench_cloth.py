"""Cloth: time and error together, on the sheet that hangs by one edge.

    python tests/bench/bench_cloth.py [--quick] [--json FILE]
    python tests/bench/bench_cloth.py --peers …   beside Newton, MuJoCo and Blender, see cloth_against.py

Every row is a number of substeps per frame of 1/25 s, adaptive first. Error: vertex distance from the solver's own
limit dt -> 0, taken at the largest number of substeps; the floor is what halving that number still changes. Rows
take turns and the median CPU time per frame is told. The scene states gf-cm units; air is left out.
"""

import argparse
import json
import statistics
import sys
import time
from pathlib import Path

import numpy as np

from sim_core.cloth import drape
from sim_core.cloth.draping import FRAME
from sim_core.cloth.scenes import Scene, hang_edge
from sim_core.cloth.stability import stable_step


def run(scene: Scene, substeps: int | None) -> tuple[np.ndarray, float, int]:
    """End positions, CPU milliseconds per frame and substeps per frame."""
    begin = time.process_time()
    end = drape(scene.sheet, scene.positions, scene.phases, pins=scene.pins, substeps=substeps)
    return end.positions, (time.process_time() - begin) / end.frames * 1e3, end.substeps // end.frames


def distance(a: np.ndarray, b: np.ndarray) -> tuple[float, float]:
    """Mean and largest vertex distance [mm]."""
    gap = np.linalg.norm(a - b, axis=1) * 1e3
    return float(gap.mean()), float(gap.max())


def measure(scene: Scene, rounds: int, finest: int) -> dict:
    """All rows, their errors, and the floor of the reference."""
    reference = run(scene, finest)[0]
    floor = distance(run(scene, finest // 2)[0], reference)
    lowest = int(np.ceil(FRAME / (0.9 * stable_step(scene.sheet.stencil, scene.positions, 2e-5))))
    settings: list[int | None] = [None, lowest, *(n for n in (256, 320, 512) if lowest < n < finest // 2)]
    times: dict[int | None, list[float]] = {n: [] for n in settings}
    ends: dict[int | None, tuple[np.ndarray, int]] = {}
    for _ in range(rounds):
        for n in settings:
            end, spent, count = run(scene, n)
            times[n].append(spent)
            ends[n] = (end, count)
    rows = [
        {
            "substeps": ends[n][1],
            "adaptive": n is None,
            "cpu_ms_per_frame": statistics.median(times[n]),
            "error_mean_mm": distance(ends[n][0], reference)[0],
            "error_max_mm": distance(ends[n][0], reference)[1],
        }
        for n in settings
    ]
    return {"vertices": len(scene.positions), "reference_substeps": finest, "floor_mm": floor, "rows": rows}


def main() -> int:
    if "--peers" in sys.argv[1:]:
        from cloth_against import main as against

        return against()
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="a coarse mesh and one round")
    parser.add_argument("--json", type=Path, help="write the figures as JSON")
    args = parser.parse_args()
    edge, rounds, finest = (0.04, 1, 512) if args.quick else (0.0134, 3, 2048)
    run(hang_edge(0.2, seconds=FRAME), None)  # compile
    results = {f"hang_edge {t} s": measure(hang_edge(edge, seconds=t), rounds, finest) for t in (0.2, 0.4)}
    for name, result in results.items():
        mean, largest = result["floor_mm"]
        print(
            f"{name}: {result['vertices']} vertices, limit at {result['reference_substeps']} substeps per frame"
        )
        print(f"  floor (half of them): mean {mean:.1e} mm, max {largest:.1e} mm")
        print("  substeps/frame      CPU ms/frame    error mean / max, mm")
        for row in result["rows"]:
            mark = "adaptive" if row["adaptive"] else ""
            errors = f"{row['error_mean_mm']:.2e} / {row['error_max_mm']:.2e}"
            print(f"  {row['substeps']:6d} {mark:10s} {row['cpu_ms_per_frame']:12.1f}        {errors}")
    if args.json:
        args.json.write_text(json.dumps(results, indent=2))
    return 0


if __name__ == "__main__":
    sys.exit(main())
