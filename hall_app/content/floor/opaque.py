"""What of a plan one cannot see through: it hides what stands behind it, so that a page need not draw that."""

from __future__ import annotations

import numpy as np

from hall_app.content.schema.plan import Opening, PlanFile, Wall

__all__ = ["opaque_walls"]

Stretch = tuple[float, float, float, float, float | None]

_HAIR = 1e-6  # of a wall's length


def opaque_walls(plan: PlanFile) -> list[Stretch]:
    """[x, z, x, z, top] [m] of every stretch of a plastered wall between its openings, along its middle line.

    top: None where the wall is drawn up to the ceilings. Doors and windows count as open from the floor to
    the ceiling, and lattices are seen through.
    """
    found: list[Stretch] = []
    for wall in plan.wall:
        if wall.kind != "wall":
            continue
        start, end = np.asarray(wall.start, float), np.asarray(wall.end, float)
        top = None if plan.to_ceiling(wall) else wall.height
        for low, high in _between(_gaps(plan.openings_in(wall), wall)):
            (ax, az), (bx, bz) = start + low * (end - start), start + high * (end - start)
            found.append((float(ax), float(az), float(bx), float(bz), top))
    return found


def _gaps(openings: list[Opening], wall: Wall) -> list[tuple[float, float]]:
    """(from, to) of the wall's length, 0 to 1, of every opening in it."""
    start = np.asarray(wall.start, float)
    along = np.asarray(wall.end, float) - start
    ends = np.array([[opening.start, opening.end] for opening in openings], float).reshape(-1, 2, 2)
    return sorted((low, high) for low, high in np.sort((ends - start) @ along / (along @ along)).tolist())


def _between(gaps: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """What sorted gaps leave of 0 to 1."""
    left, at = [], 0.0
    for low, high in [*gaps, (1.0, 1.0)]:
        if low > at + _HAIR:
            left.append((at, min(low, 1.0)))
        at = max(at, high)
    return left
