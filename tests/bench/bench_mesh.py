"""Meshing: time and error together, beside Qhull, Triangle, gmsh and the paper's naive growth, in one interleaved run.

    simcore bench mesh -- [--quick | --large] [--peers [FOLDER]] [--json FILE] [--plot FILE.png]

growth    Every engine triangulates the same filtered points of three outlines; rounds alternate between the engines.
          Error: |area - polygon area| / polygon area, zero-area triangles, and outline steps that are no mesh edge,
          after dropping what lies outside (Qhull fills the convex hull; the dropping is not timed).
panels    Outline in, checked mesh out, beside gmsh's Frontal-Delaunay on the same outline steps.
growing   Stars, combs, spirals and clusters of holes of ever more points, and small holes at long edges: time by the
          number of vertices, angles below 30 degrees, and counts beside Triangle's (`mesh_growing.py`).
corners   Lines that cross at any angle: vertices, shortest sides, small angles beside Triangle's (`mesh_corners.py`).
cloth     How far the sheet that hangs by one edge is from the converged one, by the edge length of its mesh.

Triangle and gmsh are no dependencies: `--peers` makes an environment of their own from tests/bench/peers.txt (in
build/peers, or FOLDER) and runs them there. The ratio of an engine is its time divided by growth's (or best's) in the
same round: median, least and greatest over the rounds. --add puts further parts into the --json file that is there.
"""

import argparse
import json
import statistics
import subprocess
import sys
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from mesh_cases import PANELS, PointSet, edge_for, errors, shape
from mesh_figures import added, exponent, growing_exponents
from peers import Peers, add_peers, peer_python
from scipy.spatial import Delaunay
from signature import signed

from sim_core.mesh import panel_mesh, triangulate

sys.path.append(str(Path(__file__).parents[1]))
from naive_growth import grow_naive  # noqa: E402

ROOT = Path(__file__).parents[2]
NAIVE_LIMIT, QHULL_LIMIT, GMSH_LIMIT = 7000, 1_100_000, 150_000
SIZES = {"quick": [3000, 6000], "usual": [3000, 10_000, 30_000, 100_000], "large": [1_000_000, 2_000_000]}


def timed(run) -> tuple[float, Any]:
    begin = perf_counter()
    found = run()
    return perf_counter() - begin, found


def growth_engines(case: PointSet, peers: Peers | None) -> dict:
    """Name -> function returning (seconds, vertices, faces)."""
    points = case.points

    def own():
        seconds, faces = timed(lambda: triangulate(points, case.steps))
        return seconds, points, faces

    def qhull():
        seconds, found = timed(lambda: Delaunay(points))
        return seconds, points, case.culled(found.simplices)

    def naive():
        seconds, faces = timed(lambda: grow_naive(points, case.steps))
        return seconds, points, faces

    def triangle():
        assert peers is not None
        made = peers.run("triangle", points=points, steps=case.steps, inside_holes=case.inside_holes)
        return made["seconds"], made["vertices"], made["faces"]

    made = {"growth": own}
    if len(points) <= QHULL_LIMIT:
        made["Qhull"] = qhull
    if peers:
        made["Triangle p"] = triangle
    if len(points) <= NAIVE_LIMIT:
        made["growth, naive"] = naive
    return made


def growth(sizes: list[int], panels: list[str], peers: Peers | None) -> list[dict]:
    rows = []
    for panel in panels:
        for size in sizes:
            case = PointSet(panel, edge_for(panel, size))
            runs = growth_engines(case, peers)
            times: dict[str, list[float]] = {name: [] for name in runs}
            found = {}
            for turn in range(7 if size <= 30_000 else 5):
                for name, run in runs.items():
                    if name in ("Qhull", "growth, naive") and turn >= (3 if size <= 100_000 else 2):
                        continue  # seconds long: what they cost is plain after few rounds
                    seconds, vertices, faces = run()
                    times[name].append(seconds)
                    found[name] = errors(vertices, np.asarray(faces), case)
            for name, spent in times.items():
                ratios = [t / own for t, own in zip(spent, times["growth"], strict=False)]
                rows.append({"panel": panel, "engine": name, "points": len(case.points)})
                rows[-1].update(spread(spent, ratios), **found[name])
                tell_growth(rows[-1])
    return rows


def spread(seconds: list[float], ratios: list[float]) -> dict:
    """Least and median time, and the ratio's median, least and greatest."""
    return {
        "seconds": min(seconds),
        "seconds_median": statistics.median(seconds),
        "rounds": len(seconds),
        "ratio": statistics.median(ratios),
        "ratio_least": min(ratios),
        "ratio_most": max(ratios),
    }


def tell_growth(row: dict) -> None:
    print(
        f"{row['panel']:<11}{row['engine']:<14}{row['points']:>9}{row['seconds']:>10.4f} s{row['ratio']:>9.2f} x"
        f"{row['area_error']:>10.1e}{row['slivers']:>7}{row['outline_steps_lost']:>5}",
        flush=True,
    )


MEMORY = """
import re, sys
from pathlib import Path
sys.path.insert(0, {bench!r})
import numpy as np
from mesh_cases import PointSet, edge_for
from sim_core.mesh import triangulate

def kilobytes(name):
    return int(re.search(name + r":\\s+(\\d+)", Path("/proc/self/status").read_text()).group(1))

small = PointSet("rectangle", edge_for("rectangle", 2000))
triangulate(small.points, small.steps)
points = np.load({points!r})
steps = np.load({steps!r})
Path("/proc/self/clear_refs").write_text("5")  # the greatest resident size counts from here
before = kilobytes("VmRSS")
triangulate(points, steps)
print((kilobytes("VmHWM") - before) * 1024 / len(points))
"""


