"""What a layer is dressed on, key by key: the wearer's body and the garments it wears already, or a stand."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sim_core.body import Beneath, Figure, Surface
from sim_core.cloth import HalfSpace, MovingGrid, Solid
from sim_core.errors import SimCoreError
from sim_core.garment.dressing.course import Moves
from sim_core.garment.outfit import Layer, Outfit
from sim_core.garment.placement import WORN, Ground

__all__ = ["Trail", "Wearing", "capped"]

MARGIN = 0.06  # [m] of the fields around what lies beneath
SETTLED = 0.2  # share of the way, at its end, on which a garment beneath goes over to where it came to rest
Box = tuple[tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class Trail:
    """A garment worn beneath: faces (F, 3), and its positions (T, V, 3) [m] when the wearer's pose was shares (T,) of
    the way from the first to the last; the last frame is where it came to rest."""

    faces: np.ndarray
    shares: np.ndarray
    frames: np.ndarray

    def at(self, share: float) -> np.ndarray:
        """Positions (V, 3) [m] in between; towards the end it goes over to rest."""
        moving = max(1, len(self.frames) - 1)
        here = float(np.interp(share, self.shares[:moving], np.arange(moving)))
        k = min(int(here), moving - 1)
        following = min(k + 1, moving - 1)
        x = (1 - (here - k)) * self.frames[k] + (here - k) * self.frames[following]
        t = np.clip((share - (1 - SETTLED)) / SETTLED, 0.0, 1.0)
        rest = t * t * (3 - 2 * t)
        return (1 - rest) * x + rest * self.frames[-1]


@dataclass(frozen=True)
class Wearing:
    """The wearer and what it wears, in the poses of `moves`; floor: whether what is dressed may reach it; closing [m]:
    as of `Beneath`."""

    outfit: Outfit
    moves: Moves
    trails: tuple[Trail, ...] = ()
    floor: bool = False
    closing: float = 0.0

    @cached_property
    def figure(self) -> Figure | None:
        """The wearer with its fields; None on a stand."""
        return None if self.outfit.wearer is None else Figure(self.outfit.wearer)

    def meshes(self, key: int) -> list[tuple[np.ndarray, np.ndarray]]:
        """Closed meshes of the garments worn beneath, in a pose."""
        return [capped(*garment) for garment in self.garments(key)]

    def garments(self, key: int) -> list[tuple[np.ndarray, np.ndarray]]:
        """Positions (V, 3) [m] and faces of the garments worn beneath, in a pose."""
        return [(trail.at(self.moves.shares[key]), trail.faces) for trail in self.trails]

    def ground(self, layer: Layer) -> Ground:
        """What the layer is placed on: everything in the first pose."""
        stand, clearance = self.outfit.stand, layer.program.contact.clearance
        if self.figure is None:
            return Ground(stand=stand, clearance=clearance, edge=layer.edge)
        pose, mannequin = self.moves.poses[0], self.figure.mannequin
        vertices, faces = self.figure.mesh(pose)
        return Ground(
            vertices,
            faces,
            self.figure.trunk(),
            mannequin.landmarks(pose),
            tuple(self.meshes(0)),
            None,
            clearance,
            layer.edge,
        )

    def beneath(self, key: int, *, half: bool = False) -> Beneath:
        """Everything in the pose of a key; half: with the nodes of the left half alone."""
        if self.figure is None:
            return Beneath(stand=self.outfit.stand)
        (body,) = self.figure.beneath(self.moves.poses[key]).surfaces
        surfaces = [body, *(Surface(x, faces, thicker=WORN) for x, faces in self.meshes(key))]
        box = self._box(half=half)
        return Beneath(tuple(surfaces), None, self.figure.cell, box, self.floor, self.closing)

    def solid(self, *, half: bool) -> Solid | MovingGrid:
        """What the cloth is kept out of; of a wearer that moves, its fields made when they are needed."""
        if self.figure is None:
            assert self.outfit.stand is not None
            return self.outfit.stand.collider()
        origin, _ = self._box(half=half)
        count = len(self.moves.poses)
        return MovingGrid(
            origin,
            self.figure.cell,
            count,
            lambda key: self.beneath(key, half=half).field().values,
            self._name(half),
            beside=HalfSpace() if self.floor else None,
        )

    def _name(self, half: bool) -> str:
        """Tells this body and its ways from any other."""
        assert self.figure is not None
        spreads = [pose.spread for pose in self.moves.poses]
        told = (self.figure.name, self.moves, half, *([self.closing] if self.closing else []))
        told += (spreads,) if min(spreads) < 1.0 else ()
        hashed = hashlib.sha256(repr(told).encode())
        for trail in self.trails:
            hashed.update(trail.frames.tobytes() + trail.faces.tobytes())
        return hashed.hexdigest()[:16]

    def _box(self, *, half: bool) -> Box:
        """Around the wearer in its first, middle and last pose, on whole cells from the middle plane."""
        assert self.figure is not None
        keys = sorted({0, len(self.moves.poses) // 2, len(self.moves.poses) - 1})
        points = [self.figure.mesh(self.moves.poses[key])[0] for key in keys]
        points += [trail.at(self.moves.shares[key]) for trail in self.trails for key in keys]
        everything = np.concatenate(points)
        low, high = everything.min(0) - MARGIN, everything.max(0) + MARGIN
        cell = self.figure.cell
        reach = cell * float(np.ceil(max(high[0], -low[0]) / cell))
        beyond = cell * (2.0 + float(np.ceil(2 * self.closing / cell)))  # a gap in the middle is filled whole
        first = -beyond if half else -reach
        return (first, float(low[1]), float(low[2])), (reach, float(high[1]), float(high[2]))


def capped(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V + L, 3) and faces of a mesh whose L border loops are closed by fans about their middles.

    Raises SimCoreError where the border is no set of loops.
    """
    ahead = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    key = ahead[:, 0] * len(vertices) + ahead[:, 1]
    free = ahead[~np.isin(key, ahead[:, 1] * len(vertices) + ahead[:, 0])]
    following = dict(zip(free[:, 0].tolist(), free[:, 1].tolist(), strict=True))
    if len(following) != len(free):
        raise SimCoreError("capped: the border touches itself – weld the garment first")
    middles, fans = [], []
    while following:
        first, at = next(iter(following.items()))
        loop = [first]
        del following[first]
        while at != first:
            loop.append(at)
            if at not in following:
                raise SimCoreError("capped: the border ends – the faces are wound unevenly")
            at = following.pop(at)
        centre = len(vertices) + len(middles)
        middles.append(vertices[loop].mean(0))
        ring = np.array(loop)
        fans.append(np.column_stack([np.roll(ring, -1), ring, np.full(len(ring), centre)]))
    if not middles:
        return vertices, faces
    return np.concatenate([vertices, middles]), np.concatenate([faces, *fans]).astype(np.int32)
