"""The README's table of figures, written from what the benches and the bake measured; nothing is typed in.

hall bench walking -- --json docs/figures/walking.json
hall bench crowd -- --json docs/figures/crowd.json --beside CHECKOUT_OF_47c1f8d
hall bench page -- --json docs/figures/page.json
hall bench look -- --json docs/figures/look.json
simcore bench mesh -- --peers --large --json docs/figures/mesh.json
python tests/bench/bench_scan.py --json docs/figures/scan.json
python tests/mesh_polygons.py 10000 --json docs/figures/mesh-polygons.json
python tests/bench/readme_figures.py
"""

import json
import sys
from pathlib import Path

import mesh_figures
from research_figures import GARMENTS, bake

ROOT = Path(__file__).parents[2]
FIGURES = ROOT / "docs" / "figures"
BEGIN, END = "<!-- figures: python tests/bench/readme_figures.py -->", "<!-- end of figures -->"


def read(name: str):
    return json.loads((FIGURES / f"{name}.json").read_text("utf-8"))


def walking() -> list[tuple[str, str, str]]:
    found, command = read("walking"), "`hall bench walking`"
    rows = []
    for row in found["moves"]:
        rows.append(
            (
                f"random moves, {row['floor']} floor of {row['solids']} solids",
                f"{row['moves']:,}, **{row['penetrations']} penetrations**, nearest {row['least_room_mm']:.1f} mm",
                command,
            )
        )
    grid = next(row for row in found["grids"] if row["cell_m"] == 0.04)
    miss = f"median {grid['miss_median_mm']:.2f}, largest {grid['miss_max_mm']:.1f} mm"
    text = f"{miss}; into solids {grid['intrusion_mm']:g} mm"
    rows.append(("display against server, 150 held walks at corners, rounds and wall ends", text, command))
    return rows + [free_walk(row) for row in found["walks"]]


def free_walk(row: dict) -> tuple[str, str, str]:
    what = f"free walk by random keys, {row['walked_m']:.0f} m, {row['round_trip_ms']:.0f} ms away, {row['beside']}"
    miss = f"same input: median {row['miss_median_mm']:.2f}, largest {row['miss_largest_mm']:.1f} mm"
    ahead = f"not answered yet: median {row['apart_median_mm']:.0f}, largest {row['apart_largest_mm']:.0f} mm"
    return what, f"{miss}; {ahead}", "`hall bench walking`"


def crowd() -> list[tuple[str, str, str]]:
    found, command = read("crowd"), "`hall bench crowd`"
    here, before = found["here"], found.get("beside")
    waves = here["waves"]

    def worst(rows: list[dict], what: str, quantile: str) -> float:
        return max(row[what][quantile] for row in rows)

    def longer(rows: list[dict], what: str) -> tuple[float, str]:
        return max(
            (row[f"{what}_longer_ms"], row["kind"]) for row in rows if row[f"{what}_longer_ms"] is not None
        )

    many = f"{found['visitors']} visitors in one process on one core, worst of {len(waves)} waves"
    rows = [
        (
            f"{many}: from input to answer",
            f"p50 {worst(waves, 'walk_ms', 'p50'):.1f}, p95 {worst(waves, 'walk_ms', 'p95'):.1f} ms; while they "
            f"all join within 2 s p95 {worst(waves, 'joining_walk_ms', 'p95'):.0f} ms",
            command,
        ),
        (
            f"{many}: core and memory",
            f"{max(row['cpu_share'] for row in waves):.0%}; {max(row['most_mb'] for row in waves):.0f} MB, "
            f"{waves[-1]['after_mb']:.0f} MB when they have left",
            command,
        ),
    ]
    for what, name in (("walk", "input to answer"), ("get", "a plain request")):
        more, kind = longer(here["attacks"], what)
        text = f"{more:.1f} ms (`{kind}`, worst of {len(here['attacks'])} kinds)"
        if before:
            past, kind = longer(before["attacks"], what)
            text += f"; before there were budgets {past:,.0f} ms (`{kind}`)"
        rows.append((f"{name} of 30 others beside one attacker at full speed, p95 longer by", text, command))
    return rows


def page() -> list[tuple[str, str, str]]:
    told, command = read("page"), "`hall bench page`"
    found, machine = told["summary"], told["machine"]

    def spread(row: dict, unit: str, digits: int = 1) -> str:
        return f"{row['median']:.{digits}f} {unit} ({row['min']:.{digits}f}–{row['max']:.{digits}f})"

    rows = [
        (
            f"cold load until one may enter, 1280×720, median of {found['runs']} ({machine['processor']})",
            spread(found["load_s"], "s"),
            command,
        ),
        ("bytes on the wire to the first view", spread(found["megabytes"], "MB"), command),
        ("a frame while walking", spread(found["frame_ms"], "ms", 0), command),
        ("key to camera", spread(found["key_to_camera_ms"], "ms", 0), command),
    ]
    for line in [found["slow"]["here"]] if "slow" in found else []:
        rows.append(("the door can be read, 1.6 Mbit/s and 300 ms", spread(line["door_s"], "s"), command))
        rows.append(("one may enter, 1.6 Mbit/s and 300 ms", spread(line["ready_s"], "s"), command))
    for exhibit, row in found["closeup_s"].items():
        rows.append((f"close-up of {exhibit} after the click", spread(row, "s"), command))
    return rows


AIM = {"ambient": "½", "beside": "½", "default": "⅓"}  # what the shipped look may cost of each


