"""What fills the openings of a wall: lattice windows before glowing paper, doors of several leaves."""

from __future__ import annotations

import numpy as np

from hall_app.room.parts.lattice import bars
from hall_app.room.patch import UP, Frame, Patch, box, panel, quad

__all__ = ["door", "window"]

_FRAME = 0.09  # [m] width of the frame round an opening


def window(frame: Frame, width: float, height: float, depth: float) -> list[Patch]:
    """A window whose sill lies in the frame's origin: frame, reveal, real bars, and paper `depth` behind them."""
    patches = _reveal(frame, width, height, depth, "wood") + _surround(frame, width, height, sill=True)
    rim = 0.045
    for x0, x1 in ((-width / 2, -width / 2 + rim), (width / 2 - rim, width / 2)):
        patches += box(frame, (x0, 0, -0.05), (x1, height, 0.005), "lacquer", skip="back top bottom")
    for y0, y1 in ((0.0, rim), (height - rim, height)):
        patches += box(
            frame,
            (-width / 2 + rim, y0, -0.05),
            (width / 2 - rim, y1, 0.005),
            "lacquer",
            skip="back left right",
        )
    patches += bars(frame.moved(y=rim, z=-0.004), width - 2 * rim, height - 2 * rim, "wood")
    return patches + _sheet(frame, width, height, depth, "paper")


def door(frame: Frame, width: float, height: float, depth: float) -> list[Patch]:
    """A door of two to four closed leaves: panels below, lattice before paper above; studs and rings of brass."""
    patches = _reveal(frame, width, height, depth, "lacquer") + _surround(frame, width, height, sill=False)
    leaves = 2 if width < 1.8 else 4
    wide = width / leaves
    for k in range(leaves):
        inwards = -0.05 - 0.008 * (k % 2)  # every other leaf a little deeper: the joint shows, no gap
        patches += _leaf(frame.moved(x=-width / 2 + (k + 0.5) * wide, z=inwards), wide, height)
    for side in (-1, 1):
        ring = frame.moved(x=side * 0.10, y=1.12, z=-0.05)
        patches += box(ring, (-0.03, -0.09, 0), (0.03, 0.09, 0.012), "gold", skip="back")
        knob = Frame(ring.at, ring.facing)
        patches += box(knob, (-0.012, -0.03, 0.012), (0.012, 0.03, 0.04), "gold", skip="back")
    return patches + _sheet(frame, width, height, depth, "paper")


def _leaf(frame: Frame, width: float, height: float) -> list[Patch]:
    half, stile, waist = width / 2, 0.07, min(1.0, 0.4 * height)
    patches = []
    for x0, x1 in ((-half, -half + stile), (half - stile, half)):
        patches += box(frame, (x0, 0, -0.05), (x1, height, 0), "lacquer", skip="back top bottom")
    for y0, y1 in ((0.0, 0.10), (waist, waist + 0.07), (height - 0.08, height)):
        patches += box(
            frame, (-half + stile, y0, -0.05), (half - stile, y1, -0.004), "lacquer", skip="back left right"
        )
    patches += box(
        frame,
        (-half + stile, 0.10, -0.05),
        (half - stile, waist, -0.025),
        "band",
        skip="back left right top bottom",
    )
    inset = 0.06
    patches += box(
        frame,
        (-half + stile + inset, 0.10 + inset, -0.03),
        (half - stile - inset, waist - inset, -0.008),
        "band",
        skip="back",
    )
    lattice = frame.moved(y=waist + 0.07, z=-0.004)
    return patches + bars(lattice, width - 2 * stile, height - waist - 0.15, "wood", cell=0.17)


def _reveal(frame: Frame, width: float, height: float, depth: float, material: str) -> list[Patch]:
    """The four inner sides of an opening, from the wall's face back to the paper."""
    half = width / 2
    sides = [
        [(-half, 0, 0), (-half, 0, -depth), (-half, height, -depth), (-half, height, 0)],
        [(half, 0, -depth), (half, 0, 0), (half, height, 0), (half, height, -depth)],
        [(-half, 0, 0), (half, 0, 0), (half, 0, -depth), (-half, 0, -depth)],
        [(-half, height, -depth), (half, height, -depth), (half, height, 0), (-half, height, 0)],
    ]
    return [quad(frame(side), material) for side in sides]


def _surround(frame: Frame, width: float, height: float, *, sill: bool) -> list[Patch]:
    """The frame on the wall's face."""
    half, proud = width / 2, 0.035
    low = -_FRAME if sill else 0.0
    patches = box(
        frame, (-half - _FRAME, height, 0), (half + _FRAME, height + _FRAME, proud), "lacquer", skip="back"
    )
    for x0, x1 in ((-half - _FRAME, -half), (half, half + _FRAME)):
        patches += box(frame, (x0, low, 0), (x1, height, proud), "lacquer", skip="back top")
    if sill:
        patches += box(frame, (-half, -_FRAME, 0), (half, 0, proud), "lacquer", skip="back left right")
        ledge = half + _FRAME + 0.04
        patches += box(frame, (-ledge, -_FRAME - 0.05, 0), (ledge, -_FRAME, 0.055), "lacquer", skip="back")
    return patches


def _sheet(frame: Frame, width: float, height: float, depth: float, material: str) -> list[Patch]:
    """Paper that glows."""
    import shapely

    right, _, front = frame.axes
    shape = shapely.box(-width / 2, 0, width / 2, height)
    return panel(frame.at - np.multiply(depth, front), right, UP, shape, material)
