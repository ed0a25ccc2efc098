"""Closed lines round something: how long, as a tape measure says, and convex ones by their support function."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull, QhullError

__all__ = ["hull_girth", "line_girth", "tangent_line"]


def line_girth(line: np.ndarray) -> float:
    """Length [m] of a closed line of corners (n, 2) or (n, 3) [m], the last one joined to the first."""
    return float(np.linalg.norm(line - np.roll(line, 1, axis=0), axis=1).sum())


def hull_girth(points: np.ndarray) -> float:
    """Length [m] of the convex hull of points (N, 2): what a tape measure round them says; 0 of fewer than three."""
    try:
        return line_girth(points[ConvexHull(points).vertices])
    except (QhullError, ValueError):
        return 0.0


def tangent_line(reach: np.ndarray, outward: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Points (n, 2) [m] of the convex line about a centre (2,) that reaches so far (n,) [m] in each direction.

    outward: (n, 2) unit vectors (sin, cos), evenly all round. The line is where its tangents meet, p = h n + h' t, of
    the support function h (Schneider, Convex Bodies, §1.7).
    """
    step = 2 * np.pi / len(reach)
    slope = (np.roll(reach, -1) - np.roll(reach, 1)) / (2 * step)
    onward = np.stack([outward[:, 1], -outward[:, 0]], axis=1)
    return centre + reach[:, None] * outward + slope[:, None] * onward
