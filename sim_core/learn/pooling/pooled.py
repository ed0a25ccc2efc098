"""What comes of pooling, how many vertices stay, and the triangles between those that do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.learn.topology import border_edges, border_vertices
from sim_core.mesh import triangle_areas, triangulate
from sim_core.validation import finite, vertex_indices

__all__ = ["Pooled", "joined", "protected_vertices", "staying"]

SLIVER = 1e-9  # of the mean area: less is a line of border points that rounding has bent


@dataclass(frozen=True)
class Pooled:
    """kept (K,) int64: the fine vertices that stay, in order; faces (G, 3) int32 over them by their place in `kept`, in
    the sense of the fine faces; share: K over the fine vertices."""

    kept: np.ndarray
    faces: np.ndarray
    share: float


def staying(count: int, share: float, protected: np.ndarray) -> int:
    """How many of so many vertices stay: the most that are less than the share.

    Raises SimCoreError where the share is not in (0, 1], or the protected (count,) bool are more than that.
    """
    share = finite("share", share, above=0.0, most=1.0)
    most = max(3, ceil(share * count - 1e-9) - 1)
    if protected.sum() > most:
        raise SimCoreError(
            f"share: {share:g} of {count} vertices – border and pins alone are {int(protected.sum())}; keep more, or "
            "not all of them"
        )
    return most


def protected_vertices(faces: np.ndarray, count: int, pins: Sequence[int], border: bool) -> np.ndarray:
    """Which of so many vertices must stay (count,) bool: pins, and the border's where it is wanted."""
    must = border_vertices(faces, count) if border else np.zeros(count, bool)
    must[list(vertex_indices("pins", pins, count))] = True
    return must


def joined(rest: np.ndarray, faces: np.ndarray, kept: np.ndarray) -> Pooled:
    """The Delaunay triangulation of kept (V,) bool at rest (V, 2) [m], within the sheet of the fine faces (F, 3).

    Where the whole border is kept it is the border here, too; else the triangles reach as far as the kept vertices do.
    """
    index = np.flatnonzero(kept)
    place = np.cumsum(kept) - 1
    sense = np.array([1.0, np.sign(triangle_areas(rest, faces).sum()) or 1.0])
    points = rest[index] * sense
    on = border_vertices(faces, len(rest))
    if kept[on].all():
        made = triangulate(points, place[border_edges(faces, len(rest))])
    else:
        made = triangulate(points)
        areas = triangle_areas(points, made)
        made = made[areas > SLIVER * areas.mean()]
        made = made[_within(rest * sense, faces, points[made].mean(1))]
    return Pooled(index.astype(np.int64), made.astype(np.int32), len(index) / len(rest))


def _within(rest: np.ndarray, faces: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Which points (N, 2) the faces cover, by how often they go round them."""
    loops = border_edges(faces, len(rest))
    a, b = rest[loops[:, 0]], rest[loops[:, 1]]
    turns = np.zeros(len(points))
    for k, point in enumerate(points):
        above = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
        p, q = a[above], b[above]
        right = p[:, 0] + (point[1] - p[:, 1]) / (q[:, 1] - p[:, 1]) * (q[:, 0] - p[:, 0]) > point[0]
        turns[k] = right.sum()
    return turns % 2 == 1
