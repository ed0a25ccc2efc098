"""Gauss curvature of a mesh by its angle defects, border included (Gauss and Bonnet)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.mesh.measures import open_edges
from sim_core.validation import coordinates, triangles

__all__ = ["angle_defects", "gauss_curvature", "mean_absolute_curvature"]


def angle_defects(positions: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """What the angles round each vertex (V,) [rad] lack of 2 pi, and of pi at the border.

    positions: (V, 3) [m]; faces: (F, 3). Each border edge takes pi / 2 from both its ends, so the sum over all vertices
    is 2 pi times the Euler characteristic on any mesh. Raises SimCoreError for coordinates that are not finite.
    """
    positions, faces = _mesh(positions, faces)
    return _whole(faces, len(positions)) - _angles_and_areas(positions, faces)[0]


def gauss_curvature(positions: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """K (V,) [1/m2]: the angle defect over the area of the vertex's local domain, a third of its ring of faces.

    At the border it is the border's turn in the surface that counts. Arguments and errors as of `angle_defects`.
    """
    positions, faces = _mesh(positions, faces)
    return _curvature(positions, faces, _whole(faces, len(positions)))


def mean_absolute_curvature(frames: Iterable[np.ndarray], faces: np.ndarray) -> np.ndarray:
    """The mean |K| (V,) [1/m2] of frames (V, 3) [m] that come one after the other; none of them is kept.

    At rest a sheet is flat and K is 0 all over, so it is the frames of training that tell where a cloth bends twice.
    Raises SimCoreError where there is no frame, or one of another shape.
    """
    total: np.ndarray | None = None
    whole, count = np.zeros(0), 0
    for frame in frames:
        positions, faces = _mesh(frame, faces)
        if total is None:
            total, whole = np.zeros(len(positions)), _whole(faces, len(positions))
        if len(positions) != len(total):
            raise SimCoreError(
                f"frames: {len(positions)} vertices after {len(total)} – give frames of one mesh"
            )
        total += np.abs(_curvature(positions, faces, whole))
        count += 1
    if total is None:
        raise SimCoreError("frames: there are none – give one at least")
    return total / count


def _mesh(positions: object, faces: object) -> tuple[np.ndarray, np.ndarray]:
    points = coordinates("positions", positions)
    if points.ndim != 2 or points.shape[1] != 3:
        raise SimCoreError(f"positions: shape {points.shape} – vertices (V, 3) [m] are meant")
    return points, triangles("faces", faces, len(points))


def _whole(faces: np.ndarray, count: int) -> np.ndarray:
    """What the angles round each vertex of a flat sheet with a straight border add up to."""
    border = open_edges(np.ascontiguousarray(faces, np.int32), count)[0]
    return 2 * np.pi - 0.5 * np.pi * np.bincount(border.ravel(), minlength=count)


def _angles_and_areas(positions: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sum of angles [rad] and a third of the faces' area [m2] round each vertex."""
    corner = positions[faces]
    double = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    angles, areas = np.zeros(len(positions)), np.zeros(len(positions))
    for k in range(3):
        ahead, behind = (corner[:, (k + step) % 3] - corner[:, k] for step in (1, 2))
        angle = np.arctan2(double, (ahead * behind).sum(1))
        angles += np.bincount(faces[:, k], angle, len(positions))
        areas += np.bincount(faces[:, k], double / 6, len(positions))
    return angles, areas


def _curvature(positions: np.ndarray, faces: np.ndarray, whole: np.ndarray) -> np.ndarray:
    angles, areas = _angles_and_areas(positions, faces)
    return np.divide(whole - angles, areas, out=np.zeros(len(areas)), where=areas > 0)
