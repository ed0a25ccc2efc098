"""What a draughtsman draws with: brush strokes, volutes, petals and lozenges, as areas in millimetres."""

from __future__ import annotations

from math import cos, pi, sin
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["band", "brush", "flower", "lozenge", "petal", "ring", "turned", "volute"]

ROUND = 6  # corners of a quarter circle
STEPS = 48  # of a stroke that bends


def brush(points: ArrayLike, widths: np.ndarray | float) -> Any:
    """A stroke along points (N, 2), as wide at each as `widths` (N,) says, round at both ends."""
    import shapely

    places = np.asarray(points, float)
    radii = 0.5 * np.broadcast_to(np.asarray(widths, float), len(places))
    angle = 2.0 * pi * np.arange(4 * ROUND) / (4 * ROUND)
    discs = places[:, None] + radii[:, None, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    pairs = np.concatenate([discs[:-1], discs[1:]], axis=1) if len(discs) > 1 else discs
    hulls = shapely.convex_hull(
        shapely.multipoints(pairs.reshape(-1, 2), indices=np.repeat(np.arange(len(pairs)), pairs.shape[1]))
    )
    return shapely.union_all(hulls)


def band(points: ArrayLike, width: float) -> Any:
    """A line of even width with sharp corners through points (N, 2), flat at both ends."""
    from shapely import LineString

    return LineString(np.asarray(points, float)).buffer(0.5 * width, cap_style="flat", join_style="mitre")


def volute(start: ArrayLike, heading: float, length: float, *, turns: float, bend: float = 0.0) -> np.ndarray:
    """Points (STEPS, 2) of a line that curls in: it sets out in a direction [rad], bends by `bend` [rad] over its
    length and by so many turns more, ever tighter (an Euler spiral; below 0: to the right)."""
    share = np.linspace(0.0, 1.0, STEPS)
    angle = heading + bend * share + 2.0 * pi * turns * share**2
    step = length / (STEPS - 1)
    ways = step * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.asarray(start, float) + np.concatenate([np.zeros((1, 2)), np.cumsum(ways[:-1], axis=0)])


def lozenge(middle: ArrayLike, width: float, height: float) -> Any:
    """A rhombus on its corner."""
    from shapely import Polygon

    x, y = np.asarray(middle, float)
    return Polygon([(x - width / 2, y), (x, y - height / 2), (x + width / 2, y), (x, y + height / 2)])


def ring(middle: ArrayLike, radius: float, width: float) -> Any:
    """A circle of a line so wide, its outer edge at the radius; a disc where it is as wide as that."""
    from shapely import Point

    outer = Point(*np.asarray(middle, float)).buffer(radius, quad_segs=4 * ROUND)
    inner = radius - width
    return (
        outer
        if inner <= 0
        else outer.difference(Point(*np.asarray(middle, float)).buffer(inner, quad_segs=4 * ROUND))
    )


def petal(foot: ArrayLike, heading: float, length: float, width: float, *, point: float = 0.6) -> Any:
    """A leaf or petal from its foot on: widest at half way or so, ending in a point (1) or round (0)."""
    from shapely import Polygon

    share = np.linspace(0.0, 1.0, 24)
    pointed, rounded = np.sin(pi * share**0.8), np.sqrt(np.clip(share * (1 - share**3), 0, None)) * 1.5
    half = 0.5 * width * (point * pointed + (1.0 - point) * rounded / rounded.max())
    along, across = np.array([cos(heading), sin(heading)]), np.array([-sin(heading), cos(heading)])
    middle = np.asarray(foot, float) + (length * share)[:, None] * along
    outline = np.concatenate([middle + half[:, None] * across, (middle - half[:, None] * across)[::-1]])
    return Polygon(outline).buffer(0)


def flower(middle: ArrayLike, radius: float, petals: int, *, depth: float = 0.28, turn: float = 0.0) -> Any:
    """A rosette: a disc whose rim has so many lobes, as deep as a share of the radius."""
    from shapely import Polygon

    angle = np.linspace(0.0, 2.0 * pi, 24 * petals, endpoint=False)
    rim = radius * (1.0 - depth * (1.0 - np.abs(np.cos(0.5 * petals * (angle - turn)))))
    return Polygon(np.asarray(middle, float) + rim[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))


def turned(area: Any, middle: ArrayLike, count: int) -> list[Any]:
    """An area so many times about a middle."""
    from shapely.affinity import rotate

    x, y = np.asarray(middle, float).tolist()
    return [rotate(area, 360.0 * k / count, origin=(x, y)) for k in range(count)]
