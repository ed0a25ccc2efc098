"""Mean error from an engine's own limit against processor milliseconds a frame, both logarithmic; a scene a panel."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from cloth_figures import NEAR
from PIL import Image, ImageDraw, ImageFont

WIDE, HIGH, EDGE, FINE = 760, 520, 70, 2
LEAST = 1e-5  # [mm] what is nearer its limit is drawn there
COLOURS = {
    "ours": (24, 90, 140),
    "Newton VBD": (90, 140, 70),
    "Newton Style3D": (150, 90, 160),
    "MuJoCo Euler": (196, 120, 30),
    "MuJoCo discrete": (190, 60, 60),
    "MuJoCo discrete, passive contact": (120, 30, 30),
    "Blender": (110, 110, 110),
}


def curves_of(figures: dict) -> dict[str, list[tuple[float, float]]]:
    """Engine -> (cpu ms a frame, mean mm from its own limit), without limits and runs that exploded."""
    rows = {
        "ours": [
            (r["cpu_ms"], r["error"]["mean"]) for r in figures["ours"]["settings"] + figures["ours"]["rows"]
        ]
    }
    for engine, peer in figures["peers"].items():
        rows[engine] = [(r["cpu_ms"], r["own"]["mean"]) for r in peer.get("rows", []) if not r["is_limit"]]
    kept = {
        engine: [(ms, max(mm, LEAST)) for ms, mm in points if mm is not None and np.isfinite(mm)]
        for engine, points in rows.items()
    }
    return {engine: sorted(points) for engine, points in kept.items() if points}


class Panel:
    """One diagram: where values are, and how they are drawn."""

    def __init__(self, draw, font, row: int, curves: dict) -> None:
        self.draw, self.font, self.row, self.curves = draw, font, row, curves
        every = np.log10([point for points in curves.values() for point in points])
        self.low, self.top = np.floor(every.min(0)), np.ceil(every.max(0) + 1e-9)
        self.top = np.maximum(self.top, self.low + 1)

    def at(self, ms: float, mm: float) -> tuple[float, float]:
        u, v = (np.log10([ms, mm]) - self.low) / (self.top - self.low)
        y = self.row * HIGH + HIGH - EDGE - v * (HIGH - EDGE - 50)
        return float((EDGE + u * (WIDE - EDGE - 30)) * FINE), float(y * FINE)

    def axes(self, title: str) -> None:
        ends = 10.0**self.low, 10.0**self.top
        self.draw.text((EDGE * FINE, (self.row * HIGH + 16) * FINE), title, fill=(20, 20, 20), font=self.font)
        for decade in 10.0 ** np.arange(self.low[0], self.top[0] + 1):
            self.draw.line([self.at(decade, ends[0][1]), self.at(decade, ends[1][1])], fill=(225, 225, 225))
            x, y = self.at(decade, ends[0][1])
            self.draw.text((x - 10 * FINE, y + 6 * FINE), f"{decade:g}", fill=(70, 70, 70), font=self.font)
        for decade in 10.0 ** np.arange(self.low[1], self.top[1] + 1):
            self.draw.line([self.at(ends[0][0], decade), self.at(ends[1][0], decade)], fill=(225, 225, 225))
            x, y = self.at(ends[0][0], decade)
            self.draw.text((x - 60 * FINE, y - 8 * FINE), f"{decade:g}", fill=(70, 70, 70), font=self.font)
        self.draw.line(
            [self.at(ends[0][0], NEAR), self.at(ends[1][0], NEAR)], fill=(200, 160, 160), width=FINE
        )

    def lines(self) -> None:
        for n, (name, points) in enumerate(self.curves.items()):
            places, colour, r = [self.at(*p) for p in points], COLOURS[name], 4 * FINE
            self.draw.line(places, fill=colour, width=2 * FINE)
            for x, y in places:
                self.draw.ellipse([x - r, y - r, x + r, y + r], fill=colour)
            place = ((WIDE - 250) * FINE, (self.row * HIGH + HIGH - EDGE - 115 + 17 * n) * FINE)
            self.draw.text(place, name, fill=colour, font=self.font)


def plot(results: dict, path: Path) -> None:
    """Draws every scene of the results into one picture; the pale red line is 2 mm."""
    image = Image.new("RGB", (WIDE * FINE, HIGH * FINE * len(results)), "white")
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(14 * FINE)
    for row, (scene, figures) in enumerate(results.items()):
        panel = Panel(draw, font, row, curves_of(figures))
        panel.axes(f"{scene}: mean distance from own limit [mm] against cpu ms a frame")
        panel.lines()
    path.parent.mkdir(parents=True, exist_ok=True)
    image.resize((WIDE, HIGH * len(results)), Image.Resampling.LANCZOS).save(path, optimize=True)
