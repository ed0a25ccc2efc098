"""Signed distance of a closed mesh on a grid: exact near the surface, swept beyond. See DETAILS.md."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial import ConvexHull, KDTree, QhullError

from sim_core.cloth.contact.field_kernels import crossings, interpolate, splat, spread, sweep
from sim_core.cloth.contact.solids import MOST_NODES, GridSdf
from sim_core.errors import SimCoreError
from sim_core.validation import FURTHEST, coordinates, excerpt, finite, triangles, vector3
from sim_core.validation import points as checked_points

__all__ = ["DistanceField", "closed", "field_of", "hull_faces", "hull_mesh", "united"]

SPACING = math.sqrt(0.5)  # [cells] that a surface's nearest crossing of the grid may lie beside one, at most
SLACK = 0.05  # [cells] by which a field's own error may lower it before a gap is seen there
EXACT_CELLS = 2.5  # nodes nearer than this to a face are measured against it; the others ask their neighbours
Corner = Sequence[float] | np.ndarray
Box = tuple[Corner, Corner]


@dataclass(frozen=True)
class DistanceField:
    """Signed distance at the nodes origin + cell * (i, j, k); negative inside.

    origin (3,) [m]; cell [m]; values (nx, ny, nz) float32 [m].
    """

    origin: np.ndarray
    cell: float
    values: np.ndarray = field(repr=False)

    def at(self, points: np.ndarray) -> np.ndarray:
        """Trilinear distance (N,) [m] at points (N, 3); outside the grid the border's value and the way there."""
        return self.with_gradient(points)[0]

    def with_gradient(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance (N,) and the gradient (N, 3) of the trilinear interpolation, not normalised."""
        return interpolate(self.values, self.origin, self.cell, np.ascontiguousarray(points, float))

    def box(self) -> Box:
        """Lowest and highest node [m]."""
        return self.origin, self.origin + self.cell * (np.array(self.values.shape) - 1)

    def solid(self) -> GridSdf:
        """The field as a solid a cloth can lie on."""
        x, y, z = (float(c) for c in self.origin)
        return GridSdf((x, y, z), self.cell, self.values)


def field_of(
    vertices: np.ndarray,
    faces: np.ndarray,
    *,
    cell: float = 0.008,
    band: float = 0.05,
    exact: float | None = None,
    hulls: Sequence[np.ndarray] = (),
    box: Box | None = None,
    far: bool = True,
) -> DistanceField:
    """The field of a closed mesh, vertices (V, 3) [m] and faces (F, 3) counter-clockwise from outside.

    band: within it nodes hold their distance to a face handed on by a neighbour, nearly always the nearest, and
    within `exact` (2.5 cells when left out, at most the band) to the nearest face for certain; beyond the band a
    fast-sweeping solution of |grad d| = 1 or, without `far`, the band itself. hulls: point sets (N, 3) whose convex
    hulls are united with the mesh (hands that cloth must slide over). box: lowest and highest corner, else the
    mesh's bounds and the band around. A point is inside where faces wind about it more than 0 times, so closed
    parts may overlap.
    Raises SimCoreError on wrong shapes, non-finite input, an open mesh and a grid beyond 200 million nodes.
    """
    vertices, faces = checked_mesh(vertices, faces, cell, band)
    if not isinstance(hulls, list | tuple):
        raise SimCoreError(f"field: hulls: {excerpt(hulls)} – give a list of point sets (N, 3)")
    hulls = [checked_points("field: hulls", points) for points in hulls]
    if exact is not None:
        finite("field: exact [m]", exact, least=0, most=FURTHEST)
    origin, shape = _grid(vertices if not hulls else np.concatenate([vertices, *hulls]), cell, band, box)
    exact = min(band, EXACT_CELLS * cell if exact is None else exact)
    values, _ = _sampled(vertices, faces, origin, shape, cell, band, exact, far)
    for points in hulls:
        hull, _ = _sampled(*hull_mesh(points), origin, shape, cell, band, exact, far)
        np.minimum(values, hull, out=values)
    return DistanceField(origin, cell, values)


def field_and_faces(
    vertices: np.ndarray, faces: np.ndarray, *, cell: float, band: float, box: Box
) -> tuple[np.ndarray, np.ndarray]:
    """Signed distance (nx, ny, nz) float32 within the band, and the face nearest to each node, int32 (-1 beyond).

    Of what `checked_mesh` gave.
    """
    origin, shape = _grid(vertices, cell, band, box)
    exact = min(band, EXACT_CELLS * cell)
    return _sampled(vertices, faces, origin, shape, cell, band, exact, False)


def united(first: DistanceField, second: DistanceField, *, thicker: float = 0.0) -> DistanceField:
    """min(first, second - thicker) on the grid of the first: outside, the distance to either [m].

    The second is sampled where its grid differs.
    """
    if first.values.shape == second.values.shape and np.allclose(first.origin, second.origin):
        other = second.values
    else:
        axes = [o + first.cell * np.arange(n) for o, n in zip(first.origin, first.values.shape, strict=True)]
        nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        other = second.at(nodes).reshape(first.values.shape).astype(np.float32)
    return DistanceField(first.origin, first.cell, np.minimum(first.values, other - np.float32(thicker)))


def closed(field: DistanceField, radius: float) -> DistanceField:
    """The field with gaps filled that no ball of that radius [m] enters: a closing, its surface nowhere within the old.

    Folds are pinched in such gaps (under arms, between a garment beneath and itself), where the sampled gradient jumps
    from one wall to the other. Elsewhere the values stay as they were, to the bit.
    """
    if radius <= 0.0:
        return field
    values, cell = field.values, field.cell
    front = _level(values, radius)
    if not len(front):
        return field
    near = np.argwhere((values < radius) & (values > -radius))
    way, _ = KDTree(front).query(near)
    distance = np.sqrt(
        np.maximum(way * way - SPACING * SPACING, 0.0)
    )  # of the front between its points, at least
    filled = np.float32(radius) - np.float32(cell) * (distance - SLACK).astype(np.float32)
    out = values.copy()
    at = tuple(near.T)
    out[at] = np.minimum(out[at], filled)
    return DistanceField(field.origin, cell, out)


def _level(values: np.ndarray, level: float) -> np.ndarray:
    """Where edges between neighbouring nodes cross a level: (N, 3) [cells]."""
    found = []
    for axis in range(3):
        here, there = (np.moveaxis(values, axis, 0)[part] for part in (slice(None, -1), slice(1, None)))
        index = np.argwhere((here < level) != (there < level))
        low, high = here[tuple(index.T)], there[tuple(index.T)]
        points = np.insert(
            index[:, 1:].astype(float), axis, index[:, 0] + (level - low) / (high - low), axis=1
        )
        found.append(points)
    return np.concatenate(found)


def hull_faces(points: np.ndarray) -> np.ndarray:
    """Faces (H, 3) int32 of the convex hull of points (N, 3), counter-clockwise from outside.

    Raises SimCoreError where they are too few or lie in one plane.
    """
    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError) as error:
        raise SimCoreError(
            f"field: {len(points)} points have no hull – give four that span a solid"
        ) from error
    corner = points[hull.simplices]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    inward = (normal * hull.equations[:, :3]).sum(1) < 0
    return np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices).astype(np.int32)


def hull_mesh(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The corners of the convex hull of points (N, 3) and its faces; raises as `hull_faces`."""
    used, index = np.unique(hull_faces(points), return_inverse=True)
    return np.ascontiguousarray(points[used], float), index.reshape(-1, 3).astype(np.int32)


def _sampled(
    vertices: np.ndarray,
    faces: np.ndarray,
    origin: np.ndarray,
    shape: tuple[int, int, int],
    cell: float,
    band: float,
    exact: float,
    far: bool,
) -> tuple[np.ndarray, np.ndarray]:
    """Signed distance (nx, ny, nz) float32 of one closed mesh, and the faces nearest to the nodes of the band."""
    nearest = np.full(shape, -1, np.int32)
    distance = np.full(shape, np.inf, np.float32)
    splat(vertices, faces, origin, cell, min(exact, EXACT_CELLS * cell), distance, nearest)
    spread(vertices, faces, origin, cell, band, distance, nearest)
    if exact > EXACT_CELLS * cell:  # quick now: only faces that beat what was handed on are measured
        splat(vertices, faces, origin, cell, exact, distance, nearest)
    if far:
        sweep(distance, nearest >= 0, cell)
    else:
        distance[nearest < 0] = band
    return crossings(vertices, faces, origin, cell, distance), nearest


def _grid(
    points: np.ndarray, cell: float, band: float, box: Box | None
) -> tuple[np.ndarray, tuple[int, int, int]]:
    if box is None:
        low, high = points.min(0) - band, points.max(0) + band
    elif isinstance(box, list | tuple) and len(box) == 2:
        low, high = (np.array(vector3("field: box", corner, "in metres")) for corner in box)
    else:
        raise SimCoreError(f"field: box: {excerpt(box)} – give its lowest and its highest corner")
    with np.errstate(over="ignore"):
        counts = np.ceil((high - low) / cell - 1e-9) + 1
        many = float(counts.prod())
    if counts.min() < 2 or many > MOST_NODES:
        raise SimCoreError(
            f"field: a box of {many:.3g} nodes, {cell} m a cell – take larger cells, at most {MOST_NODES:g} nodes"
        )
    return low, (int(counts[0]), int(counts[1]), int(counts[2]))


def checked_mesh(
    vertices: np.ndarray, faces: np.ndarray, cell: float, band: float
) -> tuple[np.ndarray, np.ndarray]:
    """A closed mesh, vertices (V, 3) and faces (F, 3) int32; raises SimCoreError for what is none."""
    vertices = coordinates("field: vertices", vertices)
    if vertices.ndim != 2 or vertices.shape[1:] != (3,):
        raise SimCoreError(f"field: vertices: shape {vertices.shape} – expected (V, 3)")
    checked_cell("field", cell, band)
    faces = np.ascontiguousarray(triangles("field: faces", faces, len(vertices)), np.int32)
    there = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1).astype(np.int64)
    forward = np.where(faces[:, [0, 1, 2]] < faces[:, [1, 2, 0]], 1, -1).ravel()
    _, first, index = np.unique(
        there[:, 0] * len(vertices) + there[:, 1], return_index=True, return_inverse=True
    )
    torn = np.flatnonzero(np.bincount(index.reshape(-1), forward) != 0)
    if len(torn):
        a, b = there[first[torn[0]]]
        x, y, z = (vertices[a] + vertices[b]) / 2
        raise SimCoreError(
            f"field: the mesh is open or ill-wound at {len(torn)} edges, the first between vertices {a} and {b} at "
            f"({x:.3f}, {y:.3f}, {z:.3f}) m – close it first"
        )
    if inside_out(vertices, faces):
        raise SimCoreError("field: the mesh is inside out – turn its faces counter-clockwise from outside")
    return vertices, faces


def inside_out(vertices: np.ndarray, faces: np.ndarray) -> bool:
    """Whether a closed mesh, vertices (V, 3) and faces (F, 3), encloses less than nothing."""
    a, b, c = (vertices[faces[:, k]] - vertices.mean(0) for k in range(3))
    return float((np.cross(a, b) * c).sum()) < 0.0


def checked_cell(name: str, cell: object, band: object) -> None:
    """Raises SimCoreError where a grid's cell and band [m] have no meaning."""
    size = finite(f"{name}: cell [m]", cell, above=0, most=FURTHEST)
    finite(f"{name}: band [m], at least two cells", band, least=2 * size, most=FURTHEST)
