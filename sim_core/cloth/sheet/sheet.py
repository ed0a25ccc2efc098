"""Flat panels turned into the stencils of the explicit solver: edge tensions and quadratic bending.

Everything is computed from the pattern coordinates of each face's corners, not of vertices: panels that are welded
along a seam keep their own coordinates there, and what welding changes is an index list.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy import sparse

from sim_core.cloth.sheet.balance import areas
from sim_core.cloth.sheet.bending import bending_matrix
from sim_core.cloth.sheet.material import Material
from sim_core.errors import SimCoreError
from sim_core.validation import coordinates, excerpt, instance_of, numeric_array, triangles

SHORTEST = 1e-7  # [m], of a face's longest side


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
    """Cloth ready to be simulated: rest (V, 2) [m], faces (F, 3), edges (E, 2), mass (V,) [kg], stencil.

    corner: (F, 3, 2) [m] the faces in their panels; material: the one whose damping and friction hold for all.
    """

    rest: np.ndarray
    faces: np.ndarray
    edges: np.ndarray
    face_edges: np.ndarray
    mass: np.ndarray
    material: Material
    stencil: Stencil
    corner: np.ndarray

    @staticmethod
    def of(rest: np.ndarray, faces: np.ndarray, material: Material) -> Sheet:
        """Assembles a sheet; rest: (V, 2) float [m], faces: (F, 3) int of either orientation.

        Bending is balanced (`balance.py`) but on lattices, which would change a little at their sides alone.
        Raises SimCoreError on wrong shapes, non-finite coordinates, indices out of range, needles,
        unused vertices, faces that are there twice and edges with more than two faces.
        """
        rest, faces = _checked_indices(rest, faces)
        _check_twice(faces)
        corner = rest[faces]
        return Sheet._assembled(rest, corner, faces, (material,), np.zeros(len(faces), np.int32), None)

    @staticmethod
    def of_corners(
        corner: np.ndarray,
        faces: np.ndarray,
        materials: Sequence[Material],
        kind: np.ndarray,
        *,
        balanced: bool | None = False,
        creases: np.ndarray | None = None,
    ) -> Sheet:
        """Assembles panels that share vertices along welded seams.

        corner: (F, 3, 2) float [m], pattern coordinates of each face's corners; faces: (F, 3) int into the welded
        vertices; kind: (F,) which of `materials` each face is made of. Sides that two panels bring together should
        be equally long; an edge takes the mean. rest of the result lays each panel's vertices out as cut, the
        coordinates of a welded vertex being those of the first face that names it. balanced: bending as `of` has it
        (None: but on lattices); garments are as they were baked, without. creases: pairs (K, 2) of
        vertices, edges of the mesh, across which cloth is folded without resistance. Raises SimCoreError as `of`.
        """
        faces, kind = triangles("faces", faces), numeric_array("kind", kind, "expected whole numbers (F,)")
        corner = coordinates("corner", corner)
        if corner.shape != (*faces.shape, 2) or kind.shape != (len(faces),):
            raise SimCoreError(
                f"corner: {corner.shape}, faces: {faces.shape}, kind: {kind.shape} – expected (F, 3, 2), (F, 3), (F,)"
            )
        if not isinstance(materials, list | tuple) or not materials:
            raise SimCoreError(f"materials: {excerpt(materials)} – give a list of Material, at least one")
        if faces.max() >= faces.size:
            raise SimCoreError(
                f"faces: index {faces.max()} – {len(faces)} faces have no more than {faces.size} vertices"
            )
        if not np.issubdtype(kind.dtype, np.integer) or kind.min() < 0 or kind.max() >= len(materials):
            raise SimCoreError(
                f"kind: {kind.min()} to {kind.max()} – there are materials 0 to {len(materials) - 1}"
            )
        count = int(faces.max()) + 1
        rest = np.full((count, 2), np.nan)
        rest[faces.ravel()[::-1]] = corner.reshape(-1, 2)[::-1]
        used = ~np.isnan(rest[:, 0])
        if not used.all():
            raise SimCoreError(f"faces: vertex {np.flatnonzero(~used)[0]} belongs to no face – remove it")
        rest, faces = _checked_indices(rest, faces)
        kinds = np.asarray(kind, np.int32)
        return Sheet._assembled(rest, corner, faces, tuple(materials), kinds, balanced, creases)

    @staticmethod
    def _assembled(
        rest: np.ndarray,
        corner: np.ndarray,
        faces: np.ndarray,
        materials: tuple[Material, ...],
        kind: np.ndarray,
        balanced: bool | None,
        creases: np.ndarray | None = None,
    ) -> Sheet:
        for material in materials:
            instance_of("material", material, Material, "a Material is meant")
        _check_needles(corner)
        edges, face_edges = face_edge_table(faces)
        area = areas(corner)
        mass, stiffness = np.zeros(len(rest)), np.zeros((len(faces), 3, 3))
        for number, material in enumerate(materials):
            own = np.flatnonzero(kind == number)
            share = np.bincount(faces[own].ravel(), np.repeat(area[own] / 3, 3), len(rest))
            mass += share * material.density
            stiffness[own] = _stiffness(corner[own], area[own], material.elasticity())
        own, around, coupling = _membrane(stiffness, face_edges, len(edges))
        bend = np.array([material.bending() for material in materials])[kind]
        folded = None if creases is None else _numbers(edges, creases)
        bending = bending_matrix(
            corner, faces, face_edges, len(edges), bend, len(rest), balanced=balanced, creases=folded
        )
        rows, neighbour, edge_of, bend = _neighbours(edges, bending, len(rest))
        stencil = Stencil(
            inverse_mass=1 / mass,
            edges=edges,
            length2=_edge_lengths2(corner, face_edges, len(edges)),
            own=own,
            around=around,
            coupling=coupling,
            rows=rows,
            neighbour=neighbour,
            edge_of=edge_of,
            bend=bend,
        )
        return Sheet(
            rest=rest,
            faces=faces,
            edges=edges,
            face_edges=face_edges,
            mass=mass,
            material=materials[0],
            stencil=stencil,
            corner=corner,
        )


def face_edge_table(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unique edges (E, 2) int32 and, per face, the edge opposite each corner (F, 3) int32."""
    pairs = np.stack([faces[:, [1, 2]], faces[:, [2, 0]], faces[:, [0, 1]]], axis=1).reshape(-1, 2)
    edges, index = np.unique(np.sort(pairs, axis=1), axis=0, return_inverse=True)
    return edges.astype(np.int32), index.reshape(-1, 3).astype(np.int32)


