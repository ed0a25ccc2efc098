"""From a body scan-like mesh to a shop figure: one smooth solid without anatomy, by distance fields.

The trunk is replaced by a dress form: every horizontal section its convex hull (as a tape measure sees it),
smoothed along and around; hands become closed mittens, feet plain shapes, the neck ends in a dome. All parts
meet in one field by a smooth minimum, the field is smoothed and its zero surface meshed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter, gaussian_filter1d
from scipy.spatial import ConvexHull, QhullError

from sim_core.cloth.field import DistanceField, field_of, hull_mesh


@dataclass(frozen=True)
class FormSettings:
    """Lengths in metres."""

    cell: float = 0.005  # of the working field
    smooth: float = 0.006  # standard deviation of the field's smoothing
    blend: float = 0.022  # reach of the smooth minimum between parts
    along: float = 0.030  # smoothing of the dress form along the trunk
    around: float = 9.0  # [degrees] and around it
    slices: float = 0.005


def smooth_minimum(a: np.ndarray, b: np.ndarray, reach: float) -> np.ndarray:
    """min(a, b) with its crease filled over `reach` [m] (polynomial, reaches a quarter of it at a = b)."""
    near = np.maximum(reach - np.abs(a - b), 0.0) / reach
    return np.minimum(a, b) - 0.25 * reach * near * near


def _section(vertices: np.ndarray, faces: np.ndarray, y: float) -> np.ndarray:
    """Points (N, 2) x, z where the mesh meets the plane at height y."""
    height = vertices[:, 1] - y
    points = []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        a, b = faces[:, i], faces[:, j]
        cut = (height[a] < 0) != (height[b] < 0)
        a, b = a[cut], b[cut]
        t = (height[a] / (height[a] - height[b]))[:, None]
        points.append(((1 - t) * vertices[a] + t * vertices[b])[:, [0, 2]])
    return np.concatenate(points)


def dress_form(
    vertices: np.ndarray,
    faces: np.ndarray,
    heights: np.ndarray,
    half_width: np.ndarray,
    settings: FormSettings,
) -> tuple[np.ndarray, np.ndarray]:
    """A closed mesh of hulled sections at `heights` (H,), each cut at |x| <= half_width (H,) first."""
    angles = np.radians(np.arange(0.0, 360.0, 3.0))
    ray = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    sections, centres = [], []
    for y, wide in zip(heights, half_width, strict=True):
        points = _section(vertices, faces, float(y))
        points = np.concatenate([points, points * [-1, 1]])
        points = points[np.abs(points[:, 0]) <= wide]
        sections.append(points)
        centres.append((points[:, 1].min() + points[:, 1].max()) / 2)
    middle = gaussian_filter1d(np.array(centres), settings.along / settings.slices, mode="nearest")
    radius = np.zeros((len(heights), len(angles)))
    for row, (points, z) in enumerate(zip(sections, middle, strict=True)):
        try:
            hull = ConvexHull(points - [0.0, z])
        except QhullError as error:
            raise ValueError(f"section at {heights[row]:.3f} m has no area") from error
        along = ray @ hull.equations[:, :2].T
        with np.errstate(divide="ignore"):
            reach = np.where(along > 1e-9, -hull.equations[:, 2] / along, np.inf)
        radius[row] = reach.min(1)
    radius = gaussian_filter1d(radius, settings.around / 3.0, axis=1, mode="wrap")
    radius = gaussian_filter1d(radius, settings.along / settings.slices, axis=0, mode="nearest")
    ring = np.stack(
        [
            radius * ray[:, 0],
            np.broadcast_to(heights[:, None], radius.shape),
            middle[:, None] + radius * ray[:, 1],
        ],
        axis=-1,
    )
    return _tube(ring)


def _tube(rings: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A closed mesh over rings (H, A, 3), capped by fans."""
    h, a = rings.shape[:2]
    caps = np.stack([rings[0].mean(0), rings[-1].mean(0)])
    number = np.arange(h * a).reshape(h, a)
    i, j = number[:-1], number[1:]
    i2, j2 = np.roll(i, -1, axis=1), np.roll(j, -1, axis=1)
    faces = [np.stack([i, j, i2], -1), np.stack([i2, j, j2], -1)]
    bottom, top = number[0], number[-1]
    fan = [
        np.stack([np.full(a, h * a), bottom, np.roll(bottom, -1)], 1),
        np.stack([np.full(a, h * a + 1), np.roll(top, -1), top], 1),
    ]
    joined = np.concatenate([*(f.reshape(-1, 3) for f in faces), *fan])
    return np.concatenate([rings.reshape(-1, 3), caps]), joined.astype(np.int32)