def memory(size: int) -> dict | None:
    """Bytes a point that growth adds to the greatest resident size of a fresh process; None where no Linux tells."""
    from tempfile import TemporaryDirectory

    if not Path("/proc/self/clear_refs").exists():
        return None
    case = PointSet("rectangle", edge_for("rectangle", size))
    with TemporaryDirectory() as folder:
        points, steps = f"{folder}/points.npy", f"{folder}/steps.npy"
        np.save(points, case.points)
        np.save(steps, case.steps)
        program = MEMORY.format(bench=str(Path(__file__).parent), points=points, steps=steps)
        told = subprocess.run(
            [sys.executable, "-c", program], check=True, capture_output=True, text=True, cwd=ROOT
        )
    return {"points": len(case.points), "bytes_a_point": float(told.stdout)}


def panels(sizes: list[int], names: list[str], peers: Peers | None) -> list[dict]:
    rows = []
    for name in names:
        outline, holes = PANELS[name]
        for size in sizes:
            edge = edge_for(name, size)
            case = PointSet(name, edge)
            times: dict[str, list[float]] = {}
            found = {}
            for _ in range(5 if size <= 100_000 else 2):
                for kind in ("fair", "best"):
                    seconds, mesh = timed(partial(panel_mesh, outline, edge=edge, holes=holes, quality=kind))
                    times.setdefault(kind, []).append(seconds)
                    figures = {key: getattr(mesh.report, key) for key in ("area_error", "conformity")}
                    found[kind] = {**shape(mesh.vertices, mesh.faces), **figures}
                if peers and size <= GMSH_LIMIT:
                    samples = np.concatenate(case.samples) * (1, -1)
                    made = peers.run("gmsh", points=samples, lengths=case.lengths, edge=np.float64(edge))
                    times.setdefault("gmsh", []).append(made["seconds"])
                    found["gmsh"] = shape(made["vertices"] * (1, -1), made["faces"])
            for kind, spent in times.items():
                ratios = [t / own for t, own in zip(spent, times["best"], strict=True)]
                rows.append({"panel": name, "engine": kind, "edge": edge})
                rows[-1].update(spread(spent, ratios), **found[kind])
                tell_panel(rows[-1])
    return rows


def tell_panel(row: dict) -> None:
    print(
        f"{row['panel']:<11}{row['engine']:<6}{row['vertices']:>9}{row['seconds']:>10.4f} s{row['ratio']:>8.2f} x"
        f"  angle {row['min_angle_deg']:>5.1f}  q {row['mean_quality']:.4f} worst {row['worst_quality']:.3f}"
        f"  er {row['mean_edge_ratio']:.4f}",
        flush=True,
    )


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="up to 6 000 points")
    parser.add_argument("--large", action="store_true", help="one and two million points too")
    parser.add_argument("--sizes", nargs="+", type=int, metavar="N", help="these numbers of points instead")
    add_peers(parser, "with Triangle and gmsh")
    parser.add_argument(
        "--only", choices=("growth", "panels", "growing", "corners", "cloth"), help="one part"
    )
    parser.add_argument("--panel", choices=tuple(PANELS), help="one outline")
    parser.add_argument("--json", type=Path, help="write the figures as JSON")
    parser.add_argument(
        "--add", action="store_true", help="keep what the --json file holds of other parts and sizes"
    )
    parser.add_argument("--plot", type=Path, metavar="FILE.png", help="draw time against points and quality")
    args = parser.parse_args()
    sizes = SIZES["quick"] if args.quick else SIZES["usual"] + (SIZES["large"] if args.large else [])
    sizes = args.sizes or sizes
    names = [args.panel] if args.panel else list(PANELS)
    peers = Peers(peer_python(args.peers)) if args.peers else None
    figures: dict = {}
    warm = PointSet("hole", 0.05)
    triangulate(warm.points, warm.steps)
    grow_naive(warm.points, warm.steps)
    for kind in ("fair", "best"):
        panel_mesh(PANELS["hole"][0], edge=0.05, holes=PANELS["hole"][1], quality=kind)
    if args.only in (None, "growth"):
        figures["growth"] = growth(sizes, names, peers)
        figures["memory"] = memory(max(sizes))
        print(f"time grows as points to the power {exponent(figures['growth'])}; {figures['memory']}")
    if args.only in (None, "panels"):
        figures["panels"] = panels(sizes, names, peers)
    if args.only in (None, "growing"):
        from mesh_growing import SIZES as GROWING
        from mesh_growing import grading, growing

        figures["growing"] = growing(GROWING["quick" if args.quick else "usual"], peers)
        figures["grading"] = grading([100] if args.quick else [100, 400, 1600], peers)
        print(f"time grows as vertices to the power {growing_exponents(figures['growing'])}")
    if args.only in (None, "corners"):
        from mesh_corners import corners

        figures["corners"] = corners(1 if args.quick else 8, peers)
    if args.only in (None, "cloth"):
        from mesh_cloth import hanging

        figures["cloth"] = hanging(quick=args.quick)
    if peers:
        peers.close()
    if args.json:
        made = list(figures)
        if args.add and args.json.is_file():
            figures = added(json.loads(args.json.read_text("utf-8")), figures)
        figures = signed(figures, made)
        args.json.parent.mkdir(parents=True, exist_ok=True)
        args.json.write_text(json.dumps(figures, indent=1) + "\n", "utf-8")
    if args.plot:
        from mesh_plot import plot

        plot(figures, args.plot)
    own = [r for r in figures.get("growth", []) if r["engine"] == "growth"]
    own += [r for r in figures.get("panels", []) if r["engine"] != "gmsh"]
    return 1 if any(r["area_error"] > 1e-12 or r.get("outline_steps_lost") for r in own) else 0


if __name__ == "__main__":
    sys.exit(main())
