"""Walls, openings and furniture of the plan as parts of the room. Colours: the palette of the hall."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..content.models import Opening, Solid, Wall
from .room import Part, box, drum, merged, prism

__all__ = ["PALETTE", "opening", "solid", "wall"]

PALETTE = {
    "plaster": "#EAE2D0",
    "floor": "#7D7D78",
    "stone": "#A3A197",
    "wood": "#6B4632",
    "lacquer": "#482A25",
    "boards": "#8A6448",
    "vermilion": "#7C2A22",
    "gold": "#B8934A",
    "pale": "#CDD8D8",
    "dark": "#36424A",
    "paper": "#FBF3DC",
}

WAINSCOT = 0.90  # [m]
RAIL = 0.06
BAR = 0.04
LATTICE_CELL = 0.24


def _frame(start: tuple[float, float], end: tuple[float, float]) -> tuple[NDArray[np.float64], float, float]:
    """Middle [x, z], length [m] and facing [deg] of a line on the floor."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    along = b - a
    return (a + b) / 2, float(np.hypot(*along)), float(np.degrees(np.arctan2(-along[1], along[0])))


def _slab(wall: Wall, low: float, high: float, colour: str, extra: float = 0.0) -> Part:
    middle, length, facing = _frame(wall.start, wall.end)
    size = (length + wall.thickness, wall.thickness + extra)
    return box((middle[0], middle[1]), size, facing, low, high, colour)


def wall(value: Wall) -> Part:
    """A plastered wall with wainscot and rails, or a wooden lattice on a low panel."""
    top = value.height
    if value.kind == "lattice":
        return _lattice(value)
    return merged(
        [
            _slab(value, 0.0, 0.14, PALETTE["lacquer"], 0.03),
            _slab(value, 0.14, WAINSCOT, PALETTE["wood"], 0.015),
            _slab(value, WAINSCOT, WAINSCOT + RAIL, PALETTE["lacquer"], 0.05),
            _slab(value, WAINSCOT + RAIL, top - 0.55, PALETTE["plaster"]),
            _slab(value, top - 0.55, top - 0.55 + RAIL, PALETTE["lacquer"], 0.04),
            _slab(value, top - 0.55 + RAIL, top - 0.22, PALETTE["plaster"]),
            _slab(value, top - 0.22, top, PALETTE["vermilion"], 0.05),
        ]
    )


def _lattice(value: Wall) -> Part:
    middle, length, facing = _frame(value.start, value.end)
    a, b = np.asarray(value.start, float), np.asarray(value.end, float)
    along = (b - a) / max(length, 1e-9)
    thick = min(value.thickness, 0.09)
    parts = [
        box((middle[0], middle[1]), (length, value.thickness), facing, 0.0, 0.9, PALETTE["wood"]),
        box((middle[0], middle[1]), (length, thick), facing, 0.9, 0.98, PALETTE["lacquer"]),
        box(
            (middle[0], middle[1]),
            (length, thick),
            facing,
            value.height - 0.1,
            value.height,
            PALETTE["lacquer"],
        ),
    ]
    for share in np.linspace(0, 1, max(2, round(length / LATTICE_CELL)) + 1):
        at = a + along * (BAR / 2 + share * (length - BAR))
        parts.append(box((at[0], at[1]), (BAR, BAR), facing, 0.98, value.height - 0.1, PALETTE["lacquer"]))
    for height in np.arange(0.98 + 2 * LATTICE_CELL, value.height - 0.2, 2 * LATTICE_CELL):
        parts.append(
            box((middle[0], middle[1]), (length, BAR * 0.8), facing, height, height + BAR, PALETTE["lacquer"])
        )
    return merged(parts)