def look() -> list[tuple[str, str, str]]:
    found, command = read("look")["summary"], "`hall bench look`"
    cost, share = found["cpu_ms"], found["share"]

    def views(look: str) -> str:
        return " / ".join(f"{value:.0f}" for value in cost[look].values()) + " ms"

    names = {
        "ambient": "the same, lit by one ambient light and nothing else",
        "beside": "the same, an ambient light beside viser's environment map",
        "default": "the same, viser's default environment map",
    }
    where = " / ".join(cost["shipped"])
    rows = [(f"CPU a picture as software WebGL is given it: {where}", views("shipped"), command)]
    rows += [
        (name, f"{views(other)} – as shipped {share[other]:.2f} of it at worst, aim {AIM[other]}", command)
        for other, name in names.items()
    ]
    return rows


def room() -> list[tuple[str, str, str]]:
    record = json.loads((ROOT / "assets/room/room.json").read_text("utf-8"))
    light, command = record["light"], "`hall build --room -f`"
    text = f"{light['texels']:,} texels, {light['rays'] / 1e6:.0f} M rays in {light['seconds']:.0f} s"
    return [
        (f"light of the room, {record['triangles']:,} triangles", text, command),
        ("its noise, standard deviation over mean", f"{light['noise']:.1%}", command),
    ]


INSIDE = ("vertices", "midpoints", "centroids", "edges")  # what may lie in the figure, or cross its surface


def garment(exhibit: str, name: str) -> list[tuple[str, str, str]]:
    record = bake(exhibit)
    errors, seconds, command = record["errors"], record["seconds"], "`hall build -f`"
    stages = record["stages"]
    inside = " / ".join(str(errors[f"inside_{what}"]) for what in INSIDE)
    rows = [
        (f"{name}: vertices / edge midpoints / centroids / crossing edges inside", inside, command),
        (
            f"{name}, {errors['vertices']:,} vertices: area strain p95 / max",
            f"{errors['area_strain_p95']:.2%} / {errors['area_strain_max']:.1%}",
            command,
        ),
        (f"{name}: edge–triangle self-intersections", str(errors["self_intersections"]), command),
    ]
    if not record["layers"][-1]["whole"]:
        rows.append(
            (
                f"{name}: left against right half (one is simulated)",
                f"{1000 * errors['asymmetry_m']:.1f} mm",
                command,
            )
        )
    rows += [
        (
            f"{name}: displacement at rest, p99, in 1/25 s",
            f"{1000 * errors['rest_p99_m']:.3f} mm",
            command,
        ),
        (
            f"{name}: simulated, processor / clock / with models, film and pictures (beside other work)",
            f"{stages['drape_cpu']:.0f} s / {seconds['drape']:.0f} s / {seconds['all']:.0f} s",
            command,
        ),
        (
            f"{name}: hall model against the simulated one, mean / p99 / max",
            apart(errors),
            command,
        ),
    ]
    return rows


def garments() -> list[tuple[str, str, str]]:
    """Of all exhibits that are dressed."""
    return [row for exhibit, (_, name) in GARMENTS.items() for row in garment(exhibit, name)]


def apart(errors: dict[str, float], prefix: str = "") -> str:
    mean, p99, most = (1000 * errors[f"{prefix}hall_hausdorff_{name}"] for name in ("mean", "p99", "max"))
    return f"{mean:.2f} / {p99:.1f} / {most:.1f} mm"


def robe() -> list[tuple[str, str, str]]:
    """The robe under the scarf."""
    figures, name = bake("pibo-figure")["errors"], "the robe under the pibo"
    inside = " / ".join(str(figures[f"robe_inside_{what}"]) for what in INSIDE)
    strain = f"{figures['robe_area_strain_p95']:.2%} / {figures['robe_area_strain_max']:.1%}"
    command = "`hall build -f`"
    return [
        (f"{name}: vertices / edge midpoints / centroids / crossing edges inside", inside, command),
        (f"{name}: area strain p95 / max", strain, command),
        (f"{name}: edge–triangle self-intersections", str(figures["robe_self_intersections"]), command),
        (f"{name}: hall model, mean / p99 / max", apart(figures, "robe_"), command),
    ]


def scans() -> list[tuple[str, str, str]]:
    """What a bake of a scan takes, and how far its models are from it."""
    rows, command = [], "`python tests/bench/bench_scan.py`"
    for one in read("scan")["scans"]:
        name = f"scan of {one['triangles']:,} triangles"
        memory = f", {one['memory_gb']:.1f} GB at most" if one["memory_gb"] is not None else ""
        rows.append(
            (f"{name}, {one['file_mb']:.0f} MB: baked, processor", f"{one['cpu_s']:.0f} s{memory}", command)
        )
        for model, what in (("close", "close-up"), ("hall", "hall model")):
            told = one[model]
            apart = " / ".join(f"{1000 * told['deviation'][key]:.2f}" for key in ("mean_m", "p99_m", "max_m"))
            within = f"aim p99 ≤ {1000 * told['budget_m']:.2f}{'' if told['within_budget'] else ', missed'}"
            rows.append(
                (
                    f"{name}: {what} of {told['triangles']:,} against it, mean / p99 / max",
                    f"{apart} mm ({within}), {told['bytes'] / 1e6:.1f} MB",
                    command,
                )
            )
    return rows


def rows() -> list[tuple[str, str, str]]:
    """All of the table."""
    parts = (walking, crowd, page, look, mesh_figures.summary, scans, room, garments, robe)
    return [row for part in parts for row in part()]


def main() -> int:
    lines = ["| What | Measured | Command |", "|---|---|---|"]
    lines += [f"| {what} | {value} | {command} |" for what, value, command in rows()]
    path = ROOT / "README.md"
    before, rest = path.read_text("utf-8").split(BEGIN)
    path.write_text(before + BEGIN + "\n\n" + "\n".join(lines) + "\n\n" + END + rest.split(END)[1], "utf-8")
    print("\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
