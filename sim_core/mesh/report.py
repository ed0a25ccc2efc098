"""The figures of a finished mesh."""

import numpy as np
from numba import njit

from sim_core.mesh.model import MeshReport
from sim_core.mesh.quality import quality
from sim_core.mesh.verify import area_error, conformity

__all__ = ["deviation", "measured"]


def measured(vertices, faces, boundary, free) -> MeshReport:
    """Measure a finished mesh, but for time and deviation (0). Arrays as in PanelMesh; free: its `open_edges`."""
    angle, shape, ratio = quality(vertices, faces)
    return MeshReport(
        seconds=0.0,
        min_angle_deg=float(angle.min()),
        mean_quality=float(shape.mean()),
        worst_quality=float(shape.min()),
        mean_edge_ratio=float(ratio.mean()),
        worst_edge_ratio=float(ratio.min()),
        area_error=area_error(vertices, faces, boundary),
        conformity=conformity(free, boundary, len(vertices)),
        outline_deviation=0.0,
    )


def deviation(given: list[np.ndarray], loops: list[np.ndarray], *, merged: bool = False) -> float:
    """Hausdorff distance [m] between given contours and meshed ones, from the points and middles of their steps.

    given, loops: (n, 2) [m] each; compared one by one, or all with all where holes were merged.
    """
    if merged:
        pairs = [(_steps(given), _steps(loops))]
    else:
        pairs = [(_steps([a]), _steps([b])) for a, b in zip(given, loops, strict=True)]
    return max(max(_farthest(a, b), _farthest(b, a)) for a, b in pairs)


def _steps(contours: list[np.ndarray]) -> np.ndarray:
    """The steps of closed contours (n, 2) as (m, 4): from, to."""
    return np.concatenate([np.hstack([contour, np.roll(contour, -1, axis=0)]) for contour in contours])


@njit(cache=True, error_model="numpy")
def _farthest(steps: np.ndarray, others: np.ndarray) -> float:
    """Largest distance [m] from the beginning or middle of one of the steps (n, 4) to the others (m, 4)."""
    worst = 0.0
    for k in range(2 * len(steps)):
        x, y = steps[k // 2, 0], steps[k // 2, 1]
        if k % 2:
            x, y = (x + steps[k // 2, 2]) / 2, (y + steps[k // 2, 3]) / 2
        nearest = np.inf
        for m in range(len(others)):
            if nearest <= worst:
                break  # cannot be the farthest
            ux, uy = others[m, 2] - others[m, 0], others[m, 3] - others[m, 1]
            px, py = x - others[m, 0], y - others[m, 1]
            t = min(max((px * ux + py * uy) / (ux * ux + uy * uy), 0.0), 1.0)
            nearest = min(nearest, (px - t * ux) ** 2 + (py - t * uy) ** 2)
        worst = max(worst, nearest)
    return np.sqrt(worst)
