"""The recipes `hall build` knows: each drapes a garment, and says what its film, stills and models show beside it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ..content.exhibit_file import GarmentRecipe
from .film import Look, Solid

if TYPE_CHECKING:
    from sim_core.garment import Garment, Pattern
    from sim_core.garment.figure import Figure
    from sim_core.garment.schedule import Pose
    from sim_core.weave import SurfaceMaps, Weave

__all__ = ["RECIPES", "Inputs", "Recipe", "read_inputs"]

Progress = Callable[[float, str], None]
OnFrame = Callable[[np.ndarray, "np.ndarray | None"], None]
Colour = tuple[float, float, float]

LACQUER, LINEN = (0.28, 0.13, 0.10), (0.84, 0.80, 0.73)
HALL_FIGURE = 1600  # triangles of a figure in the hall


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


class ScarfOnStand:
    """A long strip over the bar of a dress stand."""

    def __init__(self, inputs: Inputs) -> None:
        self._in = inputs

    def prepare(self, progress: Progress, checkpoint: Path) -> None:
        return None

    def drape(self, progress: Progress, checkpoint: Path, on_frame: OnFrame | None) -> Garment:
        from sim_core.garment import scarf_on_stand

        return scarf_on_stand(
            self._in.pattern,
            self._in.weave,
            edge=self._in.table.edge,
            seed=self._in.table.seed,
            progress=progress,
            checkpoint=checkpoint,
            on_frame=None if on_frame is None else lambda index, x: on_frame(x, None),
        )

    def look(self) -> Look:
        from sim_core.garment import Stand

        return self._look(self._in.pattern.mesh(self._in.table.edge).faces.astype(np.int32), Stand().mesh(20))

    def still(self, garment: Garment) -> Look:
        from sim_core.garment import Stand

        return self._look(garment.faces, Stand(**garment.provenance["stand"]).mesh(28))

    def _look(self, faces: np.ndarray, stand: tuple[np.ndarray, np.ndarray]) -> Look:
        colour = shown_colour(self._in.pattern.dye, self._in.maps)
        solid = Solid(*stand, LACQUER, 0.35)
        return Look(((faces, colour),), (solid,), cover(self._in.maps), float(stand[0][:, 1].max()))

    def beside(self, garment: Garment, precision: str) -> dict[str, Any]:
        return {}

    def clear_of(self, garment: Garment) -> Any:
        return None


class RobeOnFigure:
    """Panels sewn and dressed on the mannequin."""

    def __init__(self, inputs: Inputs) -> None:
        from sim_core.errors import SimCoreError
        from sim_core.garment.schedule import Pose, Schedule

        if inputs.mannequin is None:
            raise SimCoreError("recipe robe_on_figure: names no mannequin – add garment.mannequin")
        self._in, self._schedule = inputs, Schedule(Pose(inputs.table.arm, inputs.table.elbow))

    def prepare(self, progress: Progress, checkpoint: Path) -> None:
        return None

    def _figure(self) -> Figure:
        from sim_core.garment.figure import Figure
        from sim_core.garment.mannequin import Mannequin

        assert self._in.mannequin is not None
        return Figure(Mannequin.load(self._in.mannequin))

    def drape(self, progress: Progress, checkpoint: Path, on_frame: OnFrame | None) -> Garment:
        from sim_core.garment.robe import robe_on_figure

        figure = self._figure()

        def heard(index: int, x: np.ndarray, pose: Pose) -> None:
            assert on_frame is not None
            on_frame(x.astype(np.float32), figure.mesh(pose)[0].astype(np.float32))

        return robe_on_figure(
            self._in.pattern,
            self._in.weave,
            figure,
            edge=self._in.table.edge,
            schedule=self._schedule,
            progress=progress,
            checkpoint=checkpoint,
            on_frame=heard if on_frame else None,
        )

    def look(self) -> Look:
        from sim_core.garment.schedule import Pose

        cloth = self._in.pattern.cloth(self._in.table.edge).mirrored()
        return self._look(cloth.faces, cloth.panel, Pose())

    def still(self, garment: Garment) -> Look:
        return self._look(garment.faces, garment.panel, self._schedule.pose)

    def _look(self, faces: np.ndarray, panel: np.ndarray, pose: Pose) -> Look:
        from sim_core.cloth import Cylinder
        from sim_core.garment.shown import BASE
        from sim_core.garment.solids import solid_mesh

        pattern = self._in.pattern
        colours = [shown_colour(p.dye or pattern.dye, self._in.maps) for p in pattern.panels]
        which = panel % len(colours)
        parts = tuple(
            (faces[np.isin(which, [k for k, c in enumerate(colours) if c == colour])], colour)
            for colour in dict.fromkeys(colours)
        )
        vertices, body = self._figure().mesh(pose)
        base = solid_mesh(Cylinder((0, 0, 0), (0, BASE[1], 0), BASE[0], 0.4 * BASE[1]), 48)
        solids = (Solid(vertices, body, LINEN, 0.05, BASE[1]), Solid(*base, LACQUER, 0.35))
        return Look(parts, solids, 1.0, float(vertices[:, 1].max()) + BASE[1], BASE[1])

    def beside(self, garment: Garment, precision: str) -> dict[str, Any]:
        from sim_core.garment.shown import shown_figure

        body = self._figure().mesh(self._schedule.pose)
        most = HALL_FIGURE if precision == "hall" else None
        return {"figure": shown_figure(*body, garment.positions, garment.faces, triangles=most)}

    def clear_of(self, garment: Garment) -> Any:
        return None


def _pibo_on_figure(inputs: Inputs) -> Recipe:
    from .pibo_recipe import PiboOnFigure

    return PiboOnFigure(inputs)


RECIPES: dict[str, Callable[[Inputs], Recipe]] = {
    "scarf_on_stand": ScarfOnStand,
    "robe_on_figure": RobeOnFigure,
    "pibo_on_figure": _pibo_on_figure,
}
