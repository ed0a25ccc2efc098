"""A flat panel turned into the stencils of the explicit solver: edge tensions and quadratic bending."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy import sparse

from sim_core.cloth.material import Material
from sim_core.errors import SimCoreError

# Quadratic isometric bending is 3 times too stiff on equilateral meshes (measured: 2.99), in any direction.
BENDING_SCALE = 1.0 / 3.0


class Stencil(NamedTuple):
    """The arrays the compiled loops read. V vertices, E edges, N neighbour entries."""

    inverse_mass: np.ndarray  # (V,) [1/kg], 0 where pinned
    edges: np.ndarray  # (E, 2) int32
    length2: np.ndarray  # (E,) squared rest length [m2]
    own: np.ndarray  # (E,) coefficient of the edge itself [N/m3]
    around: np.ndarray  # (E, 4) int32, the other edges of its triangles (itself where there is none)
    coupling: np.ndarray  # (E, 4) their coefficients (0 where there is none)
    rows: np.ndarray  # (V + 1,) int32 into the neighbour entries
    neighbour: np.ndarray  # (N,) int32
    edge_of: np.ndarray  # (N,) int32, -1: neighbour by bending only
    bend: np.ndarray  # (N,) off-diagonal entries of the bending matrix Q [N/m]


@dataclass(frozen=True)
class Sheet:
    """A panel ready to be simulated: rest (V, 2) [m], faces (F, 3), edges (E, 2), mass (V,) [kg], stencil."""

    rest: np.ndarray
    faces: np.ndarray
    edges: np.ndarray
    face_edges: np.ndarray
    mass: np.ndarray
    material: Material
    stencil: Stencil

    @staticmethod
    def of(rest: np.ndarray, faces: np.ndarray, material: Material) -> Sheet:
        """Assembles a sheet; rest: (V, 2) float [m], faces: (F, 3) int of either orientation.

        Raises SimCoreError on wrong shapes, non-finite coordinates, indices out of range, needles,
        unused vertices and edges with more than two faces.
        """
        rest, faces = _checked(rest, faces)
        edges, face_edges = face_edge_table(faces)
        area = _areas(rest, faces)
        mass = np.bincount(faces.ravel(), np.repeat(area / 3, 3), len(rest)) * material.density
        own, around, coupling = _membrane(rest, faces, face_edges, area, len(edges), material.elasticity())
        bending = _bending(rest, faces, edges, face_edges, area, material.bend)
        rows, neighbour, edge_of, bend = _neighbours(edges, bending, len(rest))
        length2 = ((rest[edges[:, 0]] - rest[edges[:, 1]]) ** 2).sum(1)
        stencil = Stencil(1 / mass, edges, length2, own, around, coupling, rows, neighbour, edge_of, bend)
        return Sheet(rest, faces, edges, face_edges, mass, material, stencil)

    def pinned(self, pins: np.ndarray) -> Stencil:
        """The stencil with the vertices `pins` (K,) held in place."""
        if len(pins) == 0:
            return self.stencil
        if pins.min() < 0 or pins.max() >= len(self.mass):
            raise SimCoreError(f"pins: index {pins.max()} – the sheet has vertices 0 to {len(self.mass) - 1}")
        inverse = self.stencil.inverse_mass.copy()
        inverse[pins] = 0.0
        return self.stencil._replace(inverse_mass=inverse)


def face_edge_table(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unique edges (E, 2) int32 and, per face, the edge opposite each corner (F, 3) int32."""
    pairs = np.stack([faces[:, [1, 2]], faces[:, [2, 0]], faces[:, [0, 1]]], axis=1).reshape(-1, 2)
    edges, index = np.unique(np.sort(pairs, axis=1), axis=0, return_inverse=True)
    return edges.astype(np.int32), index.reshape(-1, 3).astype(np.int32)


