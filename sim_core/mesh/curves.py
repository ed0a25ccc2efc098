"""Curves of drawing files as polylines: Bézier pieces, elliptic arcs, bulges."""

from math import atan2, ceil, cos, hypot, pi, radians, sin

import numpy as np

__all__ = ["arc_points", "bezier_points", "bulge_points"]

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


def bulge_points(a, b, bulge: float) -> list[np.ndarray]:
    """Points after `a` of a DXF polyline segment with a bulge, the tangent of a quarter of its angle."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    if bulge == 0 or np.array_equal(a, b):
        return [b]
    chord = b - a
    middle = (a + b) / 2 + np.array([-chord[1], chord[0]]) * (1 - bulge * bulge) / (4 * bulge)
    u, angle = a - middle, 4 * atan2(bulge, 1.0)
    steps = max(1, ceil(abs(angle) / TURN))
    found = []
    for k in range(1, steps + 1):
        c, s = cos(angle * k / steps), sin(angle * k / steps)
        found.append(middle + np.array([c * u[0] - s * u[1], s * u[0] + c * u[1]]))
    found[-1] = b
    return found
