"""Quality of triangles: angles, shape and edge ratio."""

from typing import NamedTuple

import numpy as np

__all__ = ["Quality", "quality", "triangle_areas"]


class Quality(NamedTuple):
    """Per triangle: smallest angle [degrees], q = 4 sqrt(3) area / sum of squared edges, shortest / longest edge."""

    min_angle: np.ndarray
    shape: np.ndarray
    edge_ratio: np.ndarray


def triangle_areas(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Signed areas [m2] in (x, -y) of faces (F, 3) over vertices (V, 2) [m], y down."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    u, v = b - a, c - a
    return 0.5 * (u[:, 1] * v[:, 0] - u[:, 0] * v[:, 1])


def quality(vertices: np.ndarray, faces: np.ndarray) -> Quality:
    """Measure triangles: vertices (V, 2) [m], faces (F, 3) int. Zero-area triangles have angle and q of 0."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    squares = np.sort(
        np.column_stack([((p - q) ** 2).sum(axis=1) for p, q in ((b, c), (c, a), (a, b))]), axis=1
    )
    double = 2 * np.abs(triangle_areas(vertices, faces))
    cosine = squares[:, 1] + squares[:, 2] - squares[:, 0]
    angle = np.degrees(np.arctan2(2 * double, cosine))
    return Quality(
        angle, 2 * np.sqrt(3) * double / squares.sum(axis=1), np.sqrt(squares[:, 0] / squares[:, 2])
    )
