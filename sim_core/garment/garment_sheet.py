"""A garment as the cloth engine sees it."""

from __future__ import annotations

from dataclasses import fields
from functools import partial

import numpy as np

from sim_core.cloth import Drape, Material, Sheet, drape
from sim_core.cloth.sheet import evened
from sim_core.errors import SimCoreError
from sim_core.garment.garment import Garment

__all__ = ["APART", "garment_sheet", "standing"]

APART = 5.0  # [m] panels that overlap in pattern axes are laid apart for what counts as one stretch of cloth


def garment_sheet(garment: Garment) -> Sheet:
    """The garment as a sheet: its welded vertices, the pattern's lengths, the materials and masses it was draped with.

    Raises SimCoreError where the garment does not say what it is made of.
    """
    told = garment.material.get("kinds")
    if not isinstance(told, dict) or not told:
        raise SimCoreError(f"garment {garment.name}: its material is not told – bake it again")
    materials = [_material(garment, kind) for kind in told.values()]
    panels = garment.cut.get("panels") or [{"name": "cloth"}]
    of_panel = [list(told).index(garment.material["panels"][panel["name"]]) for panel in panels]
    apart = [number if panel.get("along") else 0 for number, panel in enumerate(panels)]
    own = garment.panel % len(panels)  # the right half's panels follow the left's
    corner = garment.rest_corners() + APART * np.array(apart)[own][:, None, None] * np.array([1.0, 0.0])
    kinds = np.array(of_panel, np.int32)[own]
    sheet = Sheet.of_corners(corner, garment.faces, materials, kinds, creases=garment.creases())
    if garment.settled is None or not garment.settled.even:
        return sheet
    return evened(sheet, np.array([material.density for material in materials])[kinds])


def standing(garment: Garment) -> partial[Drape]:
    """`drape` of a garment that says what it was settled with, from where it came to rest: to be called with phases and
    what shall be otherwise."""
    settled = garment.settled
    assert settled is not None
    touching = {
        "collider": settled.beneath.solid(),
        "contact": settled.contact,
        "holds": settled.holds,
    }
    return partial(drape, garment_sheet(garment), garment.positions, **touching)


def _material(garment: Garment, told: object) -> Material:
    """The material of a garment's table, of which it keeps more than a solver needs."""
    names = {field.name for field in fields(Material)}
    try:
        assert isinstance(told, dict)
        return Material(**{name: value for name, value in told.items() if name in names})
    except (AssertionError, TypeError) as error:
        raise SimCoreError(f"garment {garment.name}: its material is not told – bake it again") from error
