"""The recipe of a scarf on a dress stand."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hall_app.build.film import Look, Solid
from hall_app.build.recipes.recipe import LACQUER, Inputs, OnFrame, Progress, cover, shown_colour

if TYPE_CHECKING:
    from sim_core.garment import Garment

__all__ = ["ScarfOnStand"]


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
