"""The tables of the learn room's README, written from what the bench measured; nothing is typed in but the paper's.

python tests/bench/bench_learn.py FOLDER --json docs/figures/learn.json
python tests/bench/readme_learn.py
"""

from __future__ import annotations

import json
import statistics
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
BEGIN, END = "<!-- figures: python tests/bench/readme_learn.py -->", "<!-- end of figures -->"
NAMES = {
    "reference": "gate: fine physics at half its time step",
    "physics": "fine physics at its quickest",
    "physics_70": "that on .7 of the vertices, smooth between",
    "physics_50": "on .5",
    "physics_35": "on .35",
    "coarse": "coarse physics, as it is",
    "linear": "coarse physics, linear",
    "biharmonic": "coarse physics, biharmonic",
    "local_frames": "local frames, regression",
    "mfsr": "MFSR (geometry images)",
    "mesh_conv": "mesh convolution, quadric pooling",
    "paper": "the paper's",
    "ours": "ours",
}
# Table 1 of the paper: Hausdorff distance [its units, said to be mm] and seconds a frame.
PUBLISHED = {
    "flag": ((2.483, 55.39), (3.476, 4.07), (2.527, 3.88), (2.381, 3.62)),
    "teapot": ((5.412, 45.74), (6.484, 3.42), (5.812, 3.55), (5.318, 2.84)),
    "hanging": ((5.382, 57.61), (6.021, 3.82), (5.532, 3.70), (5.343, 3.31)),
}
PUBLISHED_ROWS = ("physics", "MFSR", "mesh convolution", "paper")
PLAIN = ("linear", "biharmonic", "local_frames")
PHYSICS = ("physics_35", "physics_50", "physics_70", "physics")


def spread(rows: list[dict[str, Any]], key: str, digits: int) -> str:
    """The mean over seeds, and the least and the most of several."""
    values = [row[key] for row in rows]
    told = f"{statistics.mean(values):.{digits}f}"
    return told if len(values) == 1 else f"{told} ({min(values):.{digits}f}–{max(values):.{digits}f})"


def scene_table(scene: str, one: dict[str, Any]) -> list[str]:
    data = one["data"]
    lines = [
        f"**{scene}**: {data['sequences']} sequences, {data['frames']:,} frames, {data['coarse_vertices'][0]:,} → "
        f"{data['fine_vertices'][0]:,} vertices; coarse physics {data['coarse_ms']:.1f} ms a frame, fine "
        f"{data['fine_ms']:.0f} ms; {one['cores']} cores ({one['machine']}), each command on one",
        "",
        "| row | mean [mm] | Hausdorff [mm] | p95 [mm] | normals | strain | crossings | network [ms] | whole [ms] |",
        "|-|-|-|-|-|-|-|-|-|",
    ]
    for name, title in NAMES.items():
        rows = one["rows"].get(name)
        if rows:
            lines.append(
                f"| {title} | {spread(rows, 'mean_mm', 3)} | {spread(rows, 'hausdorff_mm', 2)} | "
                f"{spread(rows, 'p95_mm', 2)} | {spread(rows, 'normal_deg', 2)}° | {spread(rows, 'strain', 3)} | "
                f"{crossings(rows[0])} | {spread(rows, 'net_ms', 1)} | {spread(rows, 'total_ms', 1)} |"
            )
    published = zip(PUBLISHED_ROWS, PUBLISHED[scene], strict=True)
    told = ", ".join(f"{name} {far:g} and {seconds:g} s" for name, (far, seconds) in published)
    return [
        *lines,
        "",
        *([gate(one["gate"]), ""] if "gate" in one else []),
        f"The paper's own figures for a scene of this name (other data, other machine): {told}.",
        "",
    ]


def crossings(row: dict[str, Any]) -> str:
    """Pairs of faces that cross, a frame, and of the fine film."""
    return f"{row['intersections']:g} ({row['reference_intersections']:g})"


def gate(found: dict[str, Any]) -> str:
    """Of how many frames the reference is good for every row."""
    words = {True: "passed", False: "not passed", None: "not decided"}[found["passed"]]
    each = ", ".join(
        f"{name} {one['counting']} of {one['whole']}" for name, one in found["sequences"].items()
    )
    return f"Gate {words}. Frames whose floor is a third or less of every row's error: {each}."


def times_as_long(milliseconds: float, whole: float) -> str:
    return f"{milliseconds:.0f} ms, {milliseconds / whole:.1f} times as long"


def as_near(rows: dict[str, list[dict[str, Any]]], whole: float) -> str:
    """The cheapest physics that is as near as ours by its mean."""
    ours = statistics.mean(row["mean_mm"] for row in rows["ours"])
    for name in PHYSICS:
        if name in rows and rows[name][0]["mean_mm"] <= ours:
            return f"{NAMES[name]}: {times_as_long(rows[name][0]['total_ms'], whole)}"
    return "none that was tried"


def compared(found: dict[str, Any]) -> list[str]:
    """How far ours is from the best without a network, and whether a frame pays: against the reference, and against
    the cheapest physics whose mean error is no greater."""
    lines = [
        "| scene | mean against the best without network | Hausdorff | network | whole | reference | physics as near |",
        "|-|-|-|-|-|-|-|",
    ]
    for scene, one in found["scenes"].items():
        rows = one["rows"]
        if "ours" not in rows:
            continue
        change = []
        for key in ("mean_mm", "hausdorff_mm"):
            best = min(statistics.mean(row[key] for row in rows[name]) for name in PLAIN if name in rows)
            change.append(100 * (statistics.mean(row[key] for row in rows["ours"]) / best - 1))
        net, whole = (statistics.mean(row[key] for row in rows["ours"]) for key in ("net_ms", "total_ms"))
        lines.append(
            f"| {scene} | {change[0]:+.0f} % | {change[1]:+.0f} % | {net:.1f} ms | {whole:.1f} ms | "
            f"{times_as_long(one['rows']['reference'][0]['total_ms'], whole)} | {as_near(rows, whole)} |"
        )
    return lines


def reconstruction(found: dict[str, Any]) -> list[str]:
    """The paper's own task: the fine mesh from a share of its vertices."""
    lines = [
        "| scene | from | " + " | ".join(("linear", "biharmonic", "local frames", "ours")) + " |",
        "|-|-|-|-|-|-|",
    ]
    for scene, one in found["scenes"].items():
        for share, rows in one.get("reconstructed", {}).items():
            each = (
                f"{rows[name]['mean_mm']:.3f} / {rows[name]['hausdorff_mm']:.2f}" if name in rows else ""
                for name in ("linear", "biharmonic", "local_frames", "ours")
            )
            lines.append(f"| {scene} | {float(share):.0%} | " + " | ".join(each) + " |")
    return lines


def tables(found: dict[str, Any]) -> list[str]:
    lines = []
    for scene, one in found["scenes"].items():
        lines += scene_table(scene, one)
    lines += compared(found)
    if any(one.get("reconstructed") for one in found["scenes"].values()):
        lines += [
            "",
            "Reconstruction from a share of the fine vertices, mean and Hausdorff distance [mm]:",
            "",
        ]
        lines += reconstruction(found)
    return lines


def main() -> int:
    found = json.loads((ROOT / "docs/figures/learn.json").read_text("utf-8"))
    path = ROOT / "sim_core/learn/README.md"
    before, rest = path.read_text("utf-8").split(BEGIN)
    lines = tables(found)
    path.write_text(before + BEGIN + "\n\n" + "\n".join(lines) + "\n\n" + END + rest.split(END)[1], "utf-8")
    print("\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
