"""The recipe of a scarf over a robe: the robe is dressed first, and both go into film, stills and models."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hall_app.build.film import Look, Solid
from hall_app.build.recipes.recipe import Inputs, OnFrame, Progress, cover, shown_colour
from hall_app.build.recipes.robe import RobeOnFigure

if TYPE_CHECKING:
    from sim_core.garment import Garment

__all__ = ["PiboOnFigure"]

HALL_ROBE = 0.004  # [m] by how much the robe under a scarf may deviate in the hall, p99


class PiboOnFigure:
    """A scarf round the back and over the forearms of the mannequin, which wears a robe."""

    def __init__(self, inputs: Inputs) -> None:
        from sim_core.errors import SimCoreError

        table = inputs.table
        if not (inputs.mannequin and inputs.robe_pattern and inputs.robe_weave):
            raise SimCoreError(
                "recipe pibo_on_figure: needs garment.mannequin, robe_pattern and robe_weave – add them"
            )
        robe = table.model_copy(update={"pattern": table.robe_pattern, "edge": table.robe_edge})
        self._in = inputs
        self._under = RobeOnFigure(
            replace(
                inputs,
                table=robe,
                pattern=inputs.robe_pattern,
                weave=inputs.robe_weave,
                maps=inputs.robe_maps,
            )
        )
        self._robes: dict[str, Garment] = {}

    def prepare(self, progress: Progress, checkpoint: Path) -> None:
        from sim_core.garment import Garment

        done = checkpoint.with_name("robe.npz")
        if not done.is_file():
            self._under.drape(progress, checkpoint, None).save(done)
        self._robes["close"] = Garment.load(done)

    def drape(self, progress: Progress, checkpoint: Path, on_frame: OnFrame | None) -> Garment:
        from sim_core.body.mannequin import Mannequin
        from sim_core.body.pose import Pose
        from sim_core.garment.recipes.pibo import pibo_on_figure

        table, robe = self._in.table, self._robes["close"]
        assert self._in.mannequin is not None
        garment = pibo_on_figure(
            self._in.pattern,
            self._in.weave,
            Mannequin.load(self._in.mannequin),
            beneath=robe,
            pose=Pose.arms(table.arm, table.elbow),
            edge=table.edge,
            seed=table.seed,
            progress=progress,
            checkpoint=checkpoint,
            on_frame=None if on_frame is None else lambda index, x: on_frame(x.astype(np.float32), None),
        )
        under = {f"robe_{name}": value for name, value in robe.provenance["errors"].items()}
        errors = {**garment.provenance["errors"], **under}
        stages = {**garment.provenance["seconds"], "robe": robe.provenance["seconds"]["drape"]}
        return garment.noted(errors=errors, seconds=stages)

    def look(self) -> Look:
        cloth = self._in.pattern.cloth(self._in.table.edge).mirrored()
        return self._look(cloth.faces)

    def still(self, garment: Garment) -> Look:
        return self._look(garment.faces)

    def _look(self, faces: np.ndarray) -> Look:
        robe = self._robes["close"]
        dressed = self._under.still(robe)
        lift = dressed.lift
        layers = tuple(Solid(robe.positions, part, colour, 0.08, lift) for part, colour in dressed.cloth)
        colour = shown_colour(self._in.pattern.dye, self._in.maps)
        alpha = max(cover(self._in.maps), 0.6)
        return Look(((faces, colour),), (*dressed.solids, *layers), alpha, dressed.height, lift)

    def beside(self, garment: Garment, precision: str) -> dict[str, Any]:
        assert self._in.robe_maps is not None
        robe = self._robe_at(precision)
        return {**self._under.beside(robe, precision), "beneath": (robe, self._in.robe_maps)}

    def _robe_at(self, precision: str) -> Garment:
        """The robe as fine as the model needs it; in the hall its own cheapest level."""
        from sim_core.garment import choose_detail

        if precision not in self._robes:
            own = self._robes["close"]
            self._robes[precision] = choose_detail(own, HALL_ROBE)
        return self._robes[precision]

    def clear_of(self, garment: Garment) -> Any:
        from sim_core.body.mannequin import Mannequin
        from sim_core.body.pose import Pose
        from sim_core.garment.recipes.pibo import PiboSettings, field_under, solids_under

        assert self._in.mannequin is not None
        pose = Pose.arms(self._in.table.arm, self._in.table.elbow)
        solids = solids_under(Mannequin.load(self._in.mannequin), pose, self._robe_at("hall"))
        return field_under(solids, PiboSettings(), whole=True).solid()
