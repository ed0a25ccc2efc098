"""Columns, beams, bands and brackets (斗拱, one block and three small ones)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hall_app.room.patch import Frame, Patch, box, disc, prism, quad, tube
from hall_app.room.structure.frame import Beam, Column, beams_of, columns_of
from hall_app.room.structure.regions import Regions

if TYPE_CHECKING:
    from hall_app.content.schema import PlanFile

__all__ = ["timber_of"]

BAND = (0.22, 0.20)  # [m] width and depth of the red band under an arcade's beam
_FORWARD = 0.11  # [m] brackets stand this far before the arcade's middle, half out of the wall above it
_CORBEL = (0.62, 0.20, 0.24)  # [m] reach, width and height of the arm under a beam's end at a wall


def timber_of(plan: PlanFile, regions: Regions) -> list[Patch]:
    """The frame: columns up to what they carry, beams, bands and brackets."""
    beams = beams_of(plan, regions)
    patches: list[Patch] = []
    for column in columns_of(plan):
        patches += _standing(column, _load(column, beams, regions))
        patches += _bracketed(column, beams, regions)
    for beam in beams:
        patches += _lying(beam)
    return patches


def _touching(column: Column, beams: list[Beam]) -> list[Beam]:
    return [beam for beam in beams if column.at in (beam.start, beam.end)]


def _load(column: Column, beams: list[Beam], regions: Regions) -> float:
    """Height [m] the shaft rises to: the underside of what rests on it."""
    carried = _touching(column, beams)
    arcade = [beam.low for beam in carried if beam.arcade]
    if arcade:
        return min(arcade)
    ceiling = regions.height_at(*column.at) or column.height
    return max([min(beam.low for beam in carried)] if carried else [ceiling])


def _standing(column: Column, top: float) -> list[Patch]:
    """A stone base, a drum, a lacquered shaft with a gold ring."""
    half = column.half
    frame = Frame.on_floor(column.at, column.facing)
    if column.square:
        patches = box(frame, (-half, 0, -half), (half, 0.10, half), "stone", skip="bottom")
        drum = half * 0.81
    else:
        patches = tube(frame, [(half, 0), (half, 0.10)], "stone") + disc(frame.moved(y=0.10), half, "stone")
        drum = half * 0.92
    shaft = drum * 0.74
    patches += tube(frame, [(drum, 0.10), (drum * 1.02, 0.15), (drum * 0.86, 0.22)], "stone")
    patches += disc(frame.moved(y=0.22), drum * 0.86, "stone")
    patches += tube(frame, [(shaft, 0.22), (shaft * 0.89, top)], "lacquer", sides=20)
    at = top - 0.42
    ring = shaft * (1 - 0.11 * at / top) + 0.008
    patches += tube(frame, [(ring, at), (ring, at + 0.07)], "gold", sides=20)
    return patches


def _lying(beam: Beam) -> list[Patch]:
    a, b = np.asarray(beam.start), np.asarray(beam.end)
    length = float(np.linalg.norm(b - a))
    along = (b - a) / length
    facing = float(np.degrees(np.arctan2(-along[1], along[0])))
    frame, half = Frame.on_floor(a, facing), beam.width / 2
    patches = box(frame, (0, beam.low, -half), (length, beam.high, half), "lacquer", skip="left right")
    if beam.arcade:
        half = BAND[0] / 2
        patches += box(
            frame, (0, beam.low - BAND[1], -half), (length, beam.low, half), "band", skip="left right top"
        )
        for z, sign in ((half, 1), (-half, -1)):
            y = beam.low - BAND[1] + 0.025
            line = [(0, y, z), (length, y, z), (length, y + 0.018, z), (0, y + 0.018, z)]
            points = np.array(line[::sign] if sign > 0 else [line[1], line[0], line[3], line[2]], float)
            points[:, 2] += sign * 0.003
            patches.append(quad(frame(points), "gold", density=5.0))
    if beam.on_wall:
        patches += _corbel(frame.moved(x=length, y=beam.low))
    return patches


def _corbel(frame: Frame) -> list[Patch]:
    """An arm out of the wall (at local x = 0, towards -x) under a beam's end, cut upwards in facets."""
    reach, wide, rise = _CORBEL
    outline = [
        (0, -rise),
        (-0.45 * reach, -rise),
        (-0.8 * reach, -0.75 * rise),
        (-reach, -0.4 * rise),
        (-reach, 0),
        (0, 0),
    ]
    return prism(frame, outline[::-1], wide, "lacquer")


