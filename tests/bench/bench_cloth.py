"""Cloth: time and error together, for every published scene.

    simcore bench cloth [-- --quick] [-- --json FILE] [-- --plot FILE.png]
    simcore bench cloth -- --peers …    beside Newton, MuJoCo and Blender, see cloth_against.py

Time error: vertex distance from the engine's own limit dt -> 0 (the run with most substeps; the floor is what half
of them still changes). Mesh error: from the finest mesh, at the same material points
and simulated time. Rows take turns; wall
milliseconds of a frame of 1/25 s, medians. Also told: how the cost grows with the mesh, when two runs of the flag
part (its chaotic horizon), and what two processes do at once beside two spin loops.
"""

import argparse
import json
import multiprocessing
import statistics
import sys
import time
from pathlib import Path

import numpy as np
from cloth_cases import filmed
from cloth_runs import Timed, distance, simulate

from sim_core.cloth.phases import FRAME
from sim_core.cloth.pilot import grid_film
from sim_core.cloth.scenes import Scene, hang_edge, scene

FINEST = 2048


def timed(made: Scene, seconds: float, settings: list, rounds: int, finest: int, undamped: bool) -> dict:
    """Rows of (integrator, substeps), with errors against the limit of most substeps."""
    reference = simulate(made, seconds, substeps=finest, undamped=undamped).positions
    coarser = simulate(made, seconds, substeps=finest // 2, undamped=undamped).positions
    floor = distance(coarser, reference)
    runs: dict[tuple, list[Timed]] = {s: [] for s in settings}
    for _ in range(rounds):
        for integrator, substeps in settings:
            one = simulate(made, seconds, substeps=substeps, integrator=integrator, undamped=undamped)
            runs[integrator, substeps].append(one)
    rows = [
        {
            "integrator": integrator,
            "substeps": ran[0].substeps,
            "adaptive": substeps is None,
            "ms": statistics.median(r.ms for r in ran),
            "error_mm": distance(ran[0].positions, reference),
        }
        for (integrator, substeps), ran in runs.items()
    ]
    return {
        "vertices": len(made.positions),
        "seconds": seconds,
        "reference_substeps": finest,
        "floor_mm": floor,
        "rows": rows,
    }


def meshes(make, size: tuple[float, float], seconds: float, edges: list[float]) -> dict:
    """Distance of coarser meshes from the finest at the same material points, and the order of convergence.

    The order is that of the steps from mesh to mesh, each of half the edge: it needs no limit. `left_mm`: what the
    finest mesh still errs by, if errors go on falling at the last order (at least 1).
    """
    films, rows = [], []
    for edge in edges:
        made = make(edge)
        film, ms, _ = filmed(made, max(1, round(seconds / FRAME)))
        films.append(grid_film(made.sheet, size, film[-1:])[0])
        rows.append({"edge_mm": 1e3 * edge, "vertices": len(made.positions), "ms": ms})
    for row, film in zip(rows, films, strict=True):
        row["error_mm"] = distance(film, films[-1])
    steps = [distance(a, b)["mean"] for a, b in zip(films[:-1], films[1:], strict=True)]
    orders = [float(np.log2(a / b)) for a, b in zip(steps[:-1], steps[1:], strict=True)]
    left = steps[-1] / (2 ** max(orders[-1], 1.0) - 1)
    return {
        "seconds": seconds,
        "finest_mm": 1e3 * edges[-1],
        "rows": rows[:-1],
        "order": orders,
        "left_mm": left,
    }


def growth(counts: list[int], rounds: int = 3) -> dict:
    """Microseconds a substep for sheets of more and more vertices, and the exponent of a line through them.

    Meshes take turns; the least of all frames counts, because others use the machine as well.
    """
    made = [hang_edge(float(np.sqrt(2 / np.sqrt(3) / count))) for count in counts]
    best = [float("inf")] * len(counts)
    for _ in range(rounds):
        for k, one in enumerate(made):
            ran = simulate(one, 0.04 * (8 if counts[k] < 30_000 else 3), substeps=200)
            best[k] = min(best[k], 1e3 * ran.best_ms / 200)
    rows = [{"vertices": len(m.positions), "us": us} for m, us in zip(made, best, strict=True)]
    line = np.polyfit(np.log([r["vertices"] for r in rows]), np.log([r["us"] for r in rows]), 1)
    return {"rows": rows, "exponent": float(line[0])}


def horizon(seconds: float, vertices: int) -> dict:
    """How far two runs of the flag with steps of dt and dt/2 are apart, as time goes on."""
    made = scene("flag", vertices=vertices)
    films = [filmed(made, round(seconds / FRAME), "explicit", n)[0] for n in (256, 512)]
    rows = [
        {"seconds": frame * FRAME, "apart_mm": distance(films[0][frame - 1], films[1][frame - 1])["mean"]}
        for frame in (5, 8, 10, 12, 15, 20, 25, 38, 50)
        if frame <= len(films[0])
    ]
    gone = [r["seconds"] for r in rows if r["apart_mm"] > 1.0]
    return {"rows": rows, "horizon_s": gone[0] if gone else None}


def _work(frames: int) -> float:
    made = hang_edge(0.02)
    simulate(made, 0.04, substeps=200)
    begin = time.perf_counter()
    simulate(made, 0.04 * frames, substeps=200)
    return frames / (time.perf_counter() - begin)


def _spin(count: int) -> float:
    begin, total = time.perf_counter(), 0
    for k in range(count):
        total += k & 3
    return count / (time.perf_counter() - begin)


def together(frames: int, rounds: int = 5) -> dict:
    """Throughput of two processes over that of one, for the engine and for a spin loop: medians of turns."""
    kinds = {"engine": (_work, frames), "spin": (_spin, 20_000_000)}
    ratios: dict[str, list[float]] = {name: [] for name in kinds}
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        for name, (work, _) in kinds.items():
            pool.map(work, [3, 3] if name == "engine" else [1000, 1000], chunksize=1)
        for _ in range(rounds):
            for name, (work, size) in kinds.items():
                one = pool.map(work, [size])[0]
                ratios[name].append(sum(pool.map(work, [size, size], chunksize=1)) / one)
    return {name: statistics.median(found) for name, found in ratios.items()}


def all_of(quick: bool, rounds: int) -> dict:
    """Every figure; `quick` takes coarse meshes, few runs and no growth beyond 3 000 vertices."""
    finest = 512 if quick else FINEST
    count = 600 if quick else None
    explicit = [("explicit", n) for n in ((64, 128) if quick else (180, 256, 400, 560))]
    settings = [("auto", None), *explicit, *(("implicit", n) for n in (1, 8))]
    edge = 0.04 if quick else 0.0134
    simulate(hang_edge(0.2), 0.04)
    published = {
        "hanging by an edge, undamped": (hang_edge(edge), 0.2, True),
        "hanging by an edge": (hang_edge(edge), 1.0, False),
        "hanging by two corners": (scene("hanging", vertices=count), 1.0, False),
        "flag": (scene("flag", vertices=count), 0.4, False),
        "teapot": (scene("teapot", vertices=count), 0.4, False),
    }
    out: dict = {"time": {n: timed(s, t, settings, rounds, finest, u) for n, (s, t, u) in published.items()}}
    edges = [0.08, 0.04, 0.02] if quick else [0.04, 0.02, 0.01, 0.005]
    out["mesh"] = {
        "hanging by an edge": meshes(hang_edge, (1.0, 1.0), 0.4, edges),
        "flag": meshes(lambda e: scene("flag", vertices=_count(1.5, e)), (1.5, 1.0), 0.2, edges),
    }
    out["growth"] = growth([300, 1000, 3000] if quick else [1000, 3000, 10_000, 30_000, 100_000])
    out["flag horizon"] = horizon(0.4 if quick else 2.0, count or 6182)
    out["two processes"] = together(60 if quick else 200)
    return out


def _count(area: float, edge: float) -> int:
    return round(area * 2 / np.sqrt(3) / edge**2)


def tell(found: dict) -> None:
    """Prints the tables."""
    for name, result in found["time"].items():
        floor = result["floor_mm"]
        print(f"{name}: {result['vertices']} vertices, after {result['seconds']} s")
        print(f"  limit at {result['reference_substeps']} substeps, floor {floor['mean']:.1e} mm mean")
        print("  integrator  substeps   ms/frame   stretch    error mean / 99 % / max [mm]")
        for row in result["rows"]:
            e, mark = row["error_mm"], "*" if row["adaptive"] else " "
            errors = f"{e['mean']:.2e} / {e['p99']:.2e} / {e['max']:.2e}"
            cost = f"{row['ms']:10.1f} {row['ms'] / 40:9.2f}"
            print(f"  {row['integrator']:10s} {row['substeps']:8.0f}{mark} {cost}    {errors}")
    for name, result in found["mesh"].items():
        print(f"{name}, mesh error after {result['seconds']} s against {result['finest_mm']:.0f} mm:")
        for row in result["rows"]:
            e = row["error_mm"]
            size = f"{row['edge_mm']:5.0f} mm {row['vertices']:7d} vertices {row['ms']:8.1f} ms"
            print(f"  {size}   {e['mean']:.2f} / {e['max']:.2f} mm")
        orders = ", ".join(f"{o:.2f}" for o in result["order"])
        print(f"  order {orders}; the finest still errs by about {result['left_mm']:.2f} mm")
    for row in found["growth"]["rows"]:
        print(f"  {row['vertices']:7d} vertices {row['us']:8.1f} us a substep")
    print(f"  exponent {found['growth']['exponent']:.3f}")
    apart = ", ".join(f"{r['seconds']:.1f} s {r['apart_mm']:.3g}" for r in found["flag horizon"]["rows"])
    print(f"flag, dt against dt/2, mm: {apart}; chaotic from {found['flag horizon']['horizon_s']} s")
    two = found["two processes"]
    print(f"two processes: {two['engine']:.2f} of one; a spin loop {two['spin']:.2f}")


def plot(found: dict, path: Path) -> None:
    """Speed against error, one panel a scene."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, panels = pyplot.subplots(
        1, len(found["time"]), figsize=(4 * len(found["time"]), 3.6), sharey=True
    )
    for panel, (name, result) in zip(np.atleast_1d(panels), found["time"].items(), strict=True):
        for kind, mark in (("explicit", "o"), ("auto", "s"), ("implicit", "^")):
            rows = [r for r in result["rows"] if r["integrator"] == kind and r["error_mm"]["mean"] < 1e4]
            panel.loglog(
                [r["ms"] for r in rows], [r["error_mm"]["mean"] for r in rows], mark + "-", label=kind
            )
        panel.axvline(40, color="0.7", lw=1)
        panel.set(title=name, xlabel="ms a frame (40 = real time)")
    np.atleast_1d(panels)[0].set_ylabel("mean vertex error [mm]")
    np.atleast_1d(panels)[0].legend()
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main() -> int:
    if "--peers" in sys.argv[1:]:
        from cloth_against import main as against

        return against()
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="coarse meshes")
    parser.add_argument("--rounds", type=int, default=3, help="runs of every setting, in turns (default: 3)")
    parser.add_argument("--json", type=Path, help="write the figures as JSON")
    parser.add_argument("--plot", type=Path, help="draw speed against error (needs matplotlib)")
    args = parser.parse_args()
    found = all_of(args.quick, args.rounds)
    tell(found)
    if args.json:
        args.json.write_text(json.dumps(found, indent=2))
    if args.plot:
        plot(found, args.plot)
    return 0


if __name__ == "__main__":
    sys.exit(main())
