"""Meshing: time and error together, beside Qhull (scipy) and the paper's naive growth, in one interleaved run.

    python tests/bench/bench_mesh.py [--quick] [--large] [--json FILE]

Every engine triangulates the same staggered points of one half robe; rounds alternate between the engines and the
median is told. Error: |area - polygon area| / polygon area after dropping what lies outside (Qhull fills the convex
hull), zero-area triangles, and outline steps that are no mesh edge. Then whole panels, with their quality.
"""

import argparse
import json
import statistics
import sys
from pathlib import Path
from time import perf_counter

import numpy as np
from scipy.spatial import Delaunay

from sim_core.mesh import inside, keep_points, panel_mesh, quality, staggered_points, triangulate
from sim_core.mesh.naive import grow_naive
from sim_core.mesh.outline import clean_contours, signed_area
from sim_core.mesh.quality import triangle_areas
from sim_core.mesh.sampling import sampled_contours

NAIVE_LIMIT = 7000
ROUNDS = 3
TURN = np.arange(64) * 2 * np.pi / 64
ROUND = np.column_stack([np.cos(TURN), np.sin(TURN)])


def half_robe() -> np.ndarray:
    t = np.linspace(0, 1, 15)[:, None]
    neck = 0.09 * np.column_stack([np.sin(t * np.pi / 2), np.cos(t * np.pi / 2)])
    a, b, c, d = np.array([[0.35, 0.32], [0.27, 0.33], [0.26, 0.36], [0.27, 0.45]])
    arm = (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d
    return np.vstack([neck, [[0.75, 0.02], [0.75, 0.3]], arm, [[0.38, 1.2], [0, 1.22]]])


PANELS = {
    "rectangle": (np.array([[0, 0], [1, 0], [1, 0.7], [0, 0.7]]), ()),
    "half robe": (half_robe(), ()),
    "hole": (np.array([[0.2, 0], [0.8, 0], [1, 0.9], [0, 0.9]]), (0.15 * ROUND + (0.5, 0.45),)),
}


def point_set(edge: float):
    contours = clean_contours(half_robe(), ())
    samples = sampled_contours(contours, edge)
    lattice = staggered_points(samples[0].min(axis=0), samples[0].max(axis=0), edge)
    points = np.concatenate([*samples, keep_points(lattice, samples, edge=edge)])
    loop = np.arange(len(samples[0]))
    return points, np.column_stack([loop, np.roll(loop, -1)]), samples


def engines(points, steps, samples):
    """Name -> function that returns the faces inside the outline."""

    def culled(faces):
        return faces[inside(points[faces].mean(axis=1), samples)]

    made = {
        "growth, grid": lambda: triangulate(points, steps),
        "Qhull (scipy)": lambda: culled(Delaunay(points).simplices),
    }
    if len(points) <= NAIVE_LIMIT:
        made["growth, naive"] = lambda: culled(grow_naive(points))
    return made


def errors(points, faces, steps, samples) -> dict:
    wanted = sum(signed_area(loop) for loop in samples)
    areas = np.abs(triangle_areas(points, faces))
    edges = {
        tuple(e)
        for e in np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    }
    lost = sum(tuple(sorted(step)) not in edges for step in steps.tolist())
    return {
        "faces": len(faces),
        "area_error": abs(float(areas.sum()) - wanted) / wanted,
        "slivers": int((areas < 1e-9 * areas.mean()).sum()),
        "outline_steps_lost": int(lost),
        "min_angle_deg": float(quality(points, faces).min_angle.min()),
    }


def compare(edge: float) -> list[dict]:
    points, steps, samples = point_set(edge)
    runs = engines(points, steps, samples)
    times = {name: [] for name in runs}
    faces = {}
    for _ in range(ROUNDS):
        for name, run in runs.items():
            begin = perf_counter()
            faces[name] = run()
            times[name].append(perf_counter() - begin)
    own = statistics.median(times["growth, grid"])
    return [
        {
            "engine": name,
            "points": len(points),
            "seconds": statistics.median(times[name]),
            "ratio": statistics.median(times[name]) / own,
            **errors(points, np.asarray(faces[name]), steps, samples),
        }
        for name in runs
    ]


def panels(edges) -> list[dict]:
    rows = []
    for name, (outline, holes) in PANELS.items():
        for edge in edges:
            mesh = panel_mesh(outline, edge=edge, holes=holes)
            rows.append(
                {"panel": name, "edge": edge, "vertices": len(mesh.vertices), **mesh.report.to_dict()}
            )
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="up to 6 000 points")
    parser.add_argument("--large", action="store_true", help="also a million points")
    parser.add_argument("--json", type=Path, help="write the figures as JSON")
    args = parser.parse_args()
    edges = [0.0141, 0.01] if args.quick else [0.0141, 0.01, 0.0045, 0.00245]
    edges += [0.000774] if args.large else []
    compare(0.05)  # compile
    rows = [row for edge in edges for row in compare(edge)]
    print(
        f"{'engine':<16}{'points':>9}{'seconds':>10}{'ratio':>8}{'area error':>12}{'slivers':>9}"
        f"{'lost':>6}{'angle':>7}"
    )
    for row in rows:
        print(
            f"{row['engine']:<16}{row['points']:>9}{row['seconds']:>10.4f}{row['ratio']:>8.1f}{row['area_error']:>12.1e}"
            f"{row['slivers']:>9}{row['outline_steps_lost']:>6}{row['min_angle_deg']:>7.1f}"
        )
    whole = panels([0.0141, 0.01] if args.quick else [0.0141, 0.01, 0.0045])
    print(
        f"\n{'panel':<12}{'vertices':>9}{'seconds':>10}{'angle':>7}{'q mean':>8}{'er mean':>9}{'area error':>12}"
    )
    for row in whole:
        print(
            f"{row['panel']:<12}{row['vertices']:>9}{row['seconds']:>10.4f}{row['min_angle_deg']:>7.1f}"
            f"{row['mean_quality']:>8.4f}{row['mean_edge_ratio']:>9.4f}{row['area_error']:>12.1e}"
        )
    if args.json:
        args.json.write_text(json.dumps({"engines": rows, "panels": whole}, indent=2) + "\n", "utf-8")
    failed = [
        r
        for r in rows
        if r["engine"] == "growth, grid" and (r["area_error"] > 1e-12 or r["outline_steps_lost"])
    ]
    return 1 if failed or any(row["area_error"] > 1e-12 for row in whole) else 0


if __name__ == "__main__":
    sys.exit(main())
