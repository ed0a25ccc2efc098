"""Light smoothing: inner points move to the area-weighted mean of the centroids around them, then growth runs again."""

import numpy as np

from sim_core.mesh.quality import triangle_areas

__all__ = ["smoothed"]


def smoothed(vertices: np.ndarray, faces: np.ndarray, fixed: int) -> np.ndarray:
    """New vertices (V, 2) [m]; the first `fixed` ones (the outline samples) stay where they are.

    Inside the regular lattice the mean is the point itself, so only the irregular band along the outline moves.
    """
    weight = triangle_areas(vertices, faces)
    middle = vertices[faces].mean(axis=1)
    corners = faces.ravel()
    total = np.bincount(corners, np.repeat(weight, 3), len(vertices))
    moved = vertices.copy()
    for axis in range(2):
        summed = np.bincount(corners, np.repeat(weight * middle[:, axis], 3), len(vertices))
        moved[fixed:, axis] = summed[fixed:] / total[fixed:]
    return moved
