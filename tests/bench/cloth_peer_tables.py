"""The peers' figures as tables: python tests/bench/cloth_peer_tables.py writes them from docs/figures.

The published scenes stand in cloth_peers/README.md, layers and a silk's stiffness in the cloth room's DETAILS.md, a
line a scene in its README.

docs/figures/cloth-peers.json comes from `simcore bench cloth -- --peers --json docs/figures/cloth-peers.json`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from cloth_figures import told_ratio
from cloth_sweeps import NAMES, PUBLISHED, told

ROOT = Path(__file__).parents[2]
FIGURES, README = (
    ROOT / "docs/figures/cloth-peers.json",
    Path(__file__).with_name("cloth_peers") / "README.md",
)
ROOM = ROOT / "sim_core/cloth"
SHORT = "<!-- peers: python tests/bench/cloth_peer_tables.py -->", "<!-- end of peers -->"
LONG = "<!-- peers in detail: python tests/bench/cloth_peer_tables.py -->", "<!-- end of peers in detail -->"
ASKED = {"hang_edge": 40, "folded": 20}  # the scenes of the issue, and how many times faster than every peer
BEGIN, END = "<!-- figures: python tests/bench/cloth_peer_tables.py -->", "<!-- end of figures -->"


def millimetres(value: float | None) -> str:
    """A length to two figures; a run that exploded has none."""
    return "exploded" if value is None else f"{value:.2g}"


def title(scene: str) -> str:
    """The name of a scene as it is told."""
    return scene.replace("_silk", ", silk").replace("folded", "folded over a bar, layers")


def counted(row: dict) -> str:
    """Crossings, the most in a frame and those in the last, where they were counted."""
    found = row.get("crossings")
    return "–" if found is None else f"{found['most']} / {found['end']}"


def at_rest(peer: dict) -> str:
    """The cheapest setting whose last frame alone is within 2 mm."""
    row = peer.get("cheapest_at_rest")
    if row is None:
        return "none"
    return f"{told(row['setting'])}, {row['cpu_ms']:.0f} ms, {told_ratio(row['ratio_cheapest'])}"


def refused(peer: dict) -> str:
    """What of a sweep was broken off."""
    return "".join(f"; {row['setting']} {row['why'].split(': ', 1)[-1]}" for row in peer.get("refused", []))


def peer_line(engine: str, peer: dict, *, whole: bool = False) -> str:
    """One line of the table of own limits; whole: with what layers do, and with the last frame alone."""
    if "error" in peer:
        return f"| {engine} | not compared: {peer['error']} |" + (9 if whole else 6) * " |"
    near, floor = peer["cheapest_within_2mm"], peer["floor"] or {"mean": None}
    shown = near or peer["best"]
    if shown is None:
        return f"| {engine} | only its limit was run |" + (9 if whole else 6) * " |"
    low, high = shown["cpu_ms_quartiles"]
    line = (
        f"| {engine} | {peer['limit']}, {millimetres(floor['mean'])}{refused(peer)} | "
        f"{millimetres(peer['limit_from_ours']['mean'])} / {millimetres(peer['limit_from_ours']['p99'])} | "
        f"{told(shown['setting'])}{'' if near else ' (best; never within 2 mm)'} | "
        f"{millimetres(shown['own']['mean'])} / {millimetres(shown['own']['p99'])} | "
        f"{shown['cpu_ms']:.0f} ({low:.0f}–{high:.0f}) | "
        f"{told_ratio(shown['ratio'])} | {told_ratio(shown.get('ratio_cheapest'))} |"
    )
    if not whole:
        return line
    rest = millimetres(peer["limit_from_ours"]["end"])
    return f"{line} {rest} | {at_rest(peer)} | {counted(shown)} |"


def own_line(figures: dict) -> str:
    """What stands above a table: the scene, and our two settings."""
    usual = figures["ours"].get("settings", figures["ours"]["rows"])[0]
    cheap = figures["ours"].get("cheapest_within_2mm", {**usual, "name": "default; older run"})
    whole, stretch = figures.get("whole"), figures.get("stretch")
    when = f"in the worst frame of {figures['seconds']:g} s" if whole else f"after {figures['seconds']} s"
    damped = "damped by mass" if whole else "undamped"
    longest = "" if stretch is None else f", longest edge {100 * (stretch - 1):.1f} % over its rest length"
    crossings = f" Crossings (most in a frame / in the last): {counted(usual)}." if whole else ""
    return (
        f"{figures['vertices']} vertices, {damped}, {when}{longest}. Ours: "
        f"{usual['cpu_ms']:.1f} ms a frame, {usual['error']['mean']:.1e} mm mean from its own limit by default; "
        f"{cheap['cpu_ms']:.1f} ms and {cheap['error']['mean']:.1e} mm at its cheapest ({cheap['name']}) "
        f"(floor {figures['ours']['floor']['mean']:.1e}).{crossings}"
        + ("" if figures["complete"] else " The sweep is not complete.")
    )


def tables(results: dict) -> str:
    """A table a scene: each peer's limit, how far it is from ours, and its cheapest setting within 2 mm of it."""
    parts = []
    for scene, figures in results.items():
        whole = bool(figures.get("whole"))
        more = "at rest, limit from ours [mm] | at rest: cheapest within 2 mm, times ours | crossings |"
        parts.append(
            f"**{title(scene)}**, {own_line(figures)}"
            + "\n\n| peer | limit at, floor [mm] | limit from ours, mean / p99 [mm] | cheapest within 2 mm of it | "
            "its error, mean / p99 [mm] | cpu ms a frame (quartiles) | "
            f"times ours, default | times ours, cheapest |{f' {more}' if whole else ''}\n|-|-|-|-|-|-|-|-|"
            + ("-|-|-|\n" if whole else "\n")
            + "\n".join(peer_line(engine, peer, whole=whole) for engine, peer in figures["peers"].items())
        )
    return "\n\n".join(parts)


