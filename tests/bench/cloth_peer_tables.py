"""The peers' figures as tables: python tests/bench/cloth_peer_tables.py writes cloth_peers/README.md from docs/figures.

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


def main() -> int:
    text = README.read_text("utf-8")
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    results = json.loads(FIGURES.read_text("utf-8"))
    README.write_text(f"{before}{BEGIN}\n{tables(results)}\n{END}{after}", "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
