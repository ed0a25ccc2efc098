"""The recipe of a robe on a figure."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hall_app.build.film import Look, Solid
from hall_app.build.recipes.recipe import LACQUER, LINEN, Inputs, OnFrame, Progress, shown_colour

if TYPE_CHECKING:
    from sim_core.body.pose import Pose
    from sim_core.body.wearer import Figure
    from sim_core.garment import Garment

__all__ = ["RobeOnFigure"]

HALL_FIGURE = 1600  # triangles of a figure in the hall


class RobeOnFigure:
    """Panels sewn and dressed on the mannequin."""

    def __init__(self, inputs: Inputs) -> None:
        from sim_core.body.pose import Pose
        from sim_core.errors import SimCoreError
        from sim_core.garment.recipes.schedule import Schedule

        if inputs.mannequin is None:
            raise SimCoreError("recipe robe_on_figure: names no mannequin – add garment.mannequin")
        self._in, self._schedule = inputs, Schedule(Pose.arms(inputs.table.arm, inputs.table.elbow))

    def prepare(self, progress: Progress, checkpoint: Path) -> None:
        return None

    def _figure(self) -> Figure:
        from sim_core.body.mannequin import Mannequin
        from sim_core.body.wearer import Figure

        assert self._in.mannequin is not None
        return Figure(Mannequin.load(self._in.mannequin))

    def drape(self, progress: Progress, checkpoint: Path, on_frame: OnFrame | None) -> Garment:
        from sim_core.garment.recipes.robe import robe_on_figure

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
        from sim_core.body.pose import Pose

        cloth = self._in.pattern.cloth(self._in.table.edge).mirrored()
        return self._look(cloth.faces, cloth.panel, Pose())

    def still(self, garment: Garment) -> Look:
        return self._look(garment.faces, garment.panel, self._schedule.pose)

    def _look(self, faces: np.ndarray, panel: np.ndarray, pose: Pose) -> Look:
        from sim_core.cloth import Cylinder
        from sim_core.cloth.contact.solid_meshes import solid_mesh
        from sim_core.garment.levels.figure import BASE

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
        from sim_core.garment.levels.figure import shown_figure

        body = self._figure().mesh(self._schedule.pose)
        most = HALL_FIGURE if precision == "hall" else None
        return {"figure": shown_figure(*body, garment.positions, garment.faces, triangles=most)}

    def clear_of(self, garment: Garment) -> Any:
        return None
