"""The drawing of a garment's panels: one half as it is cut flat, with measures, folds and seams."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

from hall_app.media.drawings import FAINT, INK, OVER, Sheet

if TYPE_CHECKING:
    from sim_core.garment import Pattern
    from sim_core.garment.pattern.panels import Panel

__all__ = ["cutting_plan"]

SIZE = (1200, 1500)
MARGIN = 110
SPREAD = 0.07  # [m] between panels that are sewn to each other


def cutting_plan(pattern: Pattern) -> Image.Image:
    """All panels of one half side by side: x to the right, y down, the shoulder fold dashed, the warp as an arrow."""
    sheet = Sheet(SIZE)
    shifts = _shifts(pattern)
    points = [panel.outline() + shift for panel, shift in zip(pattern.panels, shifts, strict=True)]
    every = np.concatenate(points)
    low, span = every.min(0), np.ptp(every, axis=0)
    scale = float(min((SIZE[0] - 2 * MARGIN) / span[0], (SIZE[1] - 2 * MARGIN) / span[1]))
    corner = np.array(SIZE) / 2 - scale * span / 2

    def at(place: np.ndarray) -> tuple[float, float]:
        x, y = corner + scale * (np.asarray(place) - low)
        return float(x), float(y)

    for panel, outline in zip(pattern.panels, points, strict=True):
        fill = _tint(panel.dye or pattern.dye or (0.94, 0.9, 0.82))
        drawn = [at(p) for p in [*outline, outline[0]]]
        sheet.pen.polygon([(OVER * x, OVER * y) for x, y in drawn], fill=fill)
        sheet.line(drawn, INK, 2)
        if panel.along is None:
            _fold(sheet, at, outline)
        _measures(sheet, at, outline, panel)
    return sheet.finished()


def _shifts(pattern: Pattern) -> list[np.ndarray]:
    """Panels of the garment's plane stay in their order, pushed apart; bands lie to the left of them."""
    shifts, pushed, left = [], 0, 0.0
    for panel in pattern.panels:
        if panel.along is None:
            shifts.append(np.array([SPREAD * pushed, 0.0]))
            pushed += 1
        else:
            outline = panel.outline()
            left -= SPREAD + float(np.ptp(outline[:, 0]))
            shifts.append(np.array([left - outline[:, 0].min(), 0.0]))
    return shifts


def _fold(sheet: Sheet, at, outline: np.ndarray) -> None:
    """The shoulder fold, dashed, where it crosses the panel."""
    x0, x1 = (float(v) for v in _crossing(outline))
    for start in np.arange(x0, x1, 0.024):
        sheet.line([at(np.array([start, 0.0])), at(np.array([min(start + 0.014, x1), 0.0]))], FAINT, 2)


def _crossing(outline: np.ndarray) -> tuple[float, float]:
    """Where a panel's outline crosses y = 0."""
    ahead = np.roll(outline, -1, axis=0)
    meets = (outline[:, 1] <= 0) != (ahead[:, 1] <= 0)
    a, b = outline[meets], ahead[meets]
    x = a[:, 0] - a[:, 1] * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    return (float(x.min()), float(x.max())) if len(x) else (0.0, 0.0)


def _measures(sheet: Sheet, at, outline: np.ndarray, panel: Panel) -> None:
    low, high = outline.min(0), outline.max(0)
    (left, top), (right, bottom) = at(low), at(high)
    sheet.words((left + right) / 2, bottom + 24, panel.name, size=20)
    size = high - low
    if panel.along is not None:
        sheet.words((left + right) / 2, top - 20, f"{1000 * size[0]:.0f} x {1000 * size[1]:.0f}", size=18)
        return
    sheet.words((left + right) / 2, top - 20, f"{1000 * size[0]:.0f} x {1000 * size[1]:.0f} mm", size=18)


def _tint(colour: tuple[float, float, float]) -> str:
    """The dye as a wash on paper."""
    paper = np.array([0.965, 0.945, 0.902])
    r, g, b = (0.45 * np.array(colour) + 0.55 * paper) * 255
    return f"#{int(r):02x}{int(g):02x}{int(b):02x}"
