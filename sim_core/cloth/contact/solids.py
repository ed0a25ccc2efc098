"""Solids a cloth can lie on: frozen values with an exact signed distance, packed for the compiled loops."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sim_core.cloth.contact.distance import distances
from sim_core.cloth.contact.packed import BOX, CAPSULE, CYLINDER, GRID, HALFSPACE, NO_GRID, Packed
from sim_core.errors import SimCoreError
from sim_core.validation import FURTHEST, excerpt, finite, instance_of, numeric_array, vector3
from sim_core.validation import points as checked_points

_WIDTH, _BALL = 20, 16  # the last four: centre and radius of a ball around the solid (-1: endless)
MOST_NODES = 2e8  # of a grid


def _vector(name: str, value: object) -> np.ndarray:
    return np.array(vector3(name, value, "in metres"))


def _positive(name: str, value: object) -> float:
    return finite(f"{name} [m]", value, above=0, most=FURTHEST)


def nodes(name: str, value: object) -> np.ndarray:
    """Values (nx, ny, nz) float32 [m] at the nodes of a grid; raises SimCoreError for what is none."""
    what = "expected a finite (nx, ny, nz), at least 2 each way"
    values = numeric_array(name, value, what)
    if values.ndim != 3 or min(values.shape) < 2 or not (np.abs(values) <= FURTHEST).all():
        raise SimCoreError(f"{name}: shape {values.shape} – {what}")
    return np.ascontiguousarray(values, np.float32)


def _count(way: np.ndarray, cell: float) -> float:
    """Nodes of a grid along way (3,) [m], as a float that may be infinite."""
    with np.errstate(over="ignore"):
        return float(np.prod(way / cell + 2))


class Solid:
    """Common face of all solids; the distance is negative inside.

    Raises SimCoreError, naming the value, for a shape that cannot be.
    """

    def __post_init__(self) -> None:
        self.packed()

    def packed(self) -> Packed:
        """The arrays the compiled distance reads."""
        kind, row, grid = self._row()
        data = np.zeros((1, _WIDTH))
        data[0, : len(row)] = row
        data[0, _BALL:] = self._ball()
        return Packed(np.array([kind]), data, grid)

    def _row(self) -> tuple[int, np.ndarray, np.ndarray]:
        raise SimCoreError(
            "solid: it has no shape – take a Capsule, Cylinder, Box, HalfSpace, GridSdf or Union"
        )

    def _ball(self) -> np.ndarray:
        return np.array([0.0, 0.0, 0.0, -1.0])

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Signed distance (N,) [m] at points (N, 3)."""
        return distances(self.packed(), checked_points("points", points))


@dataclass(frozen=True)
class Capsule(Solid):
    """All points within `radius` of the segment from `start` to `end`; equal ends make a ball."""

    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float

    def _row(self) -> tuple[int, np.ndarray, np.ndarray]:
        start, end = _vector("capsule.start", self.start), _vector("capsule.end", self.end)
        return CAPSULE, np.r_[start, end, _positive("capsule.radius", self.radius)], NO_GRID

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
        if not 0 <= finite("cylinder.rounding", self.rounding) <= min(self.radius, length / 2):
            raise SimCoreError(f"cylinder.rounding: {self.rounding} – at most the radius and half the length")
        middle, axis = (start + end) / 2, (end - start) / length
        return CYLINDER, np.r_[middle, axis, length / 2, self.radius, self.rounding], NO_GRID

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
        rounding, _ = finite("box.rounding", self.rounding), finite("box.yaw", self.yaw)
        if half.min() <= 0 or not 0 <= rounding <= half.min():
            raise SimCoreError(
                f"box: size {excerpt(self.size)}, rounding {self.rounding} – sizes above 0, rounding at most half"
            )
        return BOX, np.r_[centre, half, self.rounding, np.cos(self.yaw), np.sin(self.yaw)], NO_GRID

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
            NO_GRID,
        )


@dataclass(frozen=True)
class GridSdf(Solid):
    """Sampled signed distance: values (nx, ny, nz) [m] at origin + index * cell, trilinear between."""

    origin: tuple[float, float, float]
    cell: float
    values: np.ndarray = field(repr=False)

    def _row(self) -> tuple[int, np.ndarray, np.ndarray]:
        values = nodes("grid.values", self.values)
        return GRID, np.r_[_vector("grid.origin", self.origin), _positive("grid.cell", self.cell)], values

    @staticmethod
    def sample(solid: Solid, low: np.ndarray, high: np.ndarray, cell: float) -> GridSdf:
        """The grid of another solid's distance over the box from `low` to `high` (3,)."""
        instance_of("solid", solid, Solid, "a solid is meant")
        low, high = _vector("low", low), _vector("high", high)
        _positive("cell", cell)
        if (low > high).any() or not _count(high - low, cell) <= MOST_NODES:
            raise SimCoreError(f"cell: {cell} – from low to high, in at most {MOST_NODES:g} nodes")
        axes = [np.arange(a, b + cell, cell) for a, b in zip(low, high, strict=True)]
        places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        values = solid.distance(places.reshape(-1, 3)).reshape(places.shape[:3])
        return GridSdf((float(low[0]), float(low[1]), float(low[2])), cell, values)


@dataclass(frozen=True)
class Union(Solid):
    """Several solids as one; outside, the distance is exact. At most one grid may be among them."""

    parts: tuple[Solid, ...]

    def packed(self) -> Packed:
        """The parts' arrays, one below the other."""
        if not isinstance(self.parts, tuple | list):
            raise SimCoreError(f"union: a {type(self.parts).__name__} – give its parts as a tuple of solids")
        for part in self.parts:
            instance_of("union", part, Solid, "its parts are solids")
        packs = [part.packed() for part in self.parts]
        if not packs:
            raise SimCoreError("union: no parts – name at least one solid")
        if sum(int((pack.kind == GRID).sum()) for pack in packs) > 1:
            raise SimCoreError("union: more than one grid – sample them into one")
        grid = next((pack.grid for pack in packs if GRID in pack.kind), NO_GRID)
        kind, data = np.concatenate([p.kind for p in packs]), np.concatenate([p.data for p in packs])
        return Packed(kind, data, grid)