def _bracketed(column: Column, beams: list[Beam], regions: Regions) -> list[Patch]:
    """The bracket set over an arcade's column, towards the higher room; carved struts where beams meet columns."""
    arcade = [beam for beam in _touching(column, beams) if beam.arcade]
    patches: list[Patch] = []
    if arcade:
        base = max(beam.high for beam in arcade)
        for beam in _touching(column, beams):
            if not beam.arcade and beam.low > base + 0.35:
                a, b = np.asarray(column.at), np.asarray(beam.end if beam.start == column.at else beam.start)
                way = (b - a) / np.linalg.norm(b - a)
                facing = float(np.degrees(np.arctan2(way[0], way[1])))
                frame = Frame.on_floor(a, facing, base).moved(z=_FORWARD)
                patches += _dougong(frame, beam.low - base)
    return patches


def _dougong(frame: Frame, rise: float) -> list[Patch]:
    """一斗三升 of `rise` [m]: a great block, crossed arms, small blocks, a plate; its front towards +z."""
    s = rise / 0.58
    patches = _block(frame, 0.44, 0.54, 0.22 * s)
    arms = frame.moved(y=0.16 * s)
    patches += _arm(arms, 1.30, 0.15, 0.16 * s)
    patches += _arm(arms.moved(turn=90), 1.06, 0.15, 0.16 * s)
    for x in (-0.54, 0.0, 0.54):
        patches += _block(frame.moved(x=x, y=0.32 * s), 0.18, 0.25, 0.12 * s)
    patches += _block(frame.moved(z=0.42, y=0.32 * s), 0.18, 0.25, 0.12 * s)
    patches += _arm(frame.moved(y=0.44 * s), 1.62, 0.15, rise - 0.44 * s)
    patches += _arm(frame.moved(y=0.44 * s, turn=90), 1.30, 0.15, rise - 0.44 * s)
    return patches


def _block(frame: Frame, low: float, high: float, rise: float) -> list[Patch]:
    """A bearing block: sloped below, upright above, square in plan."""
    levels = [(low / 2, 0.0), (high / 2, 0.45 * rise), (high / 2, rise)]
    patches = []
    for turn in (0, 90, 180, 270):
        side = frame.moved(turn=turn)
        for (h0, y0), (h1, y1) in zip(levels, levels[1:], strict=False):
            corners = [(-h0, y0, h0), (h0, y0, h0), (h1, y1, h1), (-h1, y1, h1)]
            patches.append(_trapezium(side(corners), "lacquer"))
    top = [
        (-high / 2, rise, high / 2),
        (high / 2, rise, high / 2),
        (high / 2, rise, -high / 2),
        (-high / 2, rise, -high / 2),
    ]
    patches.append(quad(frame(top), "lacquer", density=5.0))
    return patches


def _trapezium(corners: np.ndarray, material: str) -> Patch:
    """A symmetrical trapezium, flat coordinates true to its shape."""
    low, high = np.linalg.norm(corners[1] - corners[0]), np.linalg.norm(corners[2] - corners[3])
    lift = (corners[3] + corners[2] - corners[0] - corners[1]) / 2
    rise = np.linalg.norm(lift)
    wide = max(low, high)
    flat = [
        [(wide - low) / 2, 0],
        [(wide + low) / 2, 0],
        [(wide + high) / 2, rise],
        [(wide - high) / 2, rise],
    ]
    return Patch(material, corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32), np.array(flat), density=5.0)


def _arm(frame: Frame, long: float, wide: float, rise: float) -> list[Patch]:
    """A bracket arm along local x whose ends are cut upwards in two facets."""
    half = long / 2
    outline = [
        (-half + 0.16, 0.0),
        (half - 0.16, 0.0),
        (half - 0.04, 0.35 * rise),
        (half, 0.65 * rise),
        (half, rise),
        (-half, rise),
        (-half, 0.65 * rise),
        (-half + 0.04, 0.35 * rise),
    ]
    return prism(frame, outline, wide, "lacquer")
