"""Curves as polylines: Bézier pieces and elliptic arcs."""

from math import atan2, ceil, cos, hypot, pi, radians, sin

import numpy as np

__all__ = ["arc_points", "bezier_points"]

PIECES = 48  # of a Bézier curve
TURN = radians(3)  # most of an arc in one step


def bezier_points(control: list[np.ndarray]) -> list[np.ndarray]:
    """Points of a Bézier curve after its first; control: three or four points (2,)."""
    t = np.linspace(0, 1, PIECES + 1)[1:, None]
    layer = [np.repeat(point[None], PIECES, axis=0) for point in control]
    while len(layer) > 1:
        layer = [(1 - t) * a + t * b for a, b in zip(layer[:-1], layer[1:], strict=True)]
    layer[0][-1] = control[-1]
    return list(layer[0])


def arc_points(start, radii, degrees: float, large: bool, sweep: bool, end) -> list[np.ndarray]:
    """Points after `start` of an SVG elliptic arc (endpoint form, SVG 1.1 appendix F.6)."""
    rx, ry = abs(radii[0]), abs(radii[1])
    if rx == 0 or ry == 0 or np.array_equal(start, end):
        return [np.array(end, dtype=float)]
    c, s = cos(radians(degrees)), sin(radians(degrees))
    turn = np.array([[c, s], [-s, c]])
    x, y = turn @ (np.asarray(start) - end) / 2
    grow = max(1.0, hypot(x / rx, y / ry))
    rx, ry = rx * grow, ry * grow
    square = max(0.0, (rx * ry) ** 2 / ((rx * y) ** 2 + (ry * x) ** 2) - 1)
    factor = (square**0.5) * (1 if large != sweep else -1)
    cx, cy = factor * rx * y / ry, -factor * ry * x / rx
    middle = turn.T @ (cx, cy) + (np.asarray(start) + end) / 2
    first, last = atan2((y - cy) / ry, (x - cx) / rx), atan2((-y - cy) / ry, (-x - cx) / rx)
    span = (last - first) % (2 * pi)
    if not sweep:
        span -= 2 * pi
    angles = first + span * np.linspace(0, 1, max(2, ceil(abs(span) / TURN) + 1))[1:]
    points = np.column_stack([rx * np.cos(angles), ry * np.sin(angles)]) @ turn + middle
    points[-1] = end
    return list(points)
