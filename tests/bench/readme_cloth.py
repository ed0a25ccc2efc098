"""What the bench measured, written into the cloth room's README (headline) and DETAILS (all); nothing is typed in.

simcore bench cloth --json docs/figures/cloth.json --plot docs/pictures/cloth-speed-error.png
python tests/bench/readme_cloth.py
"""

import json
import sys
from pathlib import Path

from signature import parts

ROOT = Path(__file__).parents[2]
ROOM = ROOT / "sim_core/cloth"
BEGIN, END = "<!-- figures: python tests/bench/readme_cloth.py -->", "<!-- end of measured -->"
HEAD = "<!-- headline: python tests/bench/readme_cloth.py -->", "<!-- end of headline -->"
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


def headline(found: dict) -> str:
    """The figures that were asked for, beside what was asked; those that were asked to be told, told."""
    lines = [f"{found['processor']}, one core, processor time; a frame is 1/25 s.", ""]
    lines += ["| | asked | measured |", "|-|-|-|"]
    for name, aim in AIMS.items():
        part = found["time"][name]
        row = next(row for row in part["rows"] if row["own"])
        e = row["error_mm"]
        lines.append(
            f"| {name}, {part['vertices']:,} vertices, time error after {part['seconds']:g} s | {aim} | "
            f"{row['ms']:.1f} ms, {short(e['mean'])} mm mean, {short(e['max'])} largest |"
        )
    for name, part in found["mesh"].items():
        rows = ", ".join(f"{r['edge_mm']:g} mm {r['from_finest_mm']['mean']:.2f}" for r in part["rows"][:-1])
        orders = " and ".join(f"{o:.2f}" for o in part["order"])
        finest = f"{part['rows'][-1]['edge_mm']:g} mm"
        lines.append(
            f"| mesh error, {name}, {part['seconds']:g} s, mm mean from edges of {finest} | told | "
            f"{rows}; order {orders} |"
        )
    gone = found["horizon"]["horizon_s"]
    lines.append(f"| chaos horizon of the flag, dt and dt/2 a millimetre apart | told | {gone:g} s |")
    growth, two = found["growth"], found["processes"]
    sizes = f"{growth['rows'][0]['vertices']:,} to {growth['rows'][-1]['vertices']:,}"
    lines.append(f"| exponent of time a step, {sizes} vertices | ≤ 1.1 | {growth['exponent']:.2f} |")
    lines.append(
        f"| two processes, times the work of one | ≥ 1.8 where a spin loop does | {two['engine']['ratio']:.2f}, "
        f"spin loop {two['spin']['ratio']:.2f} |"
    )
    starts = ", ".join(f"{r['scene']} {r['wall_s']:.2f} s" for r in found["start"]["rows"])
    lines.append(f"| second start of `simcore cloth`, call to end | ≤ 2 s | {starts} |")
    kept = [f"{row['kept']} of {row['of']} (seed {seed})" for seed, row in found["choose"].items()]
    lines.append(
        f"| `choose`: scenes the table has not seen, within the budget | ≥ 19 of 20 | {', '.join(kept)} |"
    )
    return "\n".join(lines)


PARTS = {"time": scenes, "mesh": mesh, "growth": grown, "layers": layered}


def tables(found: dict) -> str:
    """All tables that there are figures for."""
    blocks = ["\n".join(make(found[name])) for name, make in PARTS.items() if name in found]
    blocks += ["\n".join(lone(found))] if lone(found) else []
    return "\n\n".join(blocks)


def placed(path: Path, begin: str, end: str, text: str) -> None:
    """Puts a text between its marks."""
    before, rest = path.read_text("utf-8").split(begin)
    path.write_text(f"{before}{begin}\n{text}\n{end}{rest.split(end)[1]}", "utf-8")


def figures() -> dict:
    """What was measured: the bench's parts, and what `cloth_table.py --check` found, seed by seed."""
    folder = ROOT / "docs/figures"
    found, choose = (
        json.loads((folder / f"{name}.json").read_text("utf-8")) for name in ("cloth", "cloth-choose")
    )
    return found | {"choose": parts(choose)}


def main() -> int:
    found = figures()
    if found["quick"]:
        print(
            "readme_cloth: docs/figures/cloth.json is of --quick – run the bench without it", file=sys.stderr
        )
        return 1
    placed(
        ROOM / "DETAILS.md",
        BEGIN,
        END,
        f"{found['processor']}, one core, processor time.\n\n" + tables(found),
    )
    placed(ROOM / "README.md", *HEAD, headline(found))
    print(headline(found), tables(found), sep="\n\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
