"""Speed against error of the engine's own settings, a scene a panel: what `simcore bench cloth -- --plot` draws."""

from __future__ import annotations

from pathlib import Path

LEAST = 1e-5  # [mm] what errs less is drawn there
MOST = 1e3
TICKS = (10, 20, 40, 100, 200, 400)  # [ms]
COLOURS = {"explicit": "#185a8c", "single": "#c4781e", "implicit": "#be3c3c"}


def curves_of(result: dict) -> dict[str, list[tuple[float, float]]]:
    """Name -> (ms a frame, mean error [mm]) of a scene's rows, without those that exploded."""
    out: dict[str, list[tuple[float, float]]] = {}
    for row in result["rows"]:
        error = row["error_mm"]["mean"]
        kind = "implicit" if row["integrator"] == "implicit" else row["precision"]
        kind = "explicit" if kind == "double" else kind
        if error < MOST:
            out.setdefault(kind, []).append((row["ms"], max(error, LEAST)))
    return {kind: sorted(points) for kind, points in out.items()}


def plot(scenes: dict, path: Path) -> None:
    """Draws all scenes; the circle is what the scene takes by itself, the grey line real time."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, panels = pyplot.subplots(1, len(scenes), figsize=(3.6 * len(scenes), 3.6), squeeze=False)
    for panel, (name, result) in zip(panels[0], scenes.items(), strict=True):
        for kind, points in curves_of(result).items():
            panel.loglog(*zip(*points, strict=True), "o-", ms=4, color=COLOURS[kind], label=kind)
        own = next(r for r in result["rows"] if r["own"])
        at = own["ms"], max(own["error_mm"]["mean"], LEAST)
        panel.loglog(*at, "o", ms=11, mfc="none", color="black")
        panel.axvline(40, color="0.7", lw=1)
        panel.set(title=f"{name}\nafter {result['seconds']:g} s", xlabel="processor ms a frame")
        panel.title.set_fontsize(9)
        panel.set_xlim(8, 500)
        panel.set_xticks(TICKS, [f"{tick}" for tick in TICKS])
        panel.minorticks_off()
    panels[0][0].set_ylabel("mean distance from the limit [mm]")
    panels[0][1 % len(scenes)].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=100)
    pyplot.close(figure)
