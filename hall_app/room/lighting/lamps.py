"""Spots in the ceiling over booths, dais and stands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from hall_app.room.patch import Frame
from hall_app.room.structure.regions import Regions
from hall_app.room.surface.palette import linear

if TYPE_CHECKING:
    from hall_app.content.folder import Exhibit
    from hall_app.content.schema import PlanFile, Solid
    from hall_app.light.model import Spot

__all__ = ["spots_of"]

_WARM = "#FFF0DA"
_POWER = {"booth": 1.6, "dais": 1.9, "stand": 1.2}  # light on a white surface at 1 m, facing the lamp
_PALE = 0.15  # of it before a pale backdrop, which the room alone lights nearly to its palette tone


def spots_of(plan: PlanFile, exhibits: Sequence[Exhibit] = ()) -> list[Spot]:
    """One spot for each place where exhibits stand, from the ceiling before it down to the height of a breast."""
    from hall_app.light.model import Spot

    regions = Regions(plan)
    spots = []
    for solid in plan.solid:
        if solid.kind not in _POWER or (placed := _front(solid)) is None:
            continue
        frame, ahead, aim = placed
        ceiling = regions.height_at(float(frame.at[0]), float(frame.at[2])) or plan.height
        lamp = frame.moved(y=ceiling - 0.6, z=ahead)
        spots.append(
            Spot(
                position=lamp.at,
                towards=frame.moved(y=aim).at,
                colour=linear(_WARM),
                power=_POWER[solid.kind] * (_PALE if solid.backdrop == "pale" else 1.0),
                cone=22.0,
                soft=12.0,
            )
        )
    return spots


def _front(solid: Solid) -> tuple[Frame, float, float] | None:
    """Frame of the place, how far before it the lamp hangs, height it is aimed at [m]."""
    if solid.round is not None:
        return Frame.on_floor((solid.round.x, solid.round.z), solid.facing), 1.2, solid.height + 0.3
    if solid.at is None:
        return None
    return Frame.on_floor(solid.at, solid.facing), 2.0, solid.height + 1.1
