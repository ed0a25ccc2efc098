"""The figures of a finished mesh."""

import numpy as np

from sim_core.mesh.model import MeshReport
from sim_core.mesh.quality import quality
from sim_core.mesh.verify import area_error, conformity

__all__ = ["measured"]


def measured(vertices, faces, boundary, contours, seconds: float) -> MeshReport:
    """Measure a finished mesh against the contours that were given. Arrays as in PanelMesh."""
    angle, shape, ratio = quality(vertices, faces)
    return MeshReport(
        seconds=seconds,
        min_angle_deg=float(angle.min()),
        mean_quality=float(shape.mean()),
        worst_quality=float(shape.min()),
        mean_edge_ratio=float(ratio.mean()),
        worst_edge_ratio=float(ratio.min()),
        area_error=area_error(vertices, faces, boundary),
        conformity=conformity(faces, boundary, len(vertices)),
        outline_deviation=max(
            _deviation(contour, vertices[loop]) for contour, loop in zip(contours, boundary, strict=True)
        ),
    )


def _deviation(contour: np.ndarray, loop: np.ndarray) -> float:
    """Hausdorff distance [m] between a given contour and the meshed one, from the points and middles of their steps."""
    return max(_farthest(contour, loop), _farthest(loop, contour))


def _farthest(points: np.ndarray, loop: np.ndarray) -> float:
    """Largest distance [m] from a point or step's middle of one closed contour to another."""
    worst = 0.0
    probes = np.concatenate([points, (points + np.roll(points, -1, axis=0)) / 2])
    a, b = loop, np.roll(loop, -1, axis=0)
    along = b - a
    square = (along**2).sum(axis=1)
    for block in np.array_split(probes, max(1, len(probes) * len(loop) // 2_000_000)):
        t = np.clip(((block[:, None] - a) * along).sum(axis=2) / square, 0, 1)
        gap = block[:, None] - a - t[..., None] * along
        worst = max(worst, float(np.sqrt((gap**2).sum(axis=2).min(axis=1)).max()))
    return worst
