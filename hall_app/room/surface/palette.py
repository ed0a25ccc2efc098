"""What the room is made of: colours, textures, and how finely light is sampled on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["BACKDROPS", "MATERIALS", "Material", "linear"]

# Radiosity of what shines, linear, relative to a white wall that is lit by 1.
LAYLIGHT, WINDOW, LANTERN = 2.6, 2.6, 5.0


@dataclass(frozen=True, slots=True)
class Material:
    """A surface of the room.

    colour: mean sRGB "#rrggbb"; texture: name in textures.TEXTURES or None; tile: metres one texture spans along
    and across the grain; density: texels of the light map per metre; glow: linear radiosity of a lamp, else 0,
    tint: its colour.
    """

    colour: str
    texture: str | None
    tile: tuple[float, float] = (1.0, 1.0)
    density: float = 10.0
    glow: float = 0.0
    tint: str = "#FFFFFF"


MATERIALS: dict[str, Material] = {
    "plaster": Material("#EAE2D0", "plaster", (3.2, 3.2)),
    "floor": Material("#7D7D78", "tiles", (2.4, 2.4)),
    "stone": Material("#A3A197", "stone", (1.3, 1.3)),
    "wood": Material("#6B4632", "wood", (1.7, 0.55)),
    "panel": Material("#6B4632", "panel", (1.8, 0.9)),
    "lacquer": Material("#482A25", "lacquer", (2.2, 0.7)),
    "ceiling": Material("#8A6448", "boards", (2.4, 1.2)),
    "joist": Material("#7A5740", "wood", (1.9, 0.6)),
    "band": Material("#7C2A22", "lacquer", (2.6, 0.8)),
    "curtain": Material("#74302B", "cloth", (0.5, 0.5), 6.0),
    "gold": Material("#B8934A", None),
    "pale": Material("#CDD8D8", "cloth", (0.9, 0.9)),
    "dark": Material("#243C50", "cloth", (0.9, 0.9)),
    "signs": Material("#E8E0CC", "signs"),
    "paper": Material("#FFF8E6", "paper", (1.2, 1.2), 2.0, WINDOW, "#FFF7E6"),
    "laylight": Material("#FFFAEC", "paper", (1.2, 1.2), 2.0, LAYLIGHT, "#FFFCF5"),
    "lantern": Material("#F6DFA9", "lantern", (1.0, 1.0), 2.0, LANTERN, "#FFD999"),
}

BACKDROPS = {"pale": MATERIALS["pale"].colour, "dark": MATERIALS["dark"].colour}


def linear(colour: str) -> NDArray[np.float64]:
    """'#rrggbb' (sRGB) as (3,) linear light."""
    value = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
