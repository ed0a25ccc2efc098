"""Time against points and against quality, as one picture: what `simcore bench mesh -- --plot FILE.png` draws."""

from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

WIDE, HIGH, EDGE, FINE = 620, 460, 70, 2
COLOURS = {
    "growth": (24, 90, 140),
    "Triangle p": (196, 120, 30),
    "Qhull": (130, 130, 130),
    "growth, naive": (190, 60, 60),
    "fair": (110, 160, 190),
    "best": (24, 90, 140),
    "gmsh": (90, 140, 70),
}


def _panel(
    draw, font, left: int, title: str, curves: dict, labels: tuple[str, str], logs: tuple[bool, bool]
) -> None:
    """One diagram: curves name -> [(x, y)], an axis logarithmic where told."""
    points = np.array([p for curve in curves.values() for p in curve], dtype=float)
    scaled = [np.log10(points[:, k]) if logs[k] else points[:, k] for k in range(2)]
    low, high = (np.array([f(s) for s in scaled]) for f in (np.min, np.max))
    pad = 0.05 * (high - low) + 1e-9
    low, high = low - pad, high + pad

    def at(point):
        v = np.array([np.log10(p) if log else p for p, log in zip(point, logs, strict=True)])
        x, y = (v - low) / (high - low)
        return (left + EDGE + x * (WIDE - EDGE - 20)) * FINE, (HIGH - EDGE - y * (HIGH - EDGE - 50)) * FINE

    box = [(left + EDGE) * FINE, 50 * FINE, (left + WIDE - 20) * FINE, (HIGH - EDGE) * FINE]
    draw.rectangle(box, outline=(120, 120, 120), width=FINE)
    draw.text(((left + EDGE) * FINE, 18 * FINE), title, fill=(20, 20, 20), font=font)
    draw.text(((left + WIDE // 2 - 30) * FINE, (HIGH - 32) * FINE), labels[0], fill=(20, 20, 20), font=font)
    draw.text(((left + 6) * FINE, 30 * FINE), labels[1], fill=(20, 20, 20), font=font)
    for axis in range(2):
        ticks = range(int(np.ceil(low[axis])), int(np.floor(high[axis])) + 1) if logs[axis] else None
        ticks = (
            [10.0**t for t in ticks]
            if ticks is not None
            else np.linspace(low[axis] + pad[axis], high[axis] - pad[axis], 4)
        )
        for tick in ticks:
            other = 10.0 ** low[1 - axis] if logs[1 - axis] else low[1 - axis]
            x, y = at((tick, other) if axis == 0 else (other, tick))
            word = f"{tick:g}" if logs[axis] else f"{tick:.4f}"
            draw.text(
                (x - 14 * FINE, y + 4 * FINE) if axis == 0 else (x - 62 * FINE, y - 8 * FINE),
                word,
                fill=(70, 70, 70),
                font=font,
            )
    for k, (name, curve) in enumerate(curves.items()):
        colour = COLOURS.get(name, (0, 0, 0))
        places = [at(p) for p in sorted(curve)]
        draw.line(places, fill=colour, width=2 * FINE)
        for x, y in places:
            draw.ellipse([x - 4 * FINE, y - 4 * FINE, x + 4 * FINE, y + 4 * FINE], fill=colour)
        falls = min(curve)[1] > max(curve)[1]  # the name stands in the empty corner
        column = WIDE - 130 if falls else EDGE + 12
        draw.text(((left + column) * FINE, (58 + 18 * k) * FINE), name, fill=colour, font=font)


def plot(figures: dict, path: Path) -> None:
    """Draw what the figures hold: growth beside its peers, whole panels beside gmsh, the hanging sheet."""
    diagrams = []
    for panel in sorted({row["panel"] for row in figures.get("growth", [])}):
        curves: dict = {}
        for row in figures["growth"]:
            if row["panel"] == panel:
                curves.setdefault(row["engine"], []).append((row["points"], row["seconds"]))
        diagrams.append((f"triangulation: {panel}", curves, ("points", "s"), (True, True)))
    for panel in sorted({row["panel"] for row in figures.get("panels", [])}):
        curves = {}
        for row in figures["panels"]:
            if row["panel"] == panel:
                curves.setdefault(row["engine"], []).append((row["seconds"], 1 - row["mean_quality"]))
        diagrams.append((f"1 - mean quality: {panel}", curves, ("s", "1 - q"), (True, True)))
    if "cloth" in figures:
        curves = {}
        for row in figures["cloth"]["rows"]:
            curves.setdefault(row["quality"], []).append((row["mesh_seconds"], row["error_mean_mm"]))
        diagrams.append(("hanging sheet: error by time to mesh", curves, ("s", "mm"), (True, True)))
        by_edge: dict = {}
        for row in figures["cloth"]["rows"]:
            by_edge.setdefault(row["quality"], []).append((row["edge"], row["error_mean_mm"]))
        diagrams.append(("hanging sheet: error by edge length", by_edge, ("m", "mm"), (True, True)))
    across = min(3, max(1, len(diagrams)))
    down = -(-len(diagrams) // across)
    image = Image.new("RGB", (across * WIDE, down * HIGH), "white")
    font = ImageFont.load_default(14 * FINE)
    for k, diagram in enumerate(diagrams):
        tile = Image.new("RGB", (WIDE * FINE, HIGH * FINE), "white")
        _panel(ImageDraw.Draw(tile), font, 0, *diagram)
        image.paste(
            tile.resize((WIDE, HIGH), Image.Resampling.LANCZOS), ((k % across) * WIDE, k // across * HIGH)
        )
    path.parent.mkdir(parents=True, exist_ok=True)
    image.save(path, optimize=True)
