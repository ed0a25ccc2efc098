"""What a recipe of `hall build` is: it drapes a garment, and says what its film, stills and models show beside it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from hall_app.build.film import Look
from hall_app.content.schema.exhibit import GarmentRecipe

if TYPE_CHECKING:
    from sim_core.garment import Garment, Pattern
    from sim_core.weave import SurfaceMaps, Weave

__all__ = [
    "LACQUER",
    "LINEN",
    "Inputs",
    "OnFrame",
    "Progress",
    "Recipe",
    "cover",
    "read_inputs",
    "shown_colour",
]

Progress = Callable[[float, str], None]
OnFrame = Callable[[np.ndarray, "np.ndarray | None"], None]
Colour = tuple[float, float, float]

LACQUER, LINEN = (0.28, 0.13, 0.10), (0.84, 0.80, 0.73)


@dataclass(frozen=True)
class Inputs:
    """What a recipe is given: the exhibit's table, pattern, weave with its maps; mannequin file and robe if named."""

    table: GarmentRecipe
    pattern: Pattern
    weave: Weave
    maps: SurfaceMaps
    mannequin: Path | None
    robe_pattern: Pattern | None = None
    robe_weave: Weave | None = None
    robe_maps: SurfaceMaps | None = None


class Recipe(Protocol):
    """One way to drape, made from Inputs."""

    def prepare(self, progress: Progress, checkpoint: Path) -> None:
        """Whatever must be there before the film begins: the robe under a scarf."""
        ...

    def drape(self, progress: Progress, checkpoint: Path, on_frame: OnFrame | None) -> Garment:
        """Simulate; on_frame(positions (P, 3) of the look's cloth, moved solid (V, 3) or None) hears every frame."""
        ...

    def look(self) -> Look:
        """What the film shows while it is draped."""
        ...

    def still(self, garment: Garment) -> Look:
        """What the stills show: the welded garment (its `positions`)."""
        ...

    def beside(self, garment: Garment, precision: str) -> dict[str, Any]:
        """Further arguments of `write_glb`: what stands in the model beside the cloth."""
        ...

    def clear_of(self, garment: Garment) -> Any:
        """The solid that the hall's coarser mesh is moved out of, None: as the garment knows."""
        ...


def read_inputs(folder: Path, table: GarmentRecipe) -> Inputs:
    """Reads pattern and weave, and draws the weave's maps. Raises what reading raises, naming file and remedy."""
    from sim_core.garment import Pattern
    from sim_core.weave import Weave, solve, surface_maps

    pattern, weave = Pattern.load(folder / table.pattern), Weave.load(folder / table.weave)
    mannequin = folder / table.mannequin if table.mannequin else None
    maps = surface_maps(weave, solve(weave, particles=True), pixels=512)
    if table.robe_pattern is None or table.robe_weave is None:
        return Inputs(table, pattern, weave, maps, mannequin)
    robe, cloth = Pattern.load(folder / table.robe_pattern), Weave.load(folder / table.robe_weave)
    woven = surface_maps(cloth, solve(cloth, particles=True), pixels=512)
    return Inputs(table, pattern, weave, maps, mannequin, robe, cloth, woven)


def shown_colour(dye: Colour | None, maps: SurfaceMaps) -> Colour:
    """The colour [sRGB] of cloth seen from afar: its dye, else the mean of its yarns."""
    red, green, blue = dye if dye is not None else maps.albedo.reshape(-1, 3).mean(axis=0) / 255
    return (float(red), float(green), float(blue))


def cover(maps: SurfaceMaps) -> float:
    """Share of the light that the cloth stops."""
    return float(maps.opacity.mean() / 255)
