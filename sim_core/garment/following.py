"""A garment that is worn while its wearer stands or moves: simulated on from where it was draped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.cloth import Contact, Drape, Material, Phase, Sheet, drape, moving_mesh
from sim_core.cloth.step import FRAME
from sim_core.errors import SimCoreError
from sim_core.garment.halves import APART
from sim_core.garment.model import Garment
from sim_core.garment.schedule import UNTANGLE

__all__ = ["follow", "garment_sheet"]

CONTACT = Contact(0.005, 0.0025, 0.004, speed_limit=8.0, untangle=UNTANGLE)
DAMPING = 1.5  # [1/s] of cloth that hangs on someone who walks


def garment_sheet(garment: Garment) -> Sheet:
    """The garment as a sheet: its welded vertices, the pattern's lengths, the materials it was draped with.

    Raises SimCoreError where the garment does not say what it is made of.
    """
    single = _material(garment, garment.material)
    panels = garment.cut.get("panels") or garment.cut.get("panel") or []
    doubled = [bool(panel.get("doubled")) for panel in panels] or [False]
    apart = [number if panel.get("along") else 0 for number, panel in enumerate(panels)] or [0]
    own = garment.panel % len(doubled)  # the right half's panels follow the left's
    corner = garment.rest_corners() + APART * np.array(apart)[own][:, None, None] * np.array([1.0, 0.0])
    if not any(doubled):
        return Sheet.of_corners(corner, garment.faces, [single], np.zeros(len(own), np.int32))
    twice = _material(garment, garment.material.get("doubled"))
    return Sheet.of_corners(corner, garment.faces, [single, twice], np.array(doubled, np.int32)[own])


def follow(
    garment: Garment,
    body: np.ndarray,
    faces: np.ndarray,
    *,
    seconds: float | None = None,
    cell: float = 0.008,
    contact: Contact = CONTACT,
    damping: float = DAMPING,
    progress: Callable[[float, str], None] | None = None,
    on_frame: Callable[[int, np.ndarray], None] | None = None,
    checkpoint: Path | None = None,
) -> Drape:
    """Lets the garment follow its wearer, frame by frame of 1/25 s.

    body (T, B, 3) [m]: the wearer's vertices at the begin and then at the end of every frame, the first as the garment
    was draped on; faces (F, 3): closed, counter-clockwise from outside. T = 1: a wearer who stands still, for
    `seconds`; otherwise `seconds` more than the motion are stood still at its end. cell [m]: of the distance fields.
    on_frame(index, positions (V, 3) float32) hears every frame; checkpoint: file to go on from.
    Raises SimCoreError before anything runs where the wearer's mesh is open, not finite, or there is no time to run.
    """
    wearer = moving_mesh(body, faces, cell=cell)
    phases: list[Phase] = []
    if wearer.count > 1:
        way = (0.0, float(wearer.count - 1))
        phases.append(Phase((wearer.count - 1) * FRAME, damping=damping, label="following", body=way))
    if seconds:
        phases.append(Phase(seconds, damping=damping, label="standing"))
    if not phases:
        raise SimCoreError("follow: the wearer stands still – say for how many seconds")
    hooks: dict[str, Any] = {"progress": progress, "on_frame": on_frame, "checkpoint": checkpoint}
    return drape(garment_sheet(garment), garment.positions, phases, collider=wearer, contact=contact, **hooks)


def _material(garment: Garment, told: object) -> Material:
    """The material of a garment's table, of which it keeps more than a solver needs."""
    names = {field.name for field in fields(Material)}
    try:
        assert isinstance(told, dict)
        return Material(**{name: value for name, value in told.items() if name in names})
    except (AssertionError, TypeError) as error:
        raise SimCoreError(f"garment {garment.name}: its material is not told – bake it again") from error
