"""Bar lattices: in windows and doors, and as free-standing screens of several leaves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hall_app.room.patch import Frame, Patch, box

__all__ = ["bars", "screen"]

BAR, DEEP = 0.035, 0.045  # [m] width of a bar and how far it reaches back
_STILE = 0.07
_PANEL, _WAIST = 0.86, 1.10  # [m] top of the lower panel, of the small panel above it


def bars(
    frame: Frame, width: float, height: float, material: str, *, cell: float = 0.24, both: bool = False
) -> list[Patch]:
    """A stepped lattice that fills 0 … height above the frame's origin and ±width/2 beside it.

    Uprights every `cell` [m]; horizontals between them, each column half a step above the next, and a ring of
    rails near the rim, as carpenters join it. both: seen from behind as well.
    """
    columns = max(2, round(width / cell))
    step = width / columns
    half, back = BAR / 2, "" if both else "back "
    patches = []
    for k in range(1, columns):
        x = -width / 2 + k * step
        patches += box(frame, (x - half, 0, -DEEP), (x + half, height, 0), material, skip=back + "top bottom")
    rows = max(2, round(height / (2 * cell)))
    rise = height / rows
    for k in range(columns):
        x0, x1 = -width / 2 + k * step, -width / 2 + (k + 1) * step
        x0, x1 = x0 + half * (k > 0), x1 - half * (k < columns - 1)
        rim = min(0.5 * cell, 0.2 * height)
        inner = [(j + (0.5 if k % 2 else 0.0)) * rise for j in range(rows + 1)]
        levels = [rim, *(y for y in inner if rim + 0.1 < y < height - rim - 0.1), height - rim]
        for y in levels:
            patches += box(
                frame,
                (x0, y - half, -DEEP),
                (x1, y + half, -0.006),
                material,
                skip=back + "left right",
            )
    return patches


def screen(start: Sequence[float], end: Sequence[float], height: float, thickness: float) -> list[Patch]:
    """A row of lattice leaves from `start` to `end` [x, z], seen from both sides; panels below, lattice above."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    length = float(np.linalg.norm(b - a))
    along = (b - a) / length
    facing = float(np.degrees(np.arctan2(-along[1], along[0])))
    frame = Frame.on_floor(a, facing)
    deep = min(thickness, 0.09) / 2
    patches = box(frame, (0, 0, -deep), (length, 0.10, deep), "lacquer", skip="bottom left right")
    patches += box(frame, (0, height - 0.10, -deep), (length, height, deep), "lacquer", skip="left right")
    leaves = max(1, round(length / 0.82))
    wide = length / leaves
    for k in range(leaves + 1):
        x0, x1 = max(0.0, k * wide - _STILE / 2), min(length, k * wide + _STILE / 2)
        patches += box(frame, (x0, 0.10, -deep), (x1, height - 0.10, deep), "lacquer", skip="top bottom")
    for k in range(leaves):
        patches += _leaf(frame.moved(x=(k + 0.5) * wide, y=0.10), wide - _STILE, height - 0.20, deep)
    return patches


def _leaf(frame: Frame, width: float, height: float, deep: float) -> list[Patch]:
    half, thin = width / 2, deep * 0.45
    patches = []
    panel_top, waist_top = min(_PANEL, 0.4 * height), min(_WAIST, 0.55 * height)
    for low, high in ((0.0, panel_top), (panel_top + 0.05, waist_top)):
        patches += box(frame, (-half, low, -thin), (half, high, thin), "wood", skip="left right bottom top")
        inset = 0.07
        if high - low > 3 * inset:
            patches += box(
                frame,
                (-half + inset, low + inset, -deep * 0.8),
                (half - inset, high - inset, deep * 0.8),
                "panel",
            )
    for low in (panel_top, waist_top):
        patches += box(
            frame, (-half, low, -deep * 0.9), (half, low + 0.05, deep * 0.9), "lacquer", skip="left right"
        )
    patches += bars(
        frame.moved(y=waist_top + 0.05, z=DEEP / 2),
        width,
        height - waist_top - 0.05,
        "wood",
        cell=0.19,
        both=True,
    )
    return patches
