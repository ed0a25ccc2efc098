"""What lies beneath cloth: closed surfaces (a figure in a pose, garments worn under it) or a stand, as one solid."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np

from sim_core.body.stand import Stand
from sim_core.cloth import HalfSpace, Solid, Union, field_of
from sim_core.cloth.contact import DistanceField, closed, hull_mesh, united
from sim_core.errors import SimCoreError

__all__ = ["HANDS", "Beneath", "Surface"]

BAND = 0.04  # [m] of the distance fields: further off cloth asks for nothing
MARGIN = 0.06  # [m] of a field around what lies beneath
HANDS = 0.0025  # [m] that hands reach beyond their hulls: cells of 8 mm round the tips of fingers off by up to 2.3 mm


Box = tuple[tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class Surface:
    """A closed mesh that cloth lies on: vertices (V, 3) float64 [m], faces (F, 3) int32 counter-clockwise from outside.

    hulls: point sets (N,) int32 of its vertices whose convex hulls count as solid, hands that cloth must slide over;
    thicker [m]: by how much it reaches beyond its mesh, as a garment beneath another does; hulls_thicker [m]: the hulls
    beyond their points.
    """

    vertices: np.ndarray
    faces: np.ndarray
    hulls: tuple[np.ndarray, ...] = ()
    thicker: float = 0.0
    hulls_thicker: float = 0.0


@dataclass(frozen=True)
class Beneath:
    """What lies beneath: closed surfaces, the first of which is the wearer, or a stand.

    cell [m] of their distance field; box: its lowest and highest corner [m] (None: around the surfaces); floor: whether
    the floor y = 0 is there, too; closing [m]: gaps between and in the surfaces are filled that no ball of that radius
    enters. Equal nodes make equal values, so a field is kept with where its nodes lie.
    """

    surfaces: tuple[Surface, ...] = ()
    stand: Stand | None = None
    cell: float = 0.008
    box: Box | None = None
    floor: bool = False
    closing: float = 0.0

    def solid(self) -> Solid | None:
        """What cloth is kept out of, made anew from the surfaces: the same values on one machine."""
        if self.stand is not None:
            return self.stand.collider()
        if not self.surfaces:
            return HalfSpace() if self.floor else None
        own = self.field().solid()
        return Union((own, HalfSpace())) if self.floor else own

    def field(self) -> DistanceField:
        """min(first, others - thicker) of all of them, gaps filled; raises SimCoreError where there is no surface."""
        if not self.surfaces:
            raise SimCoreError("beneath: no surface – a field needs one")
        points = np.concatenate([surface.vertices for surface in self.surfaces])
        low, high = points.min(0) - MARGIN, points.max(0) + MARGIN
        box = self.box or (tuple(low.tolist()), tuple(high.tolist()))
        found: DistanceField | None = None
        for surface in self.surfaces:
            made = self._field(surface.vertices, surface.faces, box)
            for index in surface.hulls:
                hull = self._field(*hull_mesh(surface.vertices[index]), box)
                made = united(made, hull, thicker=surface.hulls_thicker)
            found = made if found is None else united(found, made, thicker=surface.thicker)
        assert found is not None
        return closed(found, self.closing)

    def _field(self, vertices: np.ndarray, faces: np.ndarray, box: Box) -> DistanceField:
        return field_of(vertices, faces, cell=self.cell, band=BAND, box=box, far=False)

    def digest(self) -> str:
        """A hash of all that decides the field."""
        told = (self.stand, self.cell, self.box, self.floor, *([self.closing] if self.closing else []))
        hashed = hashlib.sha256(repr(told).encode())
        for surface in self.surfaces:
            for array in (surface.vertices, surface.faces, *surface.hulls):
                hashed.update(array.tobytes())
            hashed.update(repr(surface.thicker).encode())
            if surface.hulls_thicker:  # figures known before it was told keep their name
                hashed.update(repr(surface.hulls_thicker).encode())
        return hashed.hexdigest()[:16]
