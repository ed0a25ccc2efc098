"""Holes that touch the outline, or each other, become part of it."""

import warnings
from typing import NamedTuple

import numpy as np

from sim_core.errors import OutlineError, OutlineWarning
from sim_core.mesh.outline.crossings import close_contours

__all__ = ["Merged", "merged"]

WIDER = 0.02  # of the edge: a touching hole is cut this much wider, so that the mouth has a width
NEAR = 1e-9  # of the extent: contours this near to each other touch


class Merged(NamedTuple):
    """named: ("outline", (n, 2) [m]) first, then holes.  given: None where nothing was merged, else the rim of the
    cloth as it was given, without the widening: contours (n, 2) [m] each."""

    named: list[tuple[str, np.ndarray]]
    given: list[np.ndarray] | None = None


def merged(named: list[tuple[str, np.ndarray]], edge: float) -> Merged:
    """Cut holes that touch the outline out of it, and join holes that touch each other.

    named: ("outline", (n, 2) [m]) first, then holes.  edge: [m].  A hole that touches is cut 0.02 edge wider: a mouth
    of no width would make two sheets of cloth share a vertex. Holes that truly cross the outline are left for the
    check of crossings to name. Raises OutlineError where a hole cuts the panel in two.
    """
    from shapely import Polygon, covers, prepare, unary_union

    shapes = [Polygon(contour) for _, contour in named]
    near = NEAR * float(np.ptp(named[0][1], axis=0).max())
    if any(not shape.is_valid for shape in shapes):
        return Merged(named)  # the check of crossings says where
    cloth, holes = shapes[0], shapes[1:]
    grown = cloth.buffer(near)
    prepare(grown)
    if not np.all(covers(grown, holes)):
        return Merged(named)
    touching = _touching(cloth, holes, near)
    if not touching:
        return Merged(named)
    names = ", ".join(named[k + 1][0] for k in touching)
    wider = [
        hole.buffer(WIDER * edge, join_style="mitre") if k in touching else hole
        for k, hole in enumerate(holes)
    ]
    left = cloth.difference(unary_union(wider))
    if left.is_empty:
        raise OutlineError(f"{names}: leaves no cloth – holes belong inside the outline")
    if not isinstance(left, Polygon):
        raise OutlineError(f"{names}: cuts the panel into parts – give each part an outline of its own")
    warnings.warn(
        f"{names}: touches the outline or another hole and is merged with it, {WIDER:g} of the edge wider",
        OutlineWarning,
        stacklevel=2,
    )
    found = _rings(left)
    told = [("outline", found[0]), *((f"hole {k}", ring) for k, ring in enumerate(found[1:]))]
    as_given = cloth.difference(unary_union([hole.buffer(2 * near, join_style="mitre") for hole in holes]))
    # a hole that touches along a line leaves no more there than a hair, which is no cloth
    parts = [part for part in getattr(as_given, "geoms", [as_given]) if part.area > near * part.length]
    return Merged(told, [ring for part in parts for ring in _rings(part)])


def _touching(cloth, holes: list, near: float) -> list[int]:
    """Holes that touch the outline, or another hole without one lying in the other."""
    from shapely import STRtree

    # Boxes of holes may overlap, each with each, where none is close: they are asked only of those that are.
    close = close_contours([np.array(shape.exterior.coords)[:-1] for shape in (cloth, *holes)], near)
    close = close[close > 0] - 1
    if not close.size:
        return []
    asked = np.array(holes)[close]
    found = set(close[STRtree([cloth.exterior]).query(asked, predicate="dwithin", distance=near)[0]].tolist())
    one, other = STRtree(holes).query(asked, predicate="dwithin", distance=near)
    for k, m in zip(close[one].tolist(), other.tolist(), strict=True):
        if k != m and not holes[k].contains(holes[m]) and not holes[m].contains(holes[k]):
            found |= {k, m}
    return sorted(found)


def _rings(polygon) -> list[np.ndarray]:
    return [np.array(ring.coords)[:-1] for ring in (polygon.exterior, *polygon.interiors)]
