"""The errors of a frame against its reference, at full resolution, and their mean and 95th percentile over frames.

The paper's Hausdorff distance "of the two sets of point sets" cannot be meant: between the vertices that stay and all
of them it is the spacing of the mesh. Here it is two-sided, from the vertices of each to the other's faces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.learn.topology import edges
from sim_core.metrics import intersections, surface_distance
from sim_core.validation import points, triangles, vertex_indices

__all__ = ["ErrorSummary", "FrameErrors", "frame_errors", "summary", "two_sided"]


@dataclass(frozen=True)
class FrameErrors:
    """One frame against its reference.

    hausdorff, surface [m]: the greatest and the mean distance of the vertices of each from the other's faces, both
    ways; vertex, vertex_p95, vertex_max [m]: how far vertices are from where they belong, mean, 95th percentile and
    greatest; normal [degrees]: mean angle between faces; strain: 99th percentile over edges of the difference in length
    over the rest length; intersections: pairs of edges and faces that pass through each other, and
    reference_intersections: those of the reference.
    """

    hausdorff: float
    surface: float
    vertex: float
    vertex_p95: float
    vertex_max: float
    normal: float
    strain: float
    intersections: float
    reference_intersections: float


@dataclass(frozen=True)
class ErrorSummary:
    """Mean and 95th percentile of each error over so many frames."""

    mean: FrameErrors
    p95: FrameErrors
    frames: int


def two_sided(
    positions: np.ndarray, faces: np.ndarray, others: np.ndarray, other_faces: np.ndarray
) -> np.ndarray:
    """Distances (V + W,) [m] of the vertices (V, 3) of one mesh from the faces of the other, and of (W, 3) back.

    Their maximum is the Hausdorff distance, as far as vertices tell. Raises SimCoreError for wrong shapes or NaN.
    """
    there = surface_distance(positions, others, other_faces)
    return np.concatenate([there, surface_distance(others, positions, faces)])


def frame_errors(
    positions: np.ndarray,
    reference: np.ndarray,
    faces: np.ndarray,
    rest: np.ndarray,
    *,
    over: Sequence[int] | np.ndarray | None = None,
) -> FrameErrors:
    """The errors of positions (V, 3) [m] against the reference (V, 3) [m] of the same faces (F, 3).

    rest: (V, 2) [m]; over: the vertices whose distance is told, those that pooling removed (None: all). Raises
    SimCoreError for arrays of another mesh, NaN, and no vertex to be told of.
    """
    positions, reference = points("positions", positions), points("reference", reference)
    faces = triangles("faces", faces, len(positions))
    flat = np.asarray(rest, float)
    if len(reference) != len(positions) or flat.shape != (len(positions), 2):
        raise SimCoreError(
            f"reference, rest: shapes {reference.shape}, {flat.shape} – of {len(positions)} vertices both are meant"
        )
    told = (
        np.arange(len(positions))
        if over is None
        else np.array(vertex_indices("over", over, len(positions)), int)
    )
    if not len(told):
        raise SimCoreError("over: no vertex – give one at least, or None for all")
    surface = two_sided(positions, faces, reference, faces)
    vertex = np.linalg.norm(positions[told] - reference[told], axis=1)
    return FrameErrors(
        hausdorff=float(surface.max()),
        surface=float(surface.mean()),
        vertex=float(vertex.mean()),
        vertex_p95=float(np.percentile(vertex, 95)),
        vertex_max=float(vertex.max()),
        normal=float(_angles(positions, reference, faces).mean()),
        strain=float(np.percentile(_strains(positions, reference, faces, flat), 99)),
        intersections=float(intersections(positions, faces)),
        reference_intersections=float(intersections(reference, faces)),
    )


def summary(errors: Sequence[FrameErrors]) -> ErrorSummary:
    """Mean and 95th percentile over frames. Raises SimCoreError where there is none."""
    if not errors:
        raise SimCoreError("errors: no frame – give one at least")
    names = [field.name for field in fields(FrameErrors)]
    table = np.array([[getattr(one, name) for name in names] for one in errors])
    mean, p95 = table.mean(0), np.percentile(table, 95, axis=0)
    return ErrorSummary(FrameErrors(*map(float, mean)), FrameErrors(*map(float, p95)), len(errors))


def _angles(positions: np.ndarray, reference: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Angle [degrees] between each face and the reference's; one without area is at right angles to all."""
    a, b = (_normals(places, faces) for places in (positions, reference))
    sine = np.linalg.norm(np.cross(a, b), axis=1)  # by both, since arccos is blunt at small angles
    cosine = (a * b).sum(1)
    return np.degrees(np.where((sine == 0) & (cosine == 0), 0.5 * np.pi, np.arctan2(sine, cosine)))


def _normals(places: np.ndarray, faces: np.ndarray) -> np.ndarray:
    p, q, r = (places[faces[:, k]] for k in range(3))
    normal = np.cross(q - p, r - p)
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)


def _strains(positions: np.ndarray, reference: np.ndarray, faces: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """By how much of its rest length each edge is longer or shorter than the reference's."""
    a, b = edges(faces).T
    there, wanted, flat = (np.linalg.norm(x[a] - x[b], axis=1) for x in (positions, reference, rest))
    return np.abs(there - wanted) / flat