def opening(value: Opening, thickness: float) -> Part:
    """A paper window behind bars, or a door of two leaves, set on both faces of a wall."""
    middle, length, facing = _frame(value.start, value.end)
    at = (float(middle[0]), float(middle[1]))
    low, high = value.sill, value.sill + value.height
    deep = thickness + 0.02
    if value.kind == "door":
        leaf = [box(at, (length, deep), facing, low, high, PALETTE["vermilion"])]
        frame = box(at, (length + 0.24, deep + 0.04), facing, high, high + 0.16, PALETTE["lacquer"])
        return merged([*leaf, frame, box(at, (0.03, deep + 0.02), facing, low, high, PALETTE["lacquer"])])
    parts = [
        box(at, (length, deep), facing, low, high, PALETTE["paper"]),
        box(at, (length + 0.16, deep + 0.06), facing, low - 0.09, low, PALETTE["lacquer"]),
        box(at, (length + 0.16, deep + 0.06), facing, high, high + 0.09, PALETTE["lacquer"]),
    ]
    turn = np.radians(facing)
    along = np.array([np.cos(turn), -np.sin(turn)])
    for share in np.linspace(-0.5, 0.5, max(2, round(length / LATTICE_CELL)) + 1):
        bar = middle + along * share * length
        parts.append(box((bar[0], bar[1]), (BAR, deep + 0.05), facing, low, high, PALETTE["wood"]))
    for height in np.arange(low + LATTICE_CELL, high - 0.1, LATTICE_CELL * 1.5):
        parts.append(box(at, (length, deep + 0.045), facing, height, height + BAR, PALETTE["wood"]))
    return merged(parts)


def solid(value: Solid) -> Part:
    """One booth, bench, stand or column."""
    return {"column": _column, "bench": _bench, "booth": _booth, "stand": _stand}[value.kind](value)


def _footprint(value: Solid, low: float, high: float, colour: str, grow: float = 0.0) -> Part:
    if value.round is not None:
        return drum((value.round.x, value.round.z), value.round.radius + grow, low, high, colour)
    if value.size is not None and value.at is not None:
        size = (value.size[0] + 2 * grow, value.size[1] + 2 * grow)
        return box(value.at, size, value.facing, low, high, colour)
    return prism(np.asarray(value.polygon, float), low, high, colour)


def _column(value: Solid) -> Part:
    if value.round is None:
        return _footprint(value, 0.0, value.height, PALETTE["lacquer"])
    at, radius = (value.round.x, value.round.z), value.round.radius
    return merged(
        [
            drum(at, radius, 0.0, 0.30, PALETTE["stone"], top=radius * 0.86),
            drum(at, radius * 0.78, 0.30, value.height, PALETTE["lacquer"], top=radius * 0.7, sides=20),
            drum(at, radius * 0.81, 0.30, 0.36, PALETTE["gold"], sides=20),
        ]
    )


def _bench(value: Solid) -> Part:
    seat = max(value.height - 0.07, 0.05)
    return merged(
        [
            _footprint(value, seat, value.height, PALETTE["wood"]),
            _footprint(value, 0.0, seat, PALETTE["lacquer"], grow=-0.04),
        ]
    )


def _booth(value: Solid) -> Part:
    """A stone plinth with a wooden deck; a cloth wall stands along its back."""
    base = value.height
    parts = [
        _footprint(value, 0.0, base * 0.75, PALETTE["stone"]),
        _footprint(value, base * 0.75, base, PALETTE["wood"], grow=-0.02),
    ]
    if value.backdrop != "none" and value.size is not None and value.at is not None:
        parts.extend(_backdrop(value, base))
    return merged(parts)


def _backdrop(value: Solid, base: float) -> list[Part]:
    assert value.size is not None
    assert value.at is not None
    width, depth = value.size
    turn = np.radians(value.facing)
    front = np.array([np.sin(turn), np.cos(turn)])
    along = np.array([np.cos(turn), -np.sin(turn)])
    back = np.asarray(value.at) - front * (depth / 2 - 0.09)
    top = base + 2.3

    def standing(share: float, size: tuple[float, float], low: float, high: float, colour: str) -> Part:
        at = back + along * share
        return box((at[0], at[1]), size, value.facing, low, high, PALETTE[colour])

    half = width / 2 - 0.1
    return [
        standing(0.0, (2 * half, 0.05), base, top - 0.1, value.backdrop),
        standing(-half, (0.09, 0.10), base, top, "lacquer"),
        standing(half, (0.09, 0.10), base, top, "lacquer"),
        standing(0.0, (2 * half + 0.34, 0.13), top - 0.1, top, "lacquer"),
        standing(-half - 0.2, (0.06, 0.14), top - 0.11, top + 0.01, "gold"),
        standing(half + 0.2, (0.06, 0.14), top - 0.11, top + 0.01, "gold"),
    ]


def _stand(value: Solid) -> Part:
    high = value.height
    return merged(
        [
            _footprint(value, 0.0, min(0.08, high / 3), PALETTE["stone"]),
            _footprint(value, min(0.08, high / 3), high - 0.05, PALETTE["lacquer"], grow=-0.05),
            _footprint(value, high - 0.05, high, PALETTE["wood"]),
        ]
    )
