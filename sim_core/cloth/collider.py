"""Solids a cloth can lie on: frozen values with an exact signed distance, packed for the compiled loops."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from sim_core.errors import SimCoreError

CAPSULE, CYLINDER, BOX, HALFSPACE, GRID, MOVING = range(6)
FASTEST = 4  # column of a moving grid: the most that its distance changes anywhere between the two keys [m]
_WIDTH, _BALL = 20, 16  # the last four: centre and radius of a ball around the solid (-1: endless)
_NO_GRID = np.zeros((2, 2, 2), np.float32)
_AT_REST = np.zeros(2)


class Packed(NamedTuple):
    """Solids as arrays: kind (P,), data (P, 20), and the nodes of at most one grid, float32.

    A moving grid lies between `grid` and `later`: blend (2,) is how far, 0..1, and how fast [1/s].
    """

    kind: np.ndarray
    data: np.ndarray
    grid: np.ndarray
    later: np.ndarray = _NO_GRID
    blend: np.ndarray = _AT_REST


def _vector(name: str, value: object) -> np.ndarray:
    array = np.asarray(value, float)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise SimCoreError(f"{name}: {value} – expected three finite numbers (x, y, z) in metres")
    return array


def _positive(name: str, value: float, *, zero: bool = False) -> float:
    if not np.isfinite(value) or value < 0 or (value == 0 and not zero):
        raise SimCoreError(f"{name}: {value} – must be a finite length above 0 [m]")
    return float(value)


class Solid:
    """Common face of all solids; the distance is negative inside."""

    def packed(self) -> Packed:
        """The arrays the compiled distance reads."""
        kind, row, grid = self._row()
        data = np.zeros((1, _WIDTH))
        data[0, : len(row)] = row
        data[0, _BALL:] = self._ball()
        return Packed(np.array([kind]), data, grid)

    def _row(self) -> tuple[int, np.ndarray, np.ndarray]:
        raise NotImplementedError

    def _ball(self) -> np.ndarray:
        return np.array([0.0, 0.0, 0.0, -1.0])

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Signed distance (N,) [m] at points (N, 3)."""
        from sim_core.cloth.distance import distances

        return distances(self.packed(), np.ascontiguousarray(points, float))


@dataclass(frozen=True)
class Capsule(Solid):
    """All points within `radius` of the segment from `start` to `end`; equal ends make a ball."""

    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float

    def _row(self) -> tuple[int, np.ndarray, np.ndarray]:
        start, end = _vector("capsule.start", self.start), _vector("capsule.end", self.end)
        return CAPSULE, np.r_[start, end, _positive("capsule.radius", self.radius)], _NO_GRID

    def _ball(self) -> np.ndarray:
        start, end = np.asarray(self.start, float), np.asarray(self.end, float)
        return np.r_[(start + end) / 2, np.linalg.norm(end - start) / 2 + self.radius]


@dataclass(frozen=True)
class Cylinder(Solid):
    """A cylinder from `start` to `end` with flat caps whose rims are rounded by `rounding`."""

    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float
    rounding: float = 0.0

    def _row(self) -> tuple[int, np.ndarray, np.ndarray]:
        start, end = _vector("cylinder.start", self.start), _vector("cylinder.end", self.end)
        length = float(np.linalg.norm(end - start))
        _positive("cylinder: distance from start to end", length)
        _positive("cylinder.radius", self.radius)
        if not 0 <= self.rounding <= min(self.radius, length / 2):
            raise SimCoreError(f"cylinder.rounding: {self.rounding} – at most the radius and half the length")
        middle, axis = (start + end) / 2, (end - start) / length
        return CYLINDER, np.r_[middle, axis, length / 2, self.radius, self.rounding], _NO_GRID

    def _ball(self) -> np.ndarray:
        start, end = np.asarray(self.start, float), np.asarray(self.end, float)
        return np.r_[(start + end) / 2, np.linalg.norm(end - start) / 2 + self.radius]


