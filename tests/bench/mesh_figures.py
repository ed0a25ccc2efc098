"""What the meshing bench found: runs of its parts put together, and the README's tables written from them.

simcore bench mesh -- --peers --large --json docs/figures/mesh.json --plot docs/pictures/mesh-bench.png
python tests/mesh_polygons.py 10000 --json docs/figures/mesh-polygons.json
python tests/bench/mesh_figures.py            (sim_core/mesh/README.md)
"""

import json
import sys
from pathlib import Path

import numpy as np

__all__ = ["added", "details", "exponent", "growing_exponents", "summary"]

ROOT = Path(__file__).parents[2]
FIGURES, POLYGONS = ROOT / "docs/figures/mesh.json", ROOT / "docs/figures/mesh-polygons.json"
README = ROOT / "sim_core/mesh/README.md"
BEGIN, END = "<!-- figures: python tests/bench/mesh_figures.py -->", "<!-- end of figures -->"
SMALLEST = 8000  # points from which the exponent counts; less is timer noise
COMMAND = "`simcore bench mesh -- --peers --large`"


def added(old: dict, new: dict) -> dict:
    """The figures of two runs; of rows of the same panel, engine and size the new one stays."""
    found = {**old, **{key: value for key, value in new.items() if value is not None}}
    for part, size, way in (("growth", "points", 1), ("panels", "edge", -1)):
        kept = {(r["panel"], way * r[size], r["engine"]): r for r in [*old.get(part, []), *new.get(part, [])]}
        if kept:
            found[part] = [kept[key] for key in sorted(kept)]
    return found


def growing_exponents(rows: list[dict]) -> dict[str, float]:
    """Per growing shape and kind the slope of log seconds against log vertices."""
    found = {}
    for shape in sorted({row["shape"] for row in rows}):
        for kind in ("fair", "best"):
            own = [r for r in rows if r["shape"] == shape and r["engine"] == kind]
            if len(own) > 1:
                n, t = (np.log([r[key] for r in own]) for key in ("vertices", "seconds"))
                found[f"{shape}, {kind}"] = float(np.polyfit(n, t, 1)[0])
    return found


def exponent(rows: list[dict]) -> dict[str, float]:
    """Per panel the slope of log seconds against log points for growth, from 10 000 points on."""
    found = {}
    for panel in sorted({row["panel"] for row in rows}):
        own = [r for r in rows if r["panel"] == panel and r["engine"] == "growth" and r["points"] > SMALLEST]
        if len(own) > 1:
            n, t = (np.log([r[key] for r in own]) for key in ("points", "seconds"))
            found[panel] = float(np.polyfit(n, t, 1)[0])
    return found


def _share(row: dict) -> str:
    """What growth takes of another engine's time, median and spread over the rounds."""
    low, high = 1 / row["ratio_most"], 1 / row["ratio_least"]
    return f"{1 / row['ratio']:.2f} ({low:.2f}–{high:.2f})"


def _times(row: dict) -> str:
    """How many times the row's engine takes, median and spread over the rounds."""
    return f"{row['ratio']:.1f} × ({row['ratio_least']:.1f}–{row['ratio_most']:.1f})"


def _near(rows: list[dict], engine: str, points: int) -> list[dict]:
    key = "points" if "points" in rows[0] else "vertices"
    return [r for r in rows if r["engine"] == engine and 0.8 < r[key] / points < 1.25]


def _range(values: list[float], digits: int) -> str:
    return f"{min(values):.{digits}f}–{max(values):.{digits}f}"


def summary() -> list[tuple[str, str, str]]:
    """Rows (what, measured, command) for the project's README."""
    found = json.loads(FIGURES.read_text("utf-8"))
    growth, panels = found["growth"], found["panels"]
    made = []
    for count, name in ((100_000, "100 thousand"), (1_000_000, "a million")):
        share = [1 / r["ratio"] for r in _near(growth, "Triangle p", count)]
        times = [r["ratio"] for r in _near(growth, "Qhull", count)]
        own = [r["seconds"] for r in _near(growth, "growth", count)]
        text = f"{_range(own, 3)} s: {_range(share, 2)} of Triangle's time, {_range(times, 0)} × faster than Qhull"
        made.append((f"growth triangulation of {name} points of three panels", text, COMMAND))
    powers = list(exponent(growth).values())
    most = max(r["points"] for r in growth)
    text = f"n^{_range(powers, 3)}; {found['memory']['bytes_a_point']:.0f} bytes a point"
    made.append((f"growth from 10 thousand to {most:,} points: time; memory", text, COMMAND))
    best = [r for r in panels if r["engine"] == "best"]
    gmsh = [r for r in panels if r["engine"] == "gmsh"]
    text = f"{min(r['min_angle_deg'] for r in best):.1f}°, {min(r['mean_quality'] for r in best):.4f}"
    made.append((f"`--quality best`, {len(best)} meshes: smallest angle, least mean quality", text, COMMAND))
    text = f"{_range([r['ratio'] for r in gmsh], 0)} × its time; gmsh {min(r['min_angle_deg'] for r in gmsh):.1f}°, "
    made.append(
        (
            f"gmsh (Frontal-Delaunay) beside it, {len(gmsh)} meshes",
            text + f"{min(r['mean_quality'] for r in gmsh):.4f}",
            COMMAND,
        )
    )
    made += _growing_summary(found)
    if POLYGONS.is_file():  # minutes of their own
        polygons = json.loads(POLYGONS.read_text("utf-8"))
        count, holes, bad = (polygons[key] for key in ("polygons", "with_holes", "bad"))
        text = f"{count:,}, {holes:,} with holes: **{bad} bad meshes**"
        made.append(
            ("random polygons, exact Delaunay check", text, f"`python tests/mesh_polygons.py {count}`")
        )
    return made


