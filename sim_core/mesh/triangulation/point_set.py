"""Growth triangulation of a plain point set."""

import numpy as np
from numba import njit

from sim_core.errors import OutlineError
from sim_core.mesh.triangulation.growth import CLOSED, grow_points

__all__ = ["triangulate"]

LARGEST, LEAST = 1e60, 1e-60  # sizes of coordinates for which the predicates are exact
UPRIGHT = np.array([1.0, -1.0])  # y down -> y up; exact


def triangulate(points: np.ndarray, edges: np.ndarray | None = None) -> np.ndarray:
    """Growth triangulation of a point set (Eq. 9): its Delaunay triangulation, decided exactly.

    points: (n, 2) [m], y down; equal points count as one (the first). Coordinates are zero or 1e-60 to 1e60 in size.
    edges: (m, 2) int, outline steps with the cloth on their left in (x, -y), and inner lines in both directions,
    crossing nowhere; the triangulation is then the constrained one of what they enclose. None: to the convex hull.
    Returns faces (F, 3) int32 with positive area in (x, -y); which triangles does not depend on the points' order.
    Raises OutlineError for points that are not finite or too few, and where growth cannot close.
    """
    points = np.asarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 2:
        raise OutlineError(f"points: shape {points.shape} – give (n, 2)")
    odd = _first_odd(points)
    if odd >= 0:
        raise OutlineError(
            f"point {odd} is {points[odd].tolist()} – give 0 or sizes of {LEAST:g} to {LARGEST:g}"
        )
    if len(np.unique(points[:1000], axis=0)) < 3 and len(np.unique(points, axis=0)) < 3:
        raise OutlineError(f"{len(np.unique(points, axis=0))} different points – a triangle needs three")
    if edges is not None:
        edges = np.asarray(edges)
        pairs = edges.ndim == 2 and edges.shape[1] == 2 and edges.dtype.kind in "iu"
        if not pairs or (edges.size and not 0 <= edges.min() <= edges.max() < len(points)):
            raise OutlineError(f"edges: give (m, 2) indices below {len(points)}")
    found = grow_points(points * UPRIGHT, edges)
    if found.status != CLOSED:
        x, y = points[found.where]
        raise OutlineError(
            f"growth does not close near ({x:.4f}, {y:.4f}) m – the edges cross or leave a gap"
        )
    return found.faces


@njit(cache=True)
def _first_odd(points):
    """Index of the first point with a coordinate that is not finite or out of range, or -1."""
    for k in range(points.shape[0]):
        for axis in range(2):
            size = abs(points[k, axis])
            if not (size == 0.0 or LEAST <= size <= LARGEST):
                return k
    return -1
