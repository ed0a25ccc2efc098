"""Distance field of a mesh: error against time by cell, beside exact distances; prints a table, writes JSON."""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np

from sim_core import metrics
from sim_core.body import Mannequin, Pose
from sim_core.cloth.contact import field_of
from sim_core.picture import normals

FILE = Path(__file__).parents[2] / "assets" / "mannequins" / "woman.npz"


def measured(
    cell: float, band: float, exact: float | None, rounds: int, *, margin: float | None = None
) -> dict[str, float]:
    """Errors [m] and least CPU seconds of one setting, on the posed figure.

    margin: [m] of the box around the figure; None: the band.
    """
    woman = Mannequin.load(FILE)
    mesh = woman.posed(Pose.arms(58.0, 78.0)), woman.faces
    seconds: dict[bool, float] = {}
    room = band if margin is None else margin
    box = (mesh[0].min(0) - room, mesh[0].max(0) + room)
    for far in (False, True):
        laps = []
        for _ in range(rounds):
            began = time.process_time()
            field = field_of(*mesh, cell=cell, band=band, exact=exact, box=box, far=far)
            laps.append(time.process_time() - began)
        seconds[far] = min(laps)
    rng = np.random.default_rng(0)

    def error(keep: np.ndarray, count: int = 4000) -> np.ndarray:
        index = np.argwhere(keep)
        index = index[rng.choice(len(index), min(count, len(index)), replace=False)]
        points = field.origin + cell * index
        return np.abs(np.abs(field.values[tuple(index.T)]) - metrics.surface_distance(points, *mesh))

    at_band = error(np.abs(field.values) < band)
    far_off = error(np.abs(field.values) > 1.1 * band)
    skin = mesh[0] + 0.004 * normals(*mesh)
    between = np.abs(field.at(skin) - metrics.surface_distance(skin, *mesh))
    return {
        "cell_m": cell,
        "exact_m": exact or 2.5 * cell,
        "nodes": int(field.values.size),
        "seconds_band": seconds[False],
        "seconds_far": seconds[True],
        "node_mean_m": float(at_band.mean()),
        "node_max_m": float(at_band.max()),
        "far_p99_m": float(np.percentile(far_off, 99)),
        "skin_mean_m": float(between.mean()),
        "skin_p99_m": float(np.percentile(between, 99)),
        "skin_max_m": float(between.max()),
    }


def main() -> None:
    """Runs the settings and prints them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two cells, one round")
    parser.add_argument("--json", type=Path, help="where to write the table")
    args = parser.parse_args()
    cells = (0.016, 0.008) if args.quick else (0.016, 0.012, 0.008, 0.006, 0.004)
    field_of(*_small(), cell=0.03, band=0.07)  # compiled before the clock runs
    rows = [measured(cell, 0.05, None, 1 if args.quick else 3) for cell in cells]
    rows.append(measured(0.008, 0.05, 0.05, 1 if args.quick else 3))
    rows.append(measured(0.008, 0.05, None, 1 if args.quick else 3, margin=0.235))  # the same in a wide box
    print("cell exact  nodes     band   + far    nodes: mean / max   far p99   4 mm off: mean / p99 / max")
    for r in rows:
        print(
            f"{r['cell_m'] * 1e3:3.0f}  {r['exact_m'] * 1e3:4.0f} mm {r['nodes'] / 1e6:5.2f} M "
            f"{r['seconds_band']:6.2f} s {r['seconds_far']:6.2f} s   "
            f"{r['node_mean_m'] * 1e3:.4f} / {r['node_max_m'] * 1e3:.2f} mm  "
            f"{r['far_p99_m'] * 1e3:5.1f} mm  {r['skin_mean_m'] * 1e3:.2f} / {r['skin_p99_m'] * 1e3:.2f} / "
            f"{r['skin_max_m'] * 1e3:.2f} mm"
        )
    if args.json:
        args.json.write_text(json.dumps(rows, indent=1) + "\n", "utf-8")


def _small() -> tuple[np.ndarray, np.ndarray]:
    corner = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]], float)
    return corner, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], np.int32)


if __name__ == "__main__":
    main()
