"""The one place where a published number is computed: distances between surfaces, strain, penetration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.metrics.components import components
from sim_core.metrics.face_tree import crossings_with, face_tree, nearest_face
from sim_core.metrics.triangles import crossings, winding

__all__ = [
    "Distances",
    "Penetration",
    "area_strain",
    "hausdorff",
    "intersections",
    "penetration",
    "sample_surface",
    "surface_distance",
]

FAR = 0.1  # [m] nobody asks how far beyond this a cloth is from a solid
TINY = 1e-9  # [m] a solid flatter than this holds nothing


@dataclass(frozen=True)
class Distances:
    """Two-sided surface distance [m]: over both directions, and each way (a to b, b to a) as (mean, p99, max)."""

    mean: float
    p99: float
    max: float
    a_to_b: tuple[float, float, float]
    b_to_a: tuple[float, float, float]


@dataclass(frozen=True)
class Penetration:
    """How many vertices, edge midpoints and centroids lie inside a solid, and the least distance [m] of each.

    Distances above FAR are told as FAR. edges: how often an edge of the cloth passes through a face of the solid, or
    one of the solid through one of the cloth, as a thumb does between the points that are looked at.
    """

    vertices: int
    midpoints: int
    centroids: int
    edges: int
    clearance: tuple[float, float, float]

    @property
    def total(self) -> int:
        """All points inside."""
        return self.vertices + self.midpoints + self.centroids


def _mesh(name: str, vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    vertices, faces = np.ascontiguousarray(vertices, float), np.ascontiguousarray(faces, np.int32)
    if (
        vertices.ndim != 2
        or vertices.shape[1] != 3
        or faces.ndim != 2
        or faces.shape[1] != 3
        or len(faces) == 0
    ):
        raise SimCoreError(
            f"{name}: shapes {vertices.shape}, {faces.shape} – expected (V, 3) and (F, 3), F > 0"
        )
    if not np.isfinite(vertices).all() or faces.min() < 0 or faces.max() >= len(vertices):
        raise SimCoreError(f"{name}: coordinates that are not finite or faces that name no vertex")
    return vertices, faces


def sample_surface(vertices: np.ndarray, faces: np.ndarray, spacing: float) -> np.ndarray:
    """Points (N, 3) on every face, no two neighbours further apart than `spacing` [m]; vertices included."""
    vertices, faces = _mesh("mesh", vertices, faces)
    corner = vertices[faces]
    longest = np.sqrt(((corner - np.roll(corner, 1, axis=1)) ** 2).sum(2).max(1))
    steps = np.maximum(1, np.ceil(longest / spacing)).astype(int)
    parts = [vertices]
    for n in np.unique(steps):
        i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
        keep = i + j <= n
        weight = np.stack([i[keep], j[keep], n - i[keep] - j[keep]], axis=1) / n
        parts.append(np.einsum("kc,fcd->fkd", weight, corner[steps == n]).reshape(-1, 3))
    return np.concatenate(parts)


def surface_distance(
    points: np.ndarray, vertices: np.ndarray, faces: np.ndarray, *, limit: float = np.inf
) -> np.ndarray:
    """Exact unsigned distance (N,) [m] of points (N, 3) to a mesh; beyond `limit` [m] the limit is returned."""
    vertices, faces = _mesh("mesh", vertices, faces)
    return nearest_face(np.ascontiguousarray(points, float), face_tree(vertices, faces), float(limit))


def hausdorff(
    vertices_a: np.ndarray,
    faces_a: np.ndarray,
    vertices_b: np.ndarray,
    faces_b: np.ndarray,
    *,
    spacing: float,
) -> Distances:
    """Sampled two-sided distance of two surfaces; the samples lie `spacing` [m] apart, the foot points are exact.

    Raises SimCoreError on wrong shapes or non-finite input.
    """
    there = surface_distance(sample_surface(vertices_a, faces_a, spacing), vertices_b, faces_b)
    back = surface_distance(sample_surface(vertices_b, faces_b, spacing), vertices_a, faces_a)

    def summary(d: np.ndarray) -> tuple[float, float, float]:
        return float(d.mean()), float(np.percentile(d, 99)), float(d.max())

    first, second = summary(there), summary(back)
    both = summary(np.concatenate([there, back]))
    return Distances(both[0], max(first[1], second[1]), both[2], first, second)


def area_strain(rest: np.ndarray, positions: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Relative change of area (F,) between flat and draped faces.

    rest: (V, 2) [m], or (F, 3, 2) by corner where vertices of several panels are welded; positions: (V, 3) [m].
    """
    corner = rest if rest.ndim == 3 else rest[faces]
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    flat = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    p, q = positions[faces[:, 1]] - positions[faces[:, 0]], positions[faces[:, 2]] - positions[faces[:, 0]]
    return np.linalg.norm(np.cross(p, q), axis=1) / flat - 1


