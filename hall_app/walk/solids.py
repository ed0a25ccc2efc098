"""What stands on the floor, as plain values: prisms, rounds and the outline of the walkable floor."""

from __future__ import annotations

import threading
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.validation import explain_validity

Points = tuple[tuple[float, float], ...]

DEFAULT_HEIGHT = 2.6  # [m] a wall of the hall
MAX_COORDINATE = 10_000.0  # [m] beyond it float64 and int16 grids lose the millimetre
_SQUARE = 1e-9  # how far from zero the cosine of a corner may be for the quadrilateral to count as a box


class SolidError(ValueError):
    """A solid or an outline that cannot be walked around: one line, what is wrong and how to mend it."""


@dataclass(frozen=True)
class Prism:
    """Upright prism over a simple polygon.

    polygon: (N, 2) [m] corners (x, z) in either sense, not repeated at the end; concave is fine.
    height: [m]. Whatever stands on the floor blocks the whole body, however low it is.
    Raises SolidError for fewer than 3 corners, non-finite or crossing outlines, no area, height <= 0.
    """

    polygon: Points
    height: float = DEFAULT_HEIGHT

    def __post_init__(self) -> None:
        object.__setattr__(self, "polygon", _checked_polygon(self.polygon, "solid"))
        _check_positive("solid", height=self.height)

    @cached_property
    def points(self) -> np.ndarray:
        """(N, 2) float64 [m], counter-clockwise in (x, z)."""
        return np.array(self.polygon)

    @cached_property
    def shape(self) -> Polygon:
        """The footprint as a shapely polygon (exact distances)."""
        return Polygon(self.polygon)

    @property
    def is_box(self) -> bool:
        """True for rectangles, in any direction."""
        if len(self.polygon) != 4:
            return False
        edges = np.roll(self.points, -1, axis=0) - self.points
        lengths = np.linalg.norm(edges, axis=1)
        cosines = np.sum(edges * np.roll(edges, -1, axis=0), axis=1) / (lengths * np.roll(lengths, -1))
        return bool(np.all(np.abs(cosines) < _SQUARE))

    def triangles(self) -> list[np.ndarray]:
        """Convex parts (constrained Delaunay triangles), each (3, 2) float64 [m], counter-clockwise."""
        parts = shapely.get_parts(shapely.constrained_delaunay_triangles(self.shape))
        return [np.array(part.exterior.coords)[:3] for part in shapely.orient_polygons(parts)]


@dataclass(frozen=True)
class Round:
    """Upright cylinder at (x, z) [m] with radius and height [m]. Raises SolidError if not finite and > 0."""

    x: float
    z: float
    radius: float
    height: float = DEFAULT_HEIGHT

    def __post_init__(self) -> None:
        for name in ("x", "z", "radius", "height"):
            object.__setattr__(self, name, float(getattr(self, name)))
        if not (abs(self.x) <= MAX_COORDINATE and abs(self.z) <= MAX_COORDINATE):
            raise SolidError(f"round solid at ({self.x}, {self.z}): not a place in the hall – give metres")
        _check_positive(f"round solid at ({self.x:g}, {self.z:g})", radius=self.radius, height=self.height)


Solid = Prism | Round


@dataclass(frozen=True)
class Floor:
    """The walkable outline and everything that stands on it.

    outline: (N, 2) [m] corners (x, z); the visitor stays inside. solids: Prism and Round values.
    """

    outline: Points
    solids: tuple[Solid, ...] = ()
    # The collision world of each thread (FCL gives no thread guarantee, fcl#224); no part of the value.
    _worlds: threading.local = field(default_factory=threading.local, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "outline", _checked_polygon(self.outline, "floor outline"))
        object.__setattr__(self, "solids", tuple(self.solids))
        for solid in self.solids:
            if not isinstance(solid, Prism | Round):
                raise SolidError(f"floor: {type(solid).__name__} is no solid – give Prism or Round values")

    def __reduce__(self) -> tuple[Any, ...]:
        return Floor, (self.outline, self.solids)  # a world cannot be pickled; each process builds its own

    @cached_property
    def shape(self) -> Polygon:
        """The outline as a shapely polygon."""
        return Polygon(self.outline)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """(x0, z0, x1, z1) [m] of the outline."""
        x0, z0, x1, z1 = self.shape.bounds
        return x0, z0, x1, z1


def wall(
    start: Sequence[float], end: Sequence[float], thickness: float, height: float = DEFAULT_HEIGHT
) -> Prism:
    """Wall along the segment start–end ((x, z) [m]) with square ends, half the thickness on either side."""
    a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    length = float(np.linalg.norm(b - a))
    if not length > 0:
        raise SolidError(f"wall from {tuple(start)} to {tuple(end)}: no length – move one end")
    _check_positive(f"wall from {tuple(start)} to {tuple(end)}", thickness=thickness)
    side = np.array([a[1] - b[1], b[0] - a[0]]) * (thickness / 2 / length)
    return Prism(as_points([a - side, b - side, b + side, a + side]), height)


def as_points(values: Iterable[Iterable[float]] | np.ndarray) -> Points:
    """(N, 2) numbers as a tuple of (x, z) pairs. Raises SolidError if they are not pairs of numbers."""
    try:
        array = np.asarray([list(pair) for pair in values], dtype=float)
    except (TypeError, ValueError) as error:
        raise SolidError(f"polygon: not a list of [x, z] pairs ({error}) – write [[x, z], …]") from error
    if array.ndim != 2 or array.shape[1] != 2:
        raise SolidError(f"polygon: shape {array.shape} – write [[x, z], …]")
    return tuple((float(x), float(z)) for x, z in array)


def _checked_polygon(values: Any, name: str) -> Points:
    points = as_points(values)
    if len(points) > 1 and points[0] == points[-1]:
        points = points[:-1]
    if len(points) < 3:
        raise SolidError(f"{name}: {len(points)} corners – a polygon needs at least 3")
    if not np.all(np.abs(points) <= MAX_COORDINATE):  # also catches nan
        raise SolidError(f"{name}: a corner is not a place in the hall – give finite metres")
    shape = Polygon(points)
    if not shape.is_valid:
        raise SolidError(f"{name}: {explain_validity(shape)} – reorder or move the corners")
    if shape.area < 1e-6:
        raise SolidError(f"{name}: no area – move the corners apart")
    ring = [(float(x), float(z)) for x, z in shapely.orient_polygons(shape).exterior.coords[:-1]]
    first = ring.index(min(ring))  # the same polygon is the same value, wherever its list begins
    return tuple(ring[first:] + ring[:first])


def _check_positive(name: str, **lengths: float) -> None:
    for key, value in lengths.items():
        if not (np.isfinite(value) and value > 0):
            raise SolidError(f"{name}: {key} is {value} – give metres above 0")
