"""The "Measured" tables in the cloth room's README, written from what the bench measured; nothing is typed in.

simcore bench cloth --json docs/figures/cloth.json --plot docs/pictures/cloth-speed-error.png
python tests/bench/readme_cloth.py
"""

import json
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
BEGIN, END = "<!-- figures: python tests/bench/readme_cloth.py -->", "<!-- end of measured -->"
AIMS = {  # ms a frame, mean and largest mm: of the issue
    "hanging by an edge": "≤ 60 ms [40], ≤ .01 mm",
    "hanging by two corners": "≤ 60 ms [40], ≤ .02 / .2 mm",
    "flag": "≤ 60 ms [40], ≤ .5 mm",
    "teapot": "≤ 40 ms [30]",
}


def short(value: float) -> str:
    """Two digits, without a leading zero."""
    text = f"{value:.2g}" if value < 100 else f"{value:.0f}"
    return text[1:] if text.startswith("0.") else text


def scenes(found: dict) -> list[str]:
    """A row for every adaptive setting of every scene, and one of the implicit scheme."""
    lines = [
        "| scene | vertices | setting | substeps | ms a frame (quartiles) | after "
        "| error mean / 99 % / largest, mm | aim |",
        "|-|-|-|-|-|-|-|-|",
    ]
    for name, result in found.items():
        for row in result["rows"]:
            if not row["adaptive"] and not (row["integrator"] == "implicit" and row["substeps"] == 8):
                continue
            low, high = row["quartiles_ms"]
            e = row["error_mm"]
            errors = " / ".join(short(e[k]) for k in ("mean", "p99", "max"))
            lines.append(
                f"| {name} | {result['vertices']:,} | {row['setting']} | {row['substeps']:.0f} | "
                f"{row['ms']:.1f} ({low:.1f} to {high:.1f}) | {result['seconds']:g} s | {errors} | "
                f"{AIMS.get(name, '') if row['own'] else ''} |"
            )
    first = next(iter(found.values()))
    floors = ", ".join(f"{name} {short(r['floor_mm']['mean'])}" for name, r in found.items())
    lines += [
        "",
        f"Limits: {first['reference_substeps']:,} substeps; half of them change by, mm mean: {floors}.",
    ]
    return lines


def mesh(found: dict) -> list[str]:
    """Mesh errors and orders."""
    edges = [f"{r['edge_mm']:g} mm" for r in next(iter(found.values()))["rows"]]
    lines = [
        f"| mesh error, mm mean (largest) from edges of {edges[-1]} | after | {' | '.join(edges[:-1])} "
        f"| order, mesh to mesh | {edges[-1]} itself still errs by |",
        "|-|-|" + "-|" * (len(edges) + 1),
    ]
    for name, part in found.items():
        cells = [
            f"{r['from_finest_mm']['mean']:.2f} ({r['from_finest_mm']['max']:.1f})" for r in part["rows"][:-1]
        ]
        orders = ", ".join(f"{o:.2f}" for o in part["order"])
        lines.append(
            f"| {name} | {part['seconds']:g} s | {' | '.join(cells)} | {orders} | {part['left_mm']:.2f} mm |"
        )
    return lines


def grown(found: dict) -> list[str]:
    """Cost against the size of the mesh."""
    lines = [
        "| vertices | "
        + " | ".join(f"{r['vertices']:,}" for r in found["rows"])
        + " | exponent (aim ≤ 1.1) |"
    ]
    lines.append("|-|" + "-|" * (len(found["rows"]) + 1))
    lines.append(
        "| µs a substep | "
        + " | ".join(f"{r['us']:.3g}" for r in found["rows"])
        + f" | {found['exponent']:.2f} |"
    )
    lines.append(
        "| ns a vertex and substep | "
        + " | ".join(f"{r['ns_per_vertex']:.1f}" for r in found["rows"])
        + " | |"
    )
    return lines


def lone(found: dict) -> list[str]:
    """What is one figure each: horizon, two processes, second start."""
    lines = []
    if "horizon" in found:
        part = found["horizon"]
        apart = ", ".join(f"{r['seconds']:g} s {short(r['apart_mm'])}" for r in part["rows"])
        gone = part["horizon_s"]
        end = f"chaotic from {gone:g} s on" if gone else "not chaotic yet"
        lines.append(f"- Flag, runs with dt and dt/2 apart, mm mean: {apart}; by a millimetre, {end}.")
    if "processes" in found:
        two, spin = found["processes"]["engine"], found["processes"]["spin"]
        lines.append(
            f"- Two processes do {two['ratio']:.2f} times the work of one "
            f"({two['range'][0]:.2f} to {two['range'][1]:.2f}; "
            f"aim ≥ 1.8 where a spin loop does), two spin loops {spin['ratio']:.2f} times."
        )
    if "start" in found:
        each = ", ".join(
            f"{r['scene']} {r['wall_s']:.2f} s ({r['cpu_s']:.2f} s of processor; the frame itself {r['frame_s']:.2f} s)"
            for r in found["start"]["rows"]
        )
        lines.append(f"- A second `simcore cloth SCENE --frames 1`, call to end (aim ≤ 2 s): {each}.")
    return lines


def layered(found: dict) -> list[str]:
    """Teapot with self-contact."""
    lines = [
        f"| teapot, {found['frames']} frames, {found['vertices']:,} vertices | ms a frame (quartiles) "
        "| (edge, face) crossings |",
        "|-|-|-|",
    ]
    for row in found["rows"]:
        low, high = row["quartiles_ms"]
        name = f"case {row['case']}, " + (
            f"--layers {row['layers_mm']:g}" if row["layers_mm"] else "as it is"
        )
        lines.append(f"| {name} | {row['ms']:.1f} ({low:.1f} to {high:.1f}) | {row['crossings']} |")
    return lines


PARTS = {"time": scenes, "mesh": mesh, "growth": grown, "layers": layered}


def tables(found: dict) -> str:
    """All tables that there are figures for."""
    blocks = ["\n".join(make(found[name])) for name, make in PARTS.items() if name in found]
    blocks += ["\n".join(lone(found))] if lone(found) else []
    return "\n\n".join(blocks)


def main() -> int:
    found = json.loads((ROOT / "docs/figures/cloth.json").read_text("utf-8"))
    if found["quick"]:
        print(
            "readme_cloth: docs/figures/cloth.json is of --quick – run the bench without it", file=sys.stderr
        )
        return 1
    path = ROOT / "sim_core/cloth/README.md"
    before, rest = path.read_text("utf-8").split(BEGIN)
    head = f"{found['processor']}, one core, processor time.\n\n"
    path.write_text(before + BEGIN + "\n" + head + tables(found) + "\n" + END + rest.split(END)[1], "utf-8")
    print(tables(found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