def _growing_summary(found: dict) -> list[tuple[str, str, str]]:
    """Rows for shapes that grow and for small holes, where they were measured."""
    if not found.get("growing"):
        return []
    command = "`simcore bench mesh -- --only growing --peers`"
    powers = [v for kind, v in growing_exponents(found["growing"]).items() if kind.endswith("fair")]
    most = max(r["points"] for r in found["growing"])
    star = [r for r in found["growing"] if r["shape"] == "star" and r["engine"] == "fair"]
    ten = next((f"; a star of 10,000: {r['seconds']:.1f} s" for r in star if r["points"] == 10_000), "")
    name = f"stars, combs, spirals, clusters of up to {most:,} points: time by the vertices"
    made = [(name, f"n^{_range(powers, 2)}{ten}", command)]
    for own in (r for r in found["grading"] if r["engine"] == "best"):
        beside = next(
            (
                f"; Triangle `pq30` on the same steps {r['vertices']:,}, {r['min_angle_deg']:.1f}°"
                for r in found["grading"]
                if r["shape"] == own["shape"] and r.get("outline") == "best's outline"
            ),
            "",
        )
        text = f"{own['min_angle_deg']:.1f}°, {own['vertices']:,} vertices{beside}"
        made.append((f"{own['shape']} at edges of 50 mm, `best`: smallest angle", text, command))
    return made


def _growth_table(found: dict) -> list[str]:
    rows = found["growth"]
    lines = ["| Panel | points | growth | of Triangle `p` | Qhull | naive |", "|---|---|---|---|---|---|"]
    for own in (r for r in rows if r["engine"] == "growth"):
        beside = {r["engine"]: r for r in rows if (r["panel"], r["points"]) == (own["panel"], own["points"])}
        others = [
            f(beside[name]) if name in beside else "–"
            for name, f in (("Triangle p", _share), ("Qhull", _times), ("growth, naive", _times))
        ]
        cells = [own["panel"], f"{own['points']:,}", f"{1e3 * own['seconds']:.1f} ms", *others]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def _panels_table(found: dict) -> list[str]:
    rows = found["panels"]
    lines = [
        "| Panel | vertices | fair | best | gmsh | angle fair / best / gmsh | mean q fair / best / gmsh |",
        "|---|---|---|---|---|---|---|",
    ]
    for own in (r for r in rows if r["engine"] == "best"):
        beside = {r["engine"]: r for r in rows if (r["panel"], r["edge"]) == (own["panel"], own["edge"])}
        kinds = [beside.get(name) for name in ("fair", "best", "gmsh")]
        angles = " / ".join(f"{r['min_angle_deg']:.1f}" if r else "–" for r in kinds)
        q = " / ".join(f"{r['mean_quality']:.4f}" if r else "–" for r in kinds)
        times = [f"{1e3 * beside[name]['seconds']:.1f} ms" for name in ("fair", "best")]
        times.append(_times(beside["gmsh"]) if "gmsh" in beside else "–")
        cells = [own["panel"], f"{own['vertices']:,}", *times, angles, q]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def _corners_table(found: dict) -> list[str]:
    lines = [
        "| Least angle between lines | meshes | vertices, median (most) | shortest side | small angles |",
        "|---|---|---|---|---|",
    ]
    for row in found["corners"]:
        low, high = row["angles"]
        both = [row[name] for name in ("best", "Triangle") if name in row]
        cells = [
            f"{row['kind']}, {f'{low:g}–{high:g}°' if high < 90 else f'above {low:g}°'}",
            str(row["meshes"]),
            " / ".join(f"{of['vertices_median']:,.0f} ({of['vertices_most']:,})" for of in both),
            " / ".join(f"{of['side_by_feature']:.4f}" for of in both),
            " / ".join(f"{of['small']:,} in {of['meshes_with_small']}" for of in both),
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def _cloth_table(found: dict) -> list[str]:
    cloth = found["cloth"]
    lines = [
        "| Edge | quality | vertices | mesh | mean q | drape | error mean / max |",
        "|---|---|---|---|---|---|---|",
    ]
    for r in cloth["rows"]:
        cells = [
            f"{100 * r['edge']:g} cm",
            r["quality"],
            str(r["vertices"]),
            f"{1e3 * r['mesh_seconds']:.1f} ms",
            f"{r['mean_quality']:.4f}",
            f"{r['drape_seconds']:.2f} s",
            f"{r['error_mean_mm']:.2f} / {r['error_max_mm']:.1f} mm",
        ]
        lines.append("| " + " | ".join(cells) + " |")
    floor = f"Floor of the reference ({100 * cloth['reference_edge']:g} cm): {cloth['floor_mm']:.2f} mm."
    return [*lines, "", floor]


def details() -> str:
    """The tables that the room's README has beside the summary."""
    found = json.loads(FIGURES.read_text("utf-8"))
    tables = (_growth_table, _panels_table, _corners_table, _cloth_table)
    return "\n\n".join("\n".join(table(found)) for table in tables)


def main() -> int:
    lines = ["| What | Measured | Command |", "|---|---|---|"]
    lines += ["| " + " | ".join(row) + " |" for row in summary()]
    text = "\n".join(lines) + "\n\n" + details()
    before, rest = README.read_text("utf-8").split(BEGIN)
    README.write_text(before + BEGIN + "\n\n" + text + "\n\n" + END + rest.split(END)[1], "utf-8")
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
