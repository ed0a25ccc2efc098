"""The plots of the research page as SVG, in numbers alone for both languages; the page says what they show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from research_figures import GARMENTS, bake, read

INK, RED, GOLD, GREEN, BLUE, QUIET = "#201c1a", "#9e2b25", "#b98a2f", "#4a6b4f", "#3d5a78", "#8d8272"
COLOURS = (RED, BLUE, GOLD, GREEN, INK)
SIZE = (7.2, 3.6)  # inches


def save(name: str, path: Path) -> None:
    """The plot of that section. The same figures give the same bytes."""
    settings = {
        "svg.hashsalt": "research",
        "svg.fonttype": "none",
        "font.family": "sans-serif",
        "font.size": 9,
    }
    with matplotlib.rc_context(settings):
        figure = Figure(figsize=SIZE, layout="constrained")
        axes = figure.subplots()
        PLOTS[name](axes)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        axes.grid(alpha=0.25)
        axes.set_axisbelow(True)
        figure.savefig(path, format="svg", metadata={"Date": None})


def loglog(axes: Axes, across: str, up: str) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(across)
    axes.set_ylabel(up)


def bars(axes: Axes, labels: list[str], series: Mapping[str, Sequence[float]], up: str) -> None:
    """Bars beside each other, one colour a series."""
    wide = 0.8 / len(series)
    for k, (name, values) in enumerate(series.items()):
        places = [i + (k - (len(series) - 1) / 2) * wide for i in range(len(labels))]
        axes.bar(places, values, wide * 0.92, color=COLOURS[k], label=name)
    turned = 45 if len(labels) > 8 else 0
    axes.set_xticks(range(len(labels)), labels, rotation=turned, ha="right" if turned else "center")
    axes.set_ylabel(up)
    if len(series) > 1:
        axes.legend(frameon=False)


def walking(axes: Axes) -> None:
    grids = read("walking")["grids"]
    for key, colour, name in (("miss_median_mm", RED, "median"), ("miss_max_mm", BLUE, "max")):
        axes.plot([g["cell_m"] for g in grids], [g[key] for g in grids], "o-", color=colour, label=name)
    loglog(axes, "m", "mm")
    axes.legend(frameon=False)


def crowd(axes: Axes) -> None:
    rows = [r for r in read("crowd")["here"]["attacks"] if r["walk_longer_ms"] is not None]
    bars(axes, [r["kind"] for r in rows], {"ms": [r["walk_longer_ms"] for r in rows]}, "ms")


def page(axes: Axes) -> None:
    rows = read("page")["summary"]["closeup_s"]
    middle = [r["median"] for r in rows.values()]
    low = [r["median"] - r["min"] for r in rows.values()]
    high = [r["max"] - r["median"] for r in rows.values()]
    axes.bar(range(len(rows)), middle, 0.6, color=RED)
    axes.errorbar(range(len(rows)), middle, (low, high), fmt="none", ecolor=INK, capsize=4)
    axes.set_xticks(range(len(rows)), list(rows))
    axes.set_ylabel("s")


def look(axes: Axes) -> None:
    rows = read("look")["summary"]["cpu_ms"]
    views = {view: [row[view] for row in rows.values()] for view in ("entry", "exhibit")}
    bars(axes, list(rows), views, "ms")


def garments(axes: Axes) -> None:
    errors = {en: bake(exhibit)["errors"] for exhibit, (_, en) in GARMENTS.items()}
    series = {k: [1000 * e[f"hall_hausdorff_{k}"] for e in errors.values()] for k in ("mean", "p99", "max")}
    bars(axes, list(errors), series, "mm")


def scan(axes: Axes) -> None:
    rows = {
        f"{one['triangles']:,}, {model}": [
            1000 * one[model]["deviation"][f"{k}_m"] for k in ("mean", "p99", "max")
        ]
        for one in read("scan")["scans"]
        for model in ("close", "hall")
    }
    bars(
        axes,
        list(rows),
        dict(zip(("mean", "p99", "max"), zip(*rows.values(), strict=True), strict=True)),
        "mm",
    )


def weave(axes: Axes) -> None:
    found = read("weave")
    satin = [(r["seconds"], max(r["error"], 1e-8)) for r in found["residual"]]
    plain = [(r["seconds"], abs(r["error"])) for r in found["plain"]]
    closed = [(r["seconds"], r["error"]) for r in found["closed"]]
    for points, colour, name in (
        (closed, GREEN, "closed forms"),
        (plain, RED, "elastica"),
        (satin, BLUE, "satin 8 × 8"),
    ):
        axes.scatter(*zip(*points, strict=True), color=colour, s=22, label=name)
    loglog(axes, "s", "|Δ|")
    axes.legend(frameon=False)


def mesh(axes: Axes) -> None:
    rows = read("mesh")["growth"]
    for k, engine in enumerate(dict.fromkeys(r["engine"] for r in rows)):
        own = [(r["points"], r["seconds_median"]) for r in rows if r["engine"] == engine]
        axes.scatter(*zip(*own, strict=True), color=COLOURS[k], s=20, label=engine)
    loglog(axes, "n", "s")
    axes.legend(frameon=False)


def cloth(axes: Axes) -> None:
    for k, (scene, found) in enumerate(read("cloth")["mesh"].items()):
        rows = [r for r in found["rows"] if r["from_finest_mm"]["mean"] > 0]
        axes.plot(
            [r["ms"] for r in rows],
            [r["from_finest_mm"]["mean"] for r in rows],
            "o-",
            color=COLOURS[k % 5],
            label=scene,
        )
    loglog(axes, "ms", "mm")
    axes.legend(frameon=False)


def learn(axes: Axes) -> None:
    """Of the first scene: milliseconds, coarse physics included, against the mean error, a point a row."""
    scene, found = next(iter(read("learn")["scenes"].items()))
    for name, rows in found["rows"].items():
        if name == "coarse":  # its vertices are others
            continue
        row = rows[0]
        colour = RED if name == "ours" else GOLD if name.startswith(("physics", "reference")) else BLUE
        axes.plot(row["total_ms"], row["mean_mm"], "o", color=colour)
        axes.annotate(name, (row["total_ms"], row["mean_mm"]), (4, 3), textcoords="offset points", fontsize=7)
    loglog(axes, "ms", "mm")
    axes.set_title(scene, fontsize=9)


def light(axes: Axes) -> None:
    engines = read("light")["engines"]
    names = list(engines["nearest"])
    series = {
        kind: [row[name]["rays_per_s"] / 1e6 if name in row else 0.0 for name in names]
        for kind, row in engines.items()
    }
    bars(axes, names, series, "10⁶ / s")


def survey(axes: Axes) -> None:
    rows = read("survey_r")["differences"]
    keys = {"kmo": "KMO", "chi2": "χ²", "alpha": "α", "eigenvalues": "λ"}
    for k, (key, name) in enumerate(keys.items()):
        told = [(label, max(row[key], 1e-17)) for label, row in rows.items() if key in row]
        axes.scatter([p[0] for p in told], [p[1] for p in told], color=COLOURS[k], s=24, label=name)
    axes.set_yscale("log")
    axes.set_ylabel("|Δ|")
    axes.tick_params(axis="x", rotation=30)
    axes.legend(frameon=False)


PLOTS = {
    one.__name__: one
    for one in (walking, crowd, page, look, garments, scan, weave, mesh, cloth, learn, light, survey)
}