@dataclass(frozen=True)
class Box(Solid):
    """A box of full `size` about `centre`, edges rounded by `rounding`; turned by `yaw` [rad] about +y."""

    centre: tuple[float, float, float]
    size: tuple[float, float, float]
    rounding: float = 0.0
    yaw: float = 0.0

    def _row(self) -> tuple[int, np.ndarray, np.ndarray]:
        centre, half = _vector("box.centre", self.centre), _vector("box.size", self.size) / 2
        if half.min() <= 0 or not 0 <= self.rounding <= half.min() or not np.isfinite(self.yaw):
            raise SimCoreError(
                f"box: size {self.size}, rounding {self.rounding} – sizes above 0, rounding at most half"
            )
        return BOX, np.r_[centre, half, self.rounding, np.cos(self.yaw), np.sin(self.yaw)], _NO_GRID

    def _ball(self) -> np.ndarray:
        return np.r_[np.asarray(self.centre, float), np.linalg.norm(self.size) / 2]


@dataclass(frozen=True)
class HalfSpace(Solid):
    """Everything behind the plane through `point` with outward `normal`: a floor or an incline."""

    point: tuple[float, float, float] = (0.0, 0.0, 0.0)
    normal: tuple[float, float, float] = (0.0, 1.0, 0.0)

    def _row(self) -> tuple[int, np.ndarray, np.ndarray]:
        normal = _vector("halfspace.normal", self.normal)
        _positive("halfspace.normal: its length", float(np.linalg.norm(normal)))
        return (
            HALFSPACE,
            np.r_[normal / np.linalg.norm(normal), _vector("halfspace.point", self.point)],
            _NO_GRID,
        )


@dataclass(frozen=True)
class GridSdf(Solid):
    """Sampled signed distance: values (nx, ny, nz) [m] at origin + index * cell, trilinear between."""

    origin: tuple[float, float, float]
    cell: float
    values: np.ndarray = field(repr=False)

    def _row(self) -> tuple[int, np.ndarray, np.ndarray]:
        values = np.ascontiguousarray(self.values, np.float32)
        if values.ndim != 3 or min(values.shape) < 2 or not np.isfinite(values).all():
            raise SimCoreError(
                f"grid: shape {values.shape} – expected a finite (nx, ny, nz), at least 2 each way"
            )
        return GRID, np.r_[_vector("grid.origin", self.origin), _positive("grid.cell", self.cell)], values

    @staticmethod
    def sample(solid: Solid, low: np.ndarray, high: np.ndarray, cell: float) -> GridSdf:
        """The grid of another solid's distance over the box from `low` to `high` (3,)."""
        axes = [np.arange(a, b + cell, cell) for a, b in zip(low, high, strict=True)]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        values = solid.distance(points.reshape(-1, 3)).reshape(points.shape[:3])
        return GridSdf((float(low[0]), float(low[1]), float(low[2])), cell, values)


@dataclass(frozen=True)
class Union(Solid):
    """Several solids as one; outside, the distance is exact. At most one grid may be among them."""

    parts: tuple[Solid, ...]

    def packed(self) -> Packed:
        """The parts' arrays, one below the other."""
        for part in self.parts:
            if not isinstance(part, Solid):
                raise SimCoreError(f"union: a {type(part).__name__} – its parts are solids")
        packs = [part.packed() for part in self.parts]
        if not packs:
            raise SimCoreError("union: no parts – name at least one solid")
        if sum(int((pack.kind == GRID).sum()) for pack in packs) > 1:
            raise SimCoreError("union: more than one grid – sample them into one")
        grid = next((pack.grid for pack in packs if GRID in pack.kind), _NO_GRID)
        kind, data = np.concatenate([p.kind for p in packs]), np.concatenate([p.data for p in packs])
        return Packed(kind, data, grid)