def _checked(rest: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    rest = np.ascontiguousarray(rest, float)
    faces = np.ascontiguousarray(faces)
    if rest.ndim != 2 or rest.shape[1] != 2:
        raise SimCoreError(f"rest: shape {rest.shape} – expected (V, 2), metres in the pattern plane")
    if (
        faces.ndim != 2
        or faces.shape[1:] != (3,)
        or not np.issubdtype(faces.dtype, np.integer)
        or len(faces) == 0
    ):
        raise SimCoreError(f"faces: shape {faces.shape}, {faces.dtype} – expected (F, 3) integers, F > 0")
    if not np.isfinite(rest).all():
        raise SimCoreError(f"rest: vertex {np.flatnonzero(~np.isfinite(rest).all(1))[0]} is not finite")
    if faces.min() < 0 or faces.max() >= len(rest):
        raise SimCoreError(f"faces: index {faces.max()} – there are vertices 0 to {len(rest) - 1}")
    unused = np.setdiff1d(np.arange(len(rest)), faces)
    if len(unused):
        raise SimCoreError(f"rest: vertex {unused[0]} belongs to no face – remove it")
    sides = rest[faces] - rest[np.roll(faces, 1, axis=1)]
    longest = (sides**2).sum(2).max(1)
    thin = np.flatnonzero(_areas(rest, faces) < 1e-3 * longest)
    if len(thin):
        raise SimCoreError(f"faces: face {thin[0]} is a needle or has no area – re-mesh the panel")
    return rest, faces.astype(np.int32)


def _areas(rest: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b = rest[faces[:, 1]] - rest[faces[:, 0]], rest[faces[:, 2]] - rest[faces[:, 0]]
    return 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _membrane(
    rest: np.ndarray,
    faces: np.ndarray,
    face_edges: np.ndarray,
    area: np.ndarray,
    count: int,
    elastic: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Five coefficients per edge: eps = l^2 - L^2 = R g fixes the Green strain g, so K = A R^-T D R^-1."""
    corner = rest[faces]
    side = np.roll(corner, -2, axis=1) - np.roll(corner, -1, axis=1)  # side a lies opposite corner a
    x, y = side[..., 0], side[..., 1]
    inverse = np.linalg.inv(2 * np.stack([x * x, y * y, 2 * x * y], axis=-1))
    stiffness = area[:, None, None] * np.einsum("fba,bc,fcd->fad", inverse, elastic, inverse)
    own = np.bincount(face_edges.ravel(), stiffness[:, range(3), range(3)].ravel(), count)
    around = np.repeat(np.arange(count, dtype=np.int32)[:, None], 4, axis=1)
    coupling = np.zeros((count, 4))
    filled = np.zeros(count, int)
    for corner_index in range(3):
        edge = face_edges[:, corner_index]
        for step in (1, 2):
            other = (corner_index + step) % 3
            # Two faces never share the same (edge, corner) slot in one pass unless their edge repeats.
            for part in _without_repeats(edge):
                slot = filled[edge[part]]
                if (slot >= 4).any():
                    raise SimCoreError(
                        f"faces: edge {edge[part][slot >= 4][0]} has more than two faces – cut it"
                    )
                around[edge[part], slot] = face_edges[part, other]
                coupling[edge[part], slot] = stiffness[part, corner_index, other]
                filled[edge[part]] += 1
    return own, around, coupling


def _without_repeats(values: np.ndarray) -> list[np.ndarray]:
    """Index arrays that together cover `values`, none naming the same value twice."""
    parts, left = [], np.arange(len(values))
    while len(left):
        _, first = np.unique(values[left], return_index=True)
        parts.append(left[first])
        left = np.delete(left, first)
    return parts


def _bending(
    rest: np.ndarray,
    faces: np.ndarray,
    edges: np.ndarray,
    face_edges: np.ndarray,
    area: np.ndarray,
    bend: float,
) -> sparse.csr_array:
    """Q (V, V) of the quadratic isometric bending energy x.Q.x/2 (Bergou et al. 2006), hinge by hinge."""
    face = np.repeat(np.arange(len(faces)), 3)
    order = np.argsort(face_edges.ravel(), kind="stable")
    edge_sorted = face_edges.ravel()[order]
    inner = np.flatnonzero(edge_sorted[1:] == edge_sorted[:-1])
    first, second = order[inner], order[inner + 1]
    edge = edge_sorted[inner]
    start, end = edges[edge, 0], edges[edge, 1]
    opposite = [faces.ravel()[first], faces.ravel()[second]]

    def cotangent(at: np.ndarray, to: np.ndarray, other: np.ndarray) -> np.ndarray:
        a, b = rest[to] - rest[at], rest[other] - rest[at]
        return (a * b).sum(1) / np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])

    c01, c02 = (cotangent(start, end, far) for far in opposite)
    c03, c04 = (cotangent(end, start, far) for far in opposite)
    weights = np.stack([c03 + c04, c01 + c02, -c01 - c03, -c02 - c04], axis=1)
    factor = BENDING_SCALE * 3 * bend / (area[face[first]] + area[face[second]])
    index = np.stack([start, end, *opposite], axis=1)
    values = factor[:, None, None] * weights[:, :, None] * weights[:, None, :]
    row, column = np.repeat(index, 4, axis=1), np.tile(index, (1, 4))
    return sparse.coo_array((values.ravel(), (row.ravel(), column.ravel())), (len(rest),) * 2).tocsr()


def _neighbours(
    edges: np.ndarray, bending: sparse.csr_array, count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """One list per vertex of all it is coupled to: by an edge, by bending, or both (Q's rows sum to 0)."""

    def keys(first: np.ndarray, second: np.ndarray) -> np.ndarray:
        return first.astype(np.int64) * count + second

    hinge = bending.tocoo()
    hinge.sum_duplicates()
    apart = hinge.row != hinge.col
    by_hinge, values = keys(hinge.row[apart], hinge.col[apart]), hinge.data[apart]
    by_edge = np.concatenate([keys(edges[:, 0], edges[:, 1]), keys(edges[:, 1], edges[:, 0])])
    all_keys = np.unique(np.concatenate([by_hinge, by_edge]))
    edge_of = np.full(len(all_keys), -1, np.int32)
    edge_of[np.searchsorted(all_keys, by_edge)] = np.tile(np.arange(len(edges), dtype=np.int32), 2)
    bend = np.zeros(len(all_keys))
    bend[np.searchsorted(all_keys, by_hinge)] = values
    rows = np.searchsorted(all_keys, np.arange(count + 1, dtype=np.int64) * count)
    return rows.astype(np.int32), (all_keys % count).astype(np.int32), edge_of, bend
