"""The peers' figures as tables: python tests/bench/cloth_peer_tables.py writes them from docs/figures.

All of them stand in cloth_peers/README.md, a line a peer in the cloth room's README.

docs/figures/cloth-peers.json comes from `simcore bench cloth -- --peers --json docs/figures/cloth-peers.json`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from cloth_figures import told_ratio
from cloth_sweeps import told

ROOT = Path(__file__).parents[2]
FIGURES, README = (
    ROOT / "docs/figures/cloth-peers.json",
    Path(__file__).with_name("cloth_peers") / "README.md",
)
ROOM = ROOT / "sim_core/cloth/README.md"
SHORT = "<!-- peers: python tests/bench/cloth_peer_tables.py -->", "<!-- end of peers -->"
ASKED = "hang_edge", 40  # the scene of the issue, and how many times faster than every peer
BEGIN, END = "<!-- figures: python tests/bench/cloth_peer_tables.py -->", "<!-- end of figures -->"


def millimetres(value: float | None) -> str:
    """A length to two figures; a run that exploded has none."""
    return "exploded" if value is None else f"{value:.2g}"


def peer_line(engine: str, peer: dict) -> str:
    """One line of the table of own limits."""
    if "error" in peer:
        return f"| {engine} | not compared: {peer['error']} | | | | | | |"
    near, floor = peer["cheapest_within_2mm"], peer["floor"] or {"mean": None}
    shown = near or peer["best"]
    if shown is None:
        return f"| {engine} | only its limit was run | | | | | | |"
    low, high = shown["cpu_ms_quartiles"]
    return (
        f"| {engine} | {peer['limit']}, {millimetres(floor['mean'])} | "
        f"{millimetres(peer['limit_from_ours']['mean'])} / {millimetres(peer['limit_from_ours']['p99'])} | "
        f"{told(shown['setting'])}{'' if near else ' (best; never within 2 mm)'} | "
        f"{millimetres(shown['own']['mean'])} / {millimetres(shown['own']['p99'])} | "
        f"{shown['cpu_ms']:.0f} ({low:.0f}–{high:.0f}) | "
        f"{told_ratio(shown['ratio'])} | {told_ratio(shown.get('ratio_cheapest'))} |"
    )


def tables(results: dict) -> str:
    """A table a scene: each peer's limit, how far it is from ours, and its cheapest setting within 2 mm of it."""
    parts = []
    for scene, figures in results.items():
        usual = figures["ours"].get("settings", figures["ours"]["rows"])[0]
        cheap = figures["ours"].get("cheapest_within_2mm", {**usual, "name": "default; older run"})
        parts.append(
            f"**{scene}**, {figures['vertices']} vertices, undamped, after {figures['seconds']} s. Ours: "
            f"{usual['cpu_ms']:.1f} ms a frame, {usual['error']['mean']:.1e} mm mean from its own limit by default; "
            f"{cheap['cpu_ms']:.1f} ms and {cheap['error']['mean']:.1e} mm at its cheapest ({cheap['name']}) "
            f"(floor {figures['ours']['floor']['mean']:.1e})."
            + ("" if figures["complete"] else " The sweep is not complete.")
            + "\n\n| peer | limit at, floor [mm] | limit from ours, mean / p99 [mm] | cheapest within 2 mm of it | "
            "its error, mean / p99 [mm] | cpu ms a frame (quartiles) | "
            "times ours, default | times ours, cheapest |\n|-|-|-|-|-|-|-|-|\n"
            + "\n".join(peer_line(engine, peer) for engine, peer in figures["peers"].items())
        )
    return "\n\n".join(parts)


def short_cell(peer: dict | None) -> str:
    """What stands for one peer in one scene: its time, times ours, and how far its limit is from ours."""
    if peer is None or "error" in peer:
        return "not compared"
    near = peer["cheapest_within_2mm"] or peer["best"]
    if near is None:
        return "only its limit was run"
    never = "" if peer["cheapest_within_2mm"] else f" (never within 2 mm: {millimetres(near['own']['mean'])})"
    return (
        f"{near['cpu_ms']:.0f} ms{never}, {told_ratio(near['ratio'])} / {told_ratio(near.get('ratio_cheapest'))} "
        f"times ours; limit {millimetres(peer['limit_from_ours']['mean'])} mm off"
    )


def short(results: dict) -> str:
    """A line a peer: over our default (far more exact than asked) / over our cheapest setting within 2 mm."""
    heads = [
        f"{name}, {part['vertices']:,} vertices, {part['seconds']:g} s" for name, part in results.items()
    ]
    names = list(dict.fromkeys(engine for part in results.values() for engine in part["peers"]))
    lines = [f"| peer | {' | '.join(heads)} |", "|-|" + "-|" * len(heads)]
    for name in names:
        cells = [short_cell(part["peers"].get(name)) for part in results.values()]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    ours = []
    for part in results.values():
        usual, cheap = part["ours"]["settings"][0], part["ours"]["cheapest_within_2mm"]
        ours.append(
            f"{usual['cpu_ms']:.1f} ms, {usual['error']['mean']:.1e} mm / {cheap['cpu_ms']:.1f} ms, "
            f"{cheap['error']['mean']:.1e} mm ({cheap['name']})"
        )
    lines.append(f"| ours, default / cheapest | {' | '.join(ours)} |")
    return "\n".join(lines) + "\n\n" + verdict(results)


def verdict(results: dict) -> str:
    """How the least ratio of the scene that was asked for stands to what was asked."""
    scene, times = ASKED
    found = [
        (peer["cheapest_within_2mm"] or {}, name)
        for name, peer in results[scene]["peers"].items()
        if "error" not in peer
    ]
    rows = [(row["ratio"], row.get("ratio_cheapest"), name) for row, name in found if row]
    told = f"Asked on {scene}: {times} times faster than every peer within 2 mm. "
    usual = min(rows)
    told += f"Least over our default, {usual[0]:.1f} ({usual[2]})"
    alike = [(row[1], row[2]) for row in rows if row[1] is not None]
    if alike:
        told += f"; like for like, each at its cheapest within 2 mm, {min(alike)[0]:.1f} ({min(alike)[1]})"
    return told + "." + ("" if results[scene]["complete"] else " The sweep is not complete.")


def placed(path: Path, begin: str, end: str, text: str) -> None:
    """Puts a text between its marks."""
    before, _, rest = path.read_text("utf-8").partition(begin)
    _, _, after = rest.partition(end)
    path.write_text(f"{before}{begin}\n{text}\n{end}{after}", "utf-8")


def main() -> int:
    results = json.loads(FIGURES.read_text("utf-8"))
    placed(README, BEGIN, END, tables(results))
    placed(ROOM, *SHORT, short(results))
    return 0


if __name__ == "__main__":
    sys.exit(main())
