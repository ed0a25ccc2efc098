"""A garment that is worn while its wearer stands or moves: simulated on from where it was draped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, TypedDict, Unpack

import numpy as np

from sim_core.cloth import Contact, Drape, Phase, drape, moving_mesh
from sim_core.cloth.step import FRAME
from sim_core.errors import SimCoreError
from sim_core.garment.garment import Garment
from sim_core.garment.garment_sheet import garment_sheet, standing
from sim_core.garment.outfit.outfit import UNTANGLE

__all__ = ["follow"]

CONTACT = Contact(
    0.005, 0.0025, 0.004, speed_limit=8.0, untangle=UNTANGLE
)  # of cloth that does not say its own
DAMPING = 1.5  # [1/s] of cloth that hangs on someone who walks
FASTEST = 8.0  # [m/s] that cloth may go where its wearer moves


class Hooks(TypedDict, total=False):
    """Who hears of the frames, and a file to go on from."""

    progress: Callable[[float, str], None] | None
    on_frame: Callable[[int, np.ndarray], None] | None
    checkpoint: Path | None


def follow(
    garment: Garment,
    body: np.ndarray | None = None,
    faces: np.ndarray | None = None,
    *,
    seconds: float | None = None,
    cell: float = 0.008,
    contact: Contact | None = None,
    damping: float | None = None,
    **hooks: Unpack[Hooks],
) -> Drape:
    """Lets the garment hang on, or follow its wearer, frame by frame of 1/25 s.

    Without a body it goes on for `seconds` where it was settled, with the contact, holds, friction and damping it was
    settled with: what came to rest stays at rest. body (T, B, 3) [m]: the wearer's vertices at the begin and then at
    the end of every frame, the first as the garment was draped on; faces (F, 3): closed, counter-clockwise from
    outside. T = 1: a wearer who stands still, for `seconds`; otherwise `seconds` more than the motion are stood still
    at its end. cell [m]: of the distance fields. contact, damping: other than the garment's own.
    on_frame(index, positions (V, 3) float32) hears every frame; checkpoint: file to go on from.
    Raises SimCoreError before anything runs where the wearer's mesh is open, not finite, there is no time to run, or
    the garment does not say what it was settled with and no wearer is given.
    """
    settled = garment.settled
    if body is None or faces is None:
        if settled is None:
            raise SimCoreError(
                f"follow: garment {garment.name} does not say what it was settled with – give its wearer's vertices "
                "and faces, or bake it again"
            )
        if not seconds:
            raise SimCoreError("follow: the wearer stands still – say for how many seconds")
        phase = settled.phase(seconds)
        phase = phase if damping is None else replace(phase, damping=damping)
        return standing(garment)([phase], contact=contact or settled.contact, **hooks)
    wearer = moving_mesh(body, faces, cell=cell)
    usual: dict[str, Any] = {"damping": DAMPING if damping is None else damping}
    if settled is not None:
        usual["friction"] = settled.last.friction
        fastest = max(FASTEST, settled.contact.speed_limit)
        contact = contact or replace(settled.contact, speed_limit=fastest, untangle=UNTANGLE)
    phases: list[Phase] = []
    if wearer.count > 1:
        way = (0.0, float(wearer.count - 1))
        phases.append(Phase((wearer.count - 1) * FRAME, label="following", body=way, **usual))
    if seconds:
        phases.append(Phase(seconds, label="standing", **usual))
    if not phases:
        raise SimCoreError("follow: the wearer stands still – say for how many seconds")
    return drape(
        garment_sheet(garment),
        garment.positions,
        phases,
        collider=wearer,
        contact=contact or CONTACT,
        holds=settled and settled.holds,
        **hooks,
    )
