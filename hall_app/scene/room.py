"""The room, raised from the plan: floor, walls and furniture as coloured, evenly lit triangles.

The plan is the one truth for picture, minimap and collision. Light is painted into the vertex colours, since
the room is drawn unlit: a lit room costs software renderers more than twice the time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Part", "box", "cap", "disc", "drum", "floor_tiles", "linear", "merged", "prism"]

Floats = NDArray[np.float64]

# Even light from above and a little from the front left, as factors on a surface's colour.
_TOP, _SIDE, _SWING = 1.0, 0.84, 0.10
_FROM = np.array([-0.5, 0.86])


@dataclass(frozen=True, slots=True)
class Part:
    """Triangles with a colour per vertex: vertices (V, 3) [m], faces (F, 3), colours (V, 3) linear 0..1."""

    vertices: Floats
    faces: NDArray[np.int32]
    colours: Floats


def merged(parts: list[Part]) -> Part:
    """One part of many; an empty list gives an empty part."""
    if not parts:
        return Part(np.zeros((0, 3)), np.zeros((0, 3), np.int32), np.zeros((0, 3)))
    starts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    return Part(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.faces + start for part, start in zip(parts, starts, strict=True)]).astype(
            np.int32
        ),
        np.concatenate([part.colours for part in parts]),
    )


def linear(colour: str) -> Floats:
    """'#rrggbb' (sRGB) as linear light, which is what glTF's vertex colours hold."""
    value = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def _signed_area(polygon: Floats) -> float:
    x, z = polygon.T
    return float(0.5 * np.sum(x * np.roll(z, -1) - z * np.roll(x, -1)))


def _sides(polygon: Floats, low: float, high: float, colour: Floats, dim: tuple[float, float]) -> Part:
    """Quads round a polygon [x, z]; `dim` = light factor at the low and at the high edge."""
    ring = polygon if _signed_area(polygon) > 0 else polygon[::-1]
    ahead = np.roll(ring, -1, axis=0)
    count = len(ring)
    corners = np.stack(
        [
            np.column_stack([ring[:, 0], np.full(count, low), ring[:, 1]]),
            np.column_stack([ring[:, 0], np.full(count, high), ring[:, 1]]),
            np.column_stack([ahead[:, 0], np.full(count, high), ahead[:, 1]]),
            np.column_stack([ahead[:, 0], np.full(count, low), ahead[:, 1]]),
        ],
        axis=1,
    )
    along = ahead - ring
    # Counter-clockwise in (x, z) with z towards the viewer: the outside lies at (dz, -dx).
    outside = np.column_stack([along[:, 1], -along[:, 0]])
    outside /= np.maximum(np.linalg.norm(outside, axis=1, keepdims=True), 1e-12)
    light = _SIDE + _SWING * (outside @ _FROM)
    shade = light[:, None] * np.array([dim[0], dim[1], dim[1], dim[0]])
    base = 4 * np.arange(count)[:, None]
    faces = np.concatenate([base + [0, 1, 2], base + [0, 2, 3]])
    return Part(corners.reshape(-1, 3), faces.astype(np.int32), shade.reshape(-1, 1) * colour)


def cap(polygon: Floats, height: float, colour: Floats, *, up: bool = True) -> Part:
    """A flat lid on any simple polygon."""
    import shapely

    pieces = shapely.constrained_delaunay_triangles(shapely.Polygon(polygon)).geoms
    corners = np.array([shapely.get_coordinates(piece)[:3] for piece in pieces])
    turn = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    # Seen from above (+y), a triangle that is counter-clockwise in (x, z) is clockwise.
    corners = np.where(((turn > 0) == up)[:, None, None], corners[:, ::-1], corners)
    flat = corners.reshape(-1, 2)
    vertices = np.column_stack([flat[:, 0], np.full(len(flat), height), flat[:, 1]])
    faces = np.arange(len(flat), dtype=np.int32).reshape(-1, 3)
    return Part(vertices, faces, np.broadcast_to(colour * (_TOP if up else 0.62), (len(flat), 3)).copy())


def prism(
    polygon: Floats,
    low: float,
    high: float,
    colour: str,
    *,
    lid: bool = True,
    dim: tuple[float, float] = (0.9, 1.0),
) -> Part:
    """A polygon [x, z] raised from `low` to `high` [m]."""
    paint = linear(colour)
    parts = [_sides(np.asarray(polygon, float), low, high, paint, dim)]
    if lid:
        parts.append(cap(np.asarray(polygon, float), high, paint))
    return merged(parts)


def box(
    at: tuple[float, float], size: tuple[float, float], facing: float, low: float, high: float, colour: str
) -> Part:
    """A box centred at [x, z], `size` = (width, depth) [m], turned by `facing` [deg] about +y."""
    width, depth = np.asarray(size) / 2
    corners = np.array([[-width, -depth], [width, -depth], [width, depth], [-width, depth]])
    turn = np.radians(facing)
    across = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return prism(corners @ across + np.asarray(at), low, high, colour)


def drum(
    at: tuple[float, float],
    radius: float,
    low: float,
    high: float,
    colour: str,
    *,
    top: float | None = None,
    sides: int = 24,
) -> Part:
    """A round solid; `top` [m] is the upper radius when it tapers."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    part = prism(ring * radius + np.asarray(at), low, high, colour)
    if top is None:
        return part
    vertices = part.vertices.copy()
    upper = vertices[:, 1] == high
    centre = np.asarray(at)
    vertices[np.ix_(upper, [0, 2])] = centre + (vertices[np.ix_(upper, [0, 2])] - centre) * (top / radius)
    return Part(vertices, part.faces, part.colours)


def disc(at: tuple[float, float], radius: float, height: float, colour: str, *, sides: int = 32) -> Part:
    """A round plate at `height` [m], seen from above."""
    angle = 2 * np.pi * np.arange(sides) / sides
    return cap(
        np.column_stack([np.cos(angle), np.sin(angle)]) * radius + np.asarray(at), height, linear(colour)
    )


def floor_tiles(outline: Floats, edge: float, colour: str, *, seed: int = 7) -> Part:
    """Square tiles of `edge` [m] cut to the outline, each a little lighter or darker than the next."""
    import shapely

    shape = shapely.Polygon(outline)
    rng = np.random.default_rng(seed)
    low_x, low_z, high_x, high_z = shape.bounds
    paint = linear(colour)
    parts = []
    for ix, x in enumerate(np.arange(low_x, high_x - 1e-9, edge)):
        for iz, z in enumerate(np.arange(low_z, high_z - 1e-9, edge)):
            tile = shapely.box(x, z, x + edge, z + edge)
            tone = 1.0 + 0.05 * ((ix + iz) % 2) + 0.05 * rng.standard_normal()
            piece = tile if shape.contains(tile) else tile.intersection(shape)
            for polygon in shapely.get_parts(piece):
                if polygon.geom_type == "Polygon" and polygon.area > 1e-6:
                    ring = np.asarray(polygon.exterior.coords)[:-1]
                    parts.append(cap(ring, 0.0, paint * tone))
    return merged(parts)