def _numbers(edges: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Numbers (k,) of the edges (E, 2) that are among pairs (K, 2) of vertices."""
    count = int(edges.max()) + 1
    low, high = np.sort(np.asarray(pairs, np.int64).reshape(-1, 2), axis=1).T
    return np.flatnonzero(np.isin(edges[:, 0].astype(np.int64) * count + edges[:, 1], low * count + high))


def _checked_indices(rest: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    rest = coordinates("rest", rest)
    if rest.ndim != 2 or rest.shape[1] != 2:
        raise SimCoreError(f"rest: shape {rest.shape} – expected (V, 2), metres in the pattern plane")
    faces = triangles("faces", faces, len(rest))
    unused = np.setdiff1d(np.arange(len(rest)), faces)
    if len(unused):
        raise SimCoreError(f"rest: vertex {unused[0]} belongs to no face – remove it")
    return rest, faces.astype(np.int32)


def _check_twice(faces: np.ndarray) -> None:
    _, first, times = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    if times.max() > 1:
        twice = first[times > 1].min()
        raise SimCoreError(f"faces: face {twice} is there again, with the same three vertices – remove one")


def _check_needles(corner: np.ndarray) -> None:
    sides = corner - np.roll(corner, 1, axis=1)
    longest = (sides**2).sum(2).max(1)
    small = np.flatnonzero(longest < SHORTEST**2)
    if len(small):
        raise SimCoreError(f"faces: face {small[0]} is smaller than {SHORTEST:g} m – lengths are metres")
    thin = np.flatnonzero(areas(corner) < 1e-3 * longest)
    if len(thin):
        raise SimCoreError(f"faces: face {thin[0]} is a needle or has no area – re-mesh the panel")


def _edge_lengths2(corner: np.ndarray, face_edges: np.ndarray, count: int) -> np.ndarray:
    """Squared rest length (E,) [m2]; where two panels meet, of the mean of both their lengths."""
    side = np.roll(corner, -2, axis=1) - np.roll(corner, -1, axis=1)
    length2 = (side**2).sum(2).ravel()
    edge = face_edges.ravel()
    low, high = np.full(count, np.inf), np.zeros(count)
    np.minimum.at(low, edge, length2)
    np.maximum.at(high, edge, length2)
    return np.where(low == high, low, (0.5 * (np.sqrt(low) + np.sqrt(high))) ** 2)


def _stiffness(corner: np.ndarray, area: np.ndarray, elastic: np.ndarray) -> np.ndarray:
    """K (F, 3, 3) of W = eps.K.eps / 2: eps = l^2 - L^2 = R g fixes the Green strain g, so K = A R^-T D R^-1."""
    side = np.roll(corner, -2, axis=1) - np.roll(corner, -1, axis=1)  # side a lies opposite corner a
    x, y = side[..., 0], side[..., 1]
    inverse = np.linalg.inv(2 * np.stack([x * x, y * y, 2 * x * y], axis=-1))
    return area[:, None, None] * np.einsum("fba,bc,fcd->fad", inverse, elastic, inverse)


def _membrane(
    stiffness: np.ndarray, face_edges: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Five coefficients per edge: its own, and those of the other edges of its faces."""
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


def mended(
    rest: np.ndarray, faces: np.ndarray, *, near: float = 1e-6
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rest (W, 2), faces (G, 3) and the new number (V,) of every vertex of rest (V, 2) [m], faces (F, 3).

    Vertices closer than `near` [m] become one; faces that lose a corner or have no area (height below `near`), and
    those that are there twice, go; vertices no face names get the number -1. Raises SimCoreError if nothing is left.
    """
    from scipy.spatial import KDTree  # a quarter of a second that few need

    rest, faces = coordinates("rest", rest), triangles("faces", faces)
    if faces.min() < 0 or faces.max() >= len(rest):
        raise SimCoreError(f"faces: {faces.min()} to {faces.max()} – there are vertices 0 to {len(rest) - 1}")
    number = np.arange(len(rest))
    for a, b in sorted(KDTree(rest).query_pairs(near)):
        number[number == number[b]] = number[a]
    faces = number[faces]
    a, b, c = (rest[faces[:, k]] for k in range(3))
    double = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    longest = np.sqrt(np.maximum.reduce([((p - q) ** 2).sum(1) for p, q in ((a, b), (b, c), (c, a))]))
    faces = faces[double > near * longest]
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    faces = faces[np.sort(first)]
    if not len(faces):
        raise SimCoreError("faces: none has an area – the mesh is empty once mended")
    used = np.unique(faces)
    place = np.full(len(rest), -1)
    place[used] = np.arange(len(used))
    return rest[used], place[faces].astype(np.int32), place[number]