def _signed(points: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Signed distance to closed meshes, which may overlap; negative inside any."""
    distance = surface_distance(points, vertices, faces, limit=FAR)
    part = components(len(vertices), faces.ravel(), np.roll(faces, 1, axis=1).ravel())
    part_of_face = part[faces[:, 0]]
    for number in np.unique(part_of_face):
        own = faces[part_of_face == number]
        low, high = vertices[own].min((0, 1)), vertices[own].max((0, 1))
        boxed = np.flatnonzero(((points >= low) & (points <= high)).all(1))
        if len(boxed):
            inside = boxed[_turns(points[boxed], vertices, own) > 0.5]
            distance[inside] = -np.abs(distance[inside])
    return distance


def _turns(points: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """How often a mesh goes round each point (N,).

    Where every edge is met by as many faces one way as the other, that is what a ray from the point crosses, a few
    faces; of an open mesh it is the generalised winding number, to which all faces add.
    """
    used, index = np.unique(faces, return_inverse=True)
    vertices, faces = vertices[used], index.reshape(-1, 3)
    edges = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2) @ np.array([[len(used), 1], [1, len(used)]])
    there, back = np.sort(edges, axis=0).T
    if not np.array_equal(there, back):
        return winding(points, vertices, faces)
    wide = float(np.ptp(vertices[:, 1:], axis=0).max())
    return crossings(points, vertices, faces, max(wide, TINY) / np.sqrt(len(faces)))


def penetration(
    vertices: np.ndarray, faces: np.ndarray, solid_vertices: np.ndarray, solid_faces: np.ndarray
) -> Penetration:
    """Checks a cloth (V, 3), (F, 3) against closed solid meshes, by how often they go round a point and exact distance.

    Independent of any solver's distance function: it looks at the triangles that a visitor sees.
    """
    vertices, faces = _mesh("cloth", vertices, faces)
    solid_vertices, solid_faces = _mesh("solid", solid_vertices, solid_faces)
    pairs = _edges(faces)
    middles, centres = vertices[pairs].mean(1), vertices[faces].mean(1)
    signed = [_signed(points, solid_vertices, solid_faces) for points in (vertices, middles, centres)]
    inside = [int((d < 0).sum()) for d in signed]
    least = (float(signed[0].min()), float(signed[1].min()), float(signed[2].min()))
    count = len(vertices)
    both, around = np.concatenate([vertices, solid_vertices]), solid_faces + count
    through = _crossings(both, pairs, around) + _crossings(both, _edges(solid_faces) + count, faces)
    return Penetration(inside[0], inside[1], inside[2], through, least)


def intersections(vertices: np.ndarray, faces: np.ndarray) -> int:
    """Number of (edge, face) pairs of a mesh that pass through each other and share no vertex."""
    vertices, faces = _mesh("mesh", vertices, faces)
    return _crossings(vertices, _edges(faces), faces)


def _edges(faces: np.ndarray) -> np.ndarray:
    """Every edge (E, 2) of the faces once."""
    return np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)


def _crossings(vertices: np.ndarray, edges: np.ndarray, faces: np.ndarray) -> int:
    """How often one of the edges (E, 2) passes through one of the faces (F, 3) and shares no vertex with it."""
    return int(crossings_with(vertices, edges, faces, face_tree(vertices, faces)))
