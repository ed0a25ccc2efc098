"""What of a plan one cannot see through: it hides what stands behind it, so that a page need not draw that."""

from __future__ import annotations

import numpy as np

from hall_app.content.schema.plan import Opening, PlanFile, Wall

__all__ = ["opaque_walls"]

Stretch = tuple[float, float, float, float, float | None]

_HAIR = 1e-6  # [m]
_BESIDE = 0.05  # [m] an opening this far off a wall's faces is still one of its own


def opaque_walls(plan: PlanFile) -> list[Stretch]:
    """[x, z, x, z, top] [m] of every stretch of a plastered wall between its openings, along its middle line.

    top: None where the wall reaches the ceilings on both its sides. Doors and windows count as open from the floor to
    the ceiling, and lattices are seen through.
    """
    found: list[Stretch] = []
    for wall in plan.wall:
        if wall.kind != "wall":
            continue
        start, end = np.asarray(wall.start, float), np.asarray(wall.end, float)
        top = None if wall.height > _highest_beside(plan, wall) - _HAIR else wall.height
        for low, high in _between(_gaps(plan.opening, wall)):
            (ax, az), (bx, bz) = start + low * (end - start), start + high * (end - start)
            found.append((float(ax), float(az), float(bx), float(bz), top))
    return found


def _gaps(openings: tuple[Opening, ...], wall: Wall) -> list[tuple[float, float]]:
    """(from, to) of the wall's length, 0 to 1, of every opening in it."""
    start, end = np.asarray(wall.start, float), np.asarray(wall.end, float)
    length = float(np.linalg.norm(end - start))
    along = (end - start) / length
    across = np.array([-along[1], along[0]])
    found = []
    for opening in openings:
        ends = np.array([opening.start, opening.end], float) - start
        if np.abs(ends @ across).max() <= wall.thickness / 2 + _BESIDE:
            low, high = sorted((ends @ along / length).tolist())
            found.append((low, high))
    return sorted(found)


def _between(gaps: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """What sorted gaps leave of 0 to 1."""
    left, at = [], 0.0
    for low, high in [*gaps, (1.0, 1.0)]:
        if low > at + _HAIR:
            left.append((at, min(low, 1.0)))
        at = max(at, high)
    return left


def _highest_beside(plan: PlanFile, wall: Wall) -> float:
    """[m] the highest ceiling that a wall touches; floor outside all bays has the side rooms'."""
    import shapely

    line = shapely.LineString([wall.start, wall.end]).buffer(wall.thickness / 2 + _BESIDE, cap_style="flat")
    touched = [bay for bay in plan.bay if shapely.Polygon(bay.polygon).intersects(line)]
    return max([plan.height, *(plan.height_over(bay) for bay in touched)])
