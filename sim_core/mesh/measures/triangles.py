"""Quality of triangles: angles, shape and edge ratio."""

from typing import NamedTuple

import numpy as np
from numba import njit

__all__ = ["Quality", "quality", "stars", "triangle_areas"]


class Quality(NamedTuple):
    """Per triangle: smallest angle [degrees], q = 4 sqrt(3) area / sum of squared edges, shortest / longest edge."""

    min_angle: np.ndarray
    shape: np.ndarray
    edge_ratio: np.ndarray


def triangle_areas(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Signed areas [m2] in (x, -y) of faces (F, 3) over vertices (V, 2) [m], y down."""
    return _areas(np.asarray(vertices), np.asarray(faces))


def quality(vertices: np.ndarray, faces: np.ndarray) -> Quality:
    """Measure triangles: vertices (V, 2) [m], faces (F, 3) int. Zero-area triangles have angle and q of 0."""
    return Quality(*_measured(np.asarray(vertices), np.asarray(faces)))


@njit(cache=True, error_model="numpy")
def _areas(vertices, faces):
    areas = np.zeros(faces.shape[0])
    for f in range(faces.shape[0]):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        ux, uy = vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1]
        vx, vy = vertices[c, 0] - vertices[a, 0], vertices[c, 1] - vertices[a, 1]
        areas[f] = 0.5 * (uy * vx - ux * vy)
    return areas


@njit(cache=True, error_model="numpy")
def _measured(vertices, faces):
    areas = _areas(vertices, faces)
    angle, shape, ratio = np.zeros(len(areas)), np.zeros(len(areas)), np.zeros(len(areas))
    for f in range(len(areas)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        p = (vertices[b, 0] - vertices[c, 0]) ** 2 + (vertices[b, 1] - vertices[c, 1]) ** 2
        q = (vertices[c, 0] - vertices[a, 0]) ** 2 + (vertices[c, 1] - vertices[a, 1]) ** 2
        r = (vertices[a, 0] - vertices[b, 0]) ** 2 + (vertices[a, 1] - vertices[b, 1]) ** 2
        least, most, total = min(p, min(q, r)), max(p, max(q, r)), p + q + r
        if total == 0.0:
            continue
        double = 2 * abs(areas[f])
        # The smallest angle lies opposite the shortest side: tan = 2 * 2 area / (b b + c c - a a)
        angle[f] = np.degrees(np.arctan2(2 * double, total - 2 * least))
        shape[f] = 2 * np.sqrt(3.0) * double / total
        ratio[f] = np.sqrt(least / most)
    return angle, shape, ratio


@njit(cache=True, error_model="numpy")
def stars(faces, count):
    """Corners around each vertex: start (count + 1,) and items, 3 face + corner, both int32."""
    start = np.zeros(count + 1, np.int32)
    for f in range(faces.shape[0]):
        for k in range(3):
            start[faces[f, k] + 1] += 1
    for v in range(count):
        start[v + 1] += start[v]
    items, filled = np.zeros(3 * faces.shape[0], np.int32), start.copy()
    for f in range(faces.shape[0]):
        for k in range(3):
            v = faces[f, k]
            items[filled[v]] = 3 * f + k
            filled[v] += 1
    return start, items
