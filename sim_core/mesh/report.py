"""The figures of a finished mesh."""

import numpy as np
from numba import njit

from sim_core.mesh.model import MeshReport
from sim_core.mesh.quality import quality
from sim_core.mesh.verify import area_error, conformity

__all__ = ["deviation", "measured"]


def measured(vertices, faces, boundary, contours, free, seconds: float) -> MeshReport:
    """Measure a finished mesh against the contours that were given. Arrays as in PanelMesh; free: its `open_edges`."""
    angle, shape, ratio = quality(vertices, faces)
    return MeshReport(
        seconds=seconds,
        min_angle_deg=float(angle.min()),
        mean_quality=float(shape.mean()),
        worst_quality=float(shape.min()),
        mean_edge_ratio=float(ratio.mean()),
        worst_edge_ratio=float(ratio.min()),
        area_error=area_error(vertices, faces, boundary),
        conformity=conformity(free, boundary, len(vertices)),
        outline_deviation=max(
            deviation(contour, vertices[loop]) for contour, loop in zip(contours, boundary, strict=True)
        ),
    )


def deviation(contour: np.ndarray, loop: np.ndarray) -> float:
    """Hausdorff distance [m] between a given contour and the meshed one, from the points and middles of their steps."""
    return max(_farthest(contour, loop), _farthest(loop, contour))


@njit(cache=True, error_model="numpy")
def _farthest(points: np.ndarray, loop: np.ndarray) -> float:
    """Largest distance [m] from a point or step's middle of one closed contour to another."""
    worst = 0.0
    for k in range(2 * len(points)):
        x, y = points[k // 2, 0], points[k // 2, 1]
        if k % 2:
            after = (k // 2 + 1) % len(points)
            x, y = (x + points[after, 0]) / 2, (y + points[after, 1]) / 2
        nearest = np.inf
        for m in range(len(loop)):
            if nearest <= worst:
                break  # cannot be the farthest
            ux, uy = loop[m, 0] - loop[m - 1, 0], loop[m, 1] - loop[m - 1, 1]
            px, py = x - loop[m - 1, 0], y - loop[m - 1, 1]
            t = min(max((px * ux + py * uy) / (ux * ux + uy * uy), 0.0), 1.0)
            nearest = min(nearest, (px - t * ux) ** 2 + (py - t * uy) ** 2)
        worst = max(worst, nearest)
    return np.sqrt(worst)