def short_cell(peer: dict | None) -> str:
    """What stands for one peer in one scene: its time, times ours, how far its limit is from ours, what crossed."""
    near = None if peer is None or "error" in peer else peer["cheapest_within_2mm"] or peer["best"]
    if peer is None or near is None:
        return "not compared"
    never = "" if peer["cheapest_within_2mm"] else f" (never within 2 mm: {millimetres(near['own']['mean'])})"
    met = f"; {near['crossings']['most']} crossings" if near.get("crossings") else ""
    return (
        f"{near['cpu_ms']:.0f} ms{never}, {told_ratio(near['ratio'])} / {told_ratio(near.get('ratio_cheapest'))}; "
        f"limit {millimetres(peer['limit_from_ours']['mean'])} mm off{met}"
    )


def short(results: dict) -> str:
    """A line a scene: over our default (far more exact than asked) / over our cheapest setting within 2 mm."""
    names = list(dict.fromkeys(engine for part in results.values() for engine in part["peers"]))
    lines = [f"| scene | ours, default / cheapest | {' | '.join(names)} |", "|-|" + "-|" * (len(names) + 1)]
    for scene, part in results.items():
        usual, cheap = part["ours"]["settings"][0], part["ours"]["cheapest_within_2mm"]
        met = f"; {usual['crossings']['most']} crossings" if usual.get("crossings") else ""
        own = (
            f"{usual['cpu_ms']:.1f} ms, {usual['error']['mean']:.1e} mm / {cheap['cpu_ms']:.1f} ms, "
            f"{cheap['error']['mean']:.1e} mm ({cheap['name']}){met}"
        )
        cells = [short_cell(part["peers"].get(name)) for name in names]
        head = f"{title(scene)}, {part['vertices']:,} vertices, {part['seconds']:g} s"
        lines.append(f"| {head} | {own} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n\n" + "\n".join(verdicts(results))


def least(rows: list[tuple[float, str]]) -> str:
    """The least ratio, and whose it is; below 1 the peer is ahead."""
    ratio, name = min(rows)
    return f"{ratio:.1f} ({name})" if ratio >= 1 else f"{name} is {1 / ratio:.1f} times as fast"


def verdict(scene: str, figures: dict) -> str:
    """How the least ratio of a scene stands to what was asked, and who never comes within 2 mm."""
    peers = {name: peer for name, peer in figures["peers"].items() if "error" not in peer}
    rows = {name: peer["cheapest_within_2mm"] for name, peer in peers.items() if peer["cheapest_within_2mm"]}
    asked = f" (asked: {ASKED[scene]})" if scene in ASKED else ""
    usual = [(row["ratio"], name) for name, row in rows.items() if row["ratio"] is not None]
    alike = [
        (row["ratio_cheapest"], name) for name, row in rows.items() if row.get("ratio_cheapest") is not None
    ]
    told_of = f"- {title(scene)}{asked}: "
    if usual:
        told_of += f"least over our default {least(usual)}"
    if alike:
        told_of += f"; like for like, each at its cheapest within 2 mm, {least(alike)}"
    never = [
        f"{name} {millimetres(peer['best']['own']['mean'])} mm"
        for name, peer in peers.items()
        if not peer["cheapest_within_2mm"] and peer["best"]
    ]
    told_of += f"; best of those never within 2 mm: {', '.join(never)}" if never else ""
    return told_of + "." + ("" if figures["complete"] else " The sweep is not complete.")


def verdicts(results: dict) -> list[str]:
    """A line a scene."""
    return [verdict(scene, figures) for scene, figures in results.items()]


def placed(path: Path, begin: str, end: str, text: str) -> None:
    """Puts a text between its marks."""
    before, _, rest = path.read_text("utf-8").partition(begin)
    _, _, after = rest.partition(end)
    path.write_text(f"{before}{begin}\n{text}\n{end}{after}", "utf-8")


def measured(published: bool | None = None) -> dict:
    """The scenes that were measured, in the order of NAMES; published: only those of the published work, or not."""
    found = json.loads(FIGURES.read_text("utf-8"))
    wanted = [name for name in NAMES if published is None or published == (name in PUBLISHED)]
    return {name: found[name] for name in wanted if name in found}


def main() -> int:
    placed(README, BEGIN, END, tables(measured(published=True)))
    placed(ROOM / "README.md", *SHORT, short(measured()))
    placed(ROOM / "DETAILS.md", *LONG, tables(measured(published=False)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
