"""The pieces a room is built of: developable patches, each with its own flat picture in metres."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from shapely import Polygon

__all__ = ["Frame", "Patch", "box", "panel", "prism", "quad", "strip", "tube"]

Floats = NDArray[np.float64]
UP = np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True, slots=True)
class Patch:
    """Triangles of one material that unroll into a plane.

    vertices: (V, 3) [m]; faces: (F, 3) counter-clockwise from outside; flat: (V, 2) [m] the same vertices unrolled,
    lengths kept; grain: axis of `flat` the grain runs along; chart: patches with one key share a chart and a plane,
    None: a chart of its own; uv: (V, 2) texture coordinates where the material's repeat does not give them;
    density: texels per metre instead of the material's; two_sided: seen (and lit) from both sides.
    """

    material: str
    vertices: Floats
    faces: NDArray[np.int32]
    flat: Floats
    grain: int = 0
    chart: Hashable = None
    uv: Floats | None = None
    density: float | None = None
    two_sided: bool = False


@dataclass(frozen=True, slots=True)
class Frame:
    """A place in the hall: local x to the right of whoever faces its front, y up, z out of its front.

    at: (3,) [m] its origin; facing: degrees about +y, 0 = +z.
    """

    at: Floats
    facing: float = 0.0

    @classmethod
    def on_floor(cls, at: ArrayLike, facing: float = 0.0, height: float = 0.0) -> Frame:
        """At [x, z] of the plan, `height` [m] above the floor."""
        x, z = np.asarray(at, float)
        return cls(np.array([x, height, z]), facing)

    @property
    def axes(self) -> Floats:
        """(3, 3): right, up, front as rows."""
        turn = np.radians(self.facing)
        sine, cosine = np.sin(turn), np.cos(turn)
        return np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]])

    def __call__(self, points: ArrayLike) -> Floats:
        """(N, 3) local points [m] in the world."""
        return np.asarray(points, float) @ self.axes + self.at

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0, turn: float = 0.0) -> Frame:
        """The frame shifted by local metres and turned by `turn` degrees."""
        return Frame(self([[x, y, z]])[0], self.facing + turn)


def quad(corners: ArrayLike, material: str, **options) -> Patch:
    """Four corners (4, 3) of a flat rectangle, counter-clockwise from outside, grain along its longer side."""
    points = np.asarray(corners, float)
    along, across = points[1] - points[0], points[3] - points[0]
    wide, high = np.linalg.norm(along), np.linalg.norm(across)
    flat = np.array([[0, 0], [wide, 0], [wide, high], [0, high]])
    options.setdefault("grain", int(high > wide))
    return Patch(material, points, np.array([[0, 1, 2], [0, 2, 3]], np.int32), flat, **options)


_BOX_SIDES = {  # local corners (x, y, z as 0 low, 1 high), counter-clockwise from outside
    "front": [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    "back": [(1, 0, 0), (0, 0, 0), (0, 1, 0), (1, 1, 0)],
    "left": [(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)],
    "right": [(1, 0, 1), (1, 0, 0), (1, 1, 0), (1, 1, 1)],
    "top": [(0, 1, 1), (1, 1, 1), (1, 1, 0), (0, 1, 0)],
    "bottom": [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)],
}
_THIN = 0.06  # [m] a side narrower than this gets half the texels


def box(
    frame: Frame, low: Sequence[float], high: Sequence[float], material: str, *, skip: str = ""
) -> list[Patch]:
    """A box between local corners `low` and `high` [m] without the sides named in `skip`; grain along its length."""
    corners = np.array([low, high], float)
    size = corners[1] - corners[0]
    longest = int(np.argmax(size))
    patches = []
    for name, signs in _BOX_SIDES.items():
        if name in skip:
            continue
        local = np.array([[corners[bit, axis] for axis, bit in enumerate(sign)] for sign in signs])
        side = quad(frame(local), material)
        if abs(local[1] - local[0])[longest] > 0 or abs(local[3] - local[0])[longest] > 0:
            side = replace(side, grain=int(abs(local[3] - local[0])[longest] > 0))
        if min(side.flat[2]) < _THIN:
            side = replace(side, density=5.0)
        patches.append(side)
    return patches


def panel(
    origin: ArrayLike, right: ArrayLike, up: ArrayLike, shape: Polygon, material: str, **options
) -> list[Patch]:
    """A flat polygon, holes and all, in the plane of the unit vectors `right` and `up`; seen against right × up.

    shape: shapely polygon(s) in metres along `right` and `up`; all of them lie in one chart.
    """
    import shapely

    pieces = [
        piece for piece in shapely.get_parts(shape) if piece.geom_type == "Polygon" and piece.area > 1e-6
    ]
    if not pieces:
        return []
    triangles = np.concatenate([_triangulated(piece) for piece in pieces])
    flat, faces = np.unique(np.round(triangles.reshape(-1, 2), 9), axis=0, return_inverse=True)
    right, up = np.asarray(right, float), np.asarray(up, float)
    vertices = np.asarray(origin, float) + flat[:, :1] * right + flat[:, 1:] * up
    return [Patch(material, vertices, faces.reshape(-1, 3).astype(np.int32), flat, **options)]


def _triangulated(piece: Polygon) -> Floats:
    """(F, 3, 2) triangles of a polygon, counter-clockwise."""
    import shapely

    found = np.array(
        [shapely.get_coordinates(t)[:3] for t in shapely.constrained_delaunay_triangles(piece).geoms]
    )
    a, b = found[:, 1] - found[:, 0], found[:, 2] - found[:, 0]
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    found = found[np.abs(area) > 1e-7]
    area = area[np.abs(area) > 1e-7]
    return np.where((area < 0)[:, None, None], found[:, ::-1], found)


def strip(low: ArrayLike, high: ArrayLike, material: str, **options) -> Patch:
    """The band between two lines of points (N, 3) each, unrolled triangle by triangle, so that lengths are kept.

    Outside is where `low` runs to the right with `high` above it. Triangles without area are left out.
    """
    low, high = np.asarray(low, float), np.asarray(high, float)
    flat_low, flat_high = [np.zeros(2)], [np.array([0.0, float(np.linalg.norm(high[0] - low[0]))])]
    faces = []
    count = len(low)
    for k in range(count - 1):
        corner = _beyond(low[k], high[k], low[k + 1], flat_low[k], flat_high[k])
        flat_low.append(corner)
        flat_high.append(_beyond(low[k + 1], high[k], high[k + 1], corner, flat_high[k]))
        faces += [[k, k + 1, count + k], [k + 1, count + k + 1, count + k]]
    vertices, flat = np.concatenate([low, high]), np.array(flat_low + flat_high)
    kept = np.array(faces, np.int32)
    sides = vertices[kept]
    area = np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]), axis=1)
    return Patch(material, vertices, kept[area > 1e-7], flat, **options)


def _beyond(a: Floats, b: Floats, c: Floats, flat_a: Floats, flat_b: Floats) -> Floats:
    """Where the third corner `c` of a triangle comes to lie, to the right of the flat edge a → b."""
    edge = flat_b - flat_a
    long = float(np.linalg.norm(b - a))
    if long < 1e-9:
        return flat_a + np.array([float(np.linalg.norm(c - a)), 0.0])
    along = float((c - a) @ (b - a)) / long
    off = np.sqrt(max(float((c - a) @ (c - a)) - along**2, 0.0))
    unit = edge / max(float(np.linalg.norm(edge)), 1e-12)
    return flat_a + along * unit + off * np.array([unit[1], -unit[0]])


def tube(
    frame: Frame, profile: Sequence[tuple[float, float]], material: str, *, sides: int = 24, **options
) -> list[Patch]:
    """A turned body: `profile` lists (radius, height) [m] upwards in the frame; one chart a section."""
    angle = 2 * np.pi * np.arange(sides + 1) / sides
    ring = np.column_stack([np.sin(angle), np.zeros(sides + 1), np.cos(angle)])
    options.setdefault("grain", 1)
    patches = []
    for (r0, y0), (r1, y1) in zip(profile, profile[1:], strict=False):
        low, high = (frame(ring * [r, 1, r] + [0, y, 0]) for r, y in ((r0, y0), (r1, y1)))
        patches.append(strip(low, high, material, **options))
    return patches


def disc(frame: Frame, radius: float, material: str, *, sides: int = 24, up: bool = True) -> list[Patch]:
    """A round lid in the frame's floor plane, seen from above or below."""
    import shapely

    angle = 2 * np.pi * np.arange(sides) / sides
    shape = shapely.Polygon(radius * np.column_stack([np.cos(angle), np.sin(angle)]))
    right, _, front = frame.axes
    return panel(frame.at, right, -front if up else front, shape, material)


def prism(frame: Frame, outline: ArrayLike, depth: float, material: str) -> list[Patch]:
    """A profile (N, 2) of local x, y drawn counter-clockwise, raised from -depth/2 to depth/2 along local z."""
    import shapely

    ring = np.asarray(outline, float)
    ahead = np.roll(ring, -1, axis=0)
    half = depth / 2
    patches = []
    for (x0, y0), (x1, y1) in zip(ring, ahead, strict=True):
        side = [(x0, y0, half), (x0, y0, -half), (x1, y1, -half), (x1, y1, half)]
        patches.append(quad(frame(side), material))
    right, _, front = frame.axes
    for sign in (1, -1):
        shape = shapely.Polygon(ring * [sign, 1])
        patches += panel(frame.at + sign * half * front, right * sign, UP, shape, material)
    return patches
