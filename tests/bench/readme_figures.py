"""The README's table of figures, written from what the benches and the bake measured; nothing is typed in.

hall bench walking -- --json docs/figures/walking.json
hall bench page -- --json docs/figures/page.json
hall bench look -- --json docs/figures/look.json
simcore bench mesh -- --peers --large --json docs/figures/mesh.json
python tests/mesh_polygons.py 10000 --json docs/figures/mesh-polygons.json
python tests/bench/readme_figures.py
"""

import json
import sys
from pathlib import Path

import mesh_figures

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
    return rows


def page() -> list[tuple[str, str, str]]:
    found, command = read("page")["summary"], "`hall bench page`"

    def spread(row: dict, unit: str, digits: int = 1) -> str:
        return f"{row['median']:.{digits}f} {unit} ({row['min']:.{digits}f}–{row['max']:.{digits}f})"

    rows = [
        (
            f"cold load until all is drawn, 1280×720, median of {found['runs']}",
            spread(found["load_s"], "s"),
            command,
        ),
        ("bytes on the wire to the first view", spread(found["megabytes"], "MB"), command),
        ("a frame while walking", spread(found["frame_ms"], "ms", 0), command),
        ("key to camera", spread(found["key_to_camera_ms"], "ms", 0), command),
    ]
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


def garment(exhibit: str, name: str) -> list[tuple[str, str, str]]:
    record = json.loads((ROOT / f"assets/exhibits/{exhibit}/baked/bake.json").read_text("utf-8"))
    errors, seconds, command = record["errors"], record["seconds"], "`hall build -f`"
    inside = " / ".join(str(errors[f"inside_{what}"]) for what in ("vertices", "midpoints", "centroids"))
    rows = [
        (f"{name}: vertices / edge midpoints / centroids inside", inside, command),
        (
            f"{name}, {errors['vertices']:,} vertices: area strain p95 / max",
            f"{errors['area_strain_p95']:.2%} / {errors['area_strain_max']:.1%}",
            command,
        ),
        (f"{name}: edge–triangle self-intersections", str(errors["self_intersections"]), command),
    ]
    if "asymmetry_m" in errors:
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
            f"{name}: simulated / with models, film and pictures",
            f"{seconds['beneath'] + seconds['drape']:.0f} s / {seconds['all']:.0f} s",
            command,
        ),
        (
            f"{name}: hall model against the simulated one, mean / p99 / max",
            apart(errors),
            command,
        ),
    ]
    return rows


def apart(errors: dict[str, float], prefix: str = "") -> str:
    mean, p99, most = (1000 * errors[f"{prefix}hall_hausdorff_{name}"] for name in ("mean", "p99", "max"))
    return f"{mean:.2f} / {p99:.1f} / {most:.1f} mm"


def robe() -> list[tuple[str, str, str]]:
    """The robe under the scarf, measured from the shipped models: the record tells of the scarf's alone."""
    from hall_app.bake.stored import measured_again
    from hall_app.content.loading import load

    exhibit = load(ROOT / "assets").exhibit("pibo-figure")
    assert exhibit is not None
    assert exhibit.file.garment is not None
    figures = measured_again(ROOT / "assets", exhibit.file.garment, exhibit.folder / "baked").figures
    inside = " / ".join(
        str(figures[f"robe_inside_{what}"]) for what in ("vertices", "midpoints", "centroids")
    )
    strain = f"{figures['robe_area_strain_p95']:.2%} / {figures['robe_area_strain_max']:.1%}"
    command = "`hall check --garments`"
    return [
        ("the robe under the pibo: vertices / edge midpoints / centroids inside", inside, command),
        ("the robe under the pibo: area strain p95 / max", strain, command),
        (
            "the robe under the pibo: edge–triangle self-intersections",
            str(figures["robe_self_intersections"]),
            command,
        ),
        ("the robe under the pibo: hall model, mean / p99 / max", apart(figures, "robe_"), command),
    ]


def main() -> int:
    rows = walking() + page() + look() + mesh_figures.summary() + room()
    rows += garment("beizi", "beizi") + garment("pibo-figure", "pibo over a robe") + robe()
    rows += garment("pibo", "scarf")
    lines = ["| What | Measured | Command |", "|---|---|---|"]
    lines += [f"| {what} | {value} | {command} |" for what, value, command in rows]
    path = ROOT / "README.md"
    before, rest = path.read_text("utf-8").split(BEGIN)
    path.write_text(before + BEGIN + "\n\n" + "\n".join(lines) + "\n\n" + END + rest.split(END)[1], "utf-8")
    print("\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
