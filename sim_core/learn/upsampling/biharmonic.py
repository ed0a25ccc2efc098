"""The smoothest fine mesh through the coarse vertices, as a sparse matrix that keeps affine maps exact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, csr_array, eye_array, issparse
from scipy.sparse.linalg import SuperLU, splu

from sim_core.errors import SimCoreError
from sim_core.learn.topology import checked_sheet, edges
from sim_core.learn.upsampling.edge_laplacian import squared_laplacian
from sim_core.validation import finite, vertex_indices

__all__ = ["Biharmonic", "biharmonic"]

BLOCK = 64  # rows that are dense at a time
HOLD = 1e6  # of the energy's mean diagonal: how hard a coarse vertex within a fine face draws at its corners
EXACT = 1e-9  # of affine maps
ONCE_MORE = 3  # rounds of the correction: the first does it, the others take its rounding out


@dataclass(frozen=True)
class Biharmonic:
    """matrix (V, K): fine = matrix @ coarse. cut: the greatest sum of what a row lost or was given by being cut.

    Affine maps being exact, cutting moves no vertex by more than cut times the greatest distance of a coarse vertex
    from an affine map of the sheet.
    """

    matrix: csr_array
    cut: float


def biharmonic(
    rest: np.ndarray, faces: np.ndarray, constraints: np.ndarray | csr_array, *, cut: float = 1e-4
) -> Biharmonic:
    """The x (V,) of least squared Laplacian with C x = coarse (Botsch and Kobbelt 2004).

    rest: (V, 2) [m]; faces: (F, 3), the fine mesh. constraints: the fine vertices (K,) that are the coarse ones, or C
    (K, V), such as `linear(rest, faces, rest_coarse)`, where these lie anywhere in the fine mesh; those within a face
    draw at it as springs a million times as stiff as the sheet.

    Rows are cut: weights below `cut` times the row's greatest are dropped (0: none). The others are then given back
    what is missing of affine maps, the least change in the norm weighted by 1 / |w|: w + |w| p.m, with p = (1, X, Y)
    the coarse vertices at rest about the fine one and m (3,) such that 1, X and Y come out exactly. Raises
    SimCoreError for constraints that contradict each other or do not hold the sheet.
    """
    rest, faces = checked_sheet(rest, faces)
    cut = finite("cut", cut, least=0.0, most=0.5)
    held = _constraints(constraints, len(rest))
    edge = edges(faces)
    scale = float(np.linalg.norm(rest[edge[:, 0]] - rest[edge[:, 1]], axis=1).mean())
    flat = rest / scale
    matrix, lost = _rows(squared_laplacian(flat, faces), held, cut)
    coarse = held @ flat
    matrix, given = _affine(matrix, coarse, flat)
    return Biharmonic(matrix, float((lost + given).max()))


def _constraints(constraints: np.ndarray | csr_array, count: int) -> csr_array:
    if issparse(constraints):
        held = csr_array(constraints, dtype=float)
        if held.shape != (held.indptr.size - 1, count):
            raise SimCoreError(f"constraints: shape {held.shape} – (K, {count}) is meant")
    else:
        kept = np.array(vertex_indices("constraints", constraints, count), int)
        held = csr_array((np.ones(len(kept)), (np.arange(len(kept)), kept)), shape=(len(kept), count))
    held.eliminate_zeros()
    if held.indptr.size < 4 or abs(held.sum(1) - 1.0).max() > EXACT:
        raise SimCoreError("constraints: give three coarse vertices or more, the weights of each 1 in all")
    return held


def _rows(energy: csr_array, held: csr_array, cut: float) -> tuple[csr_array, np.ndarray]:
    """The solution's rows (V, K), cut, and the sum of what each lost (V,).

    Coarse vertices that are fine ones are put in, others draw as springs do, so that the system S of the free vertices
    stays positive definite. With B what coarse vertices do to its right side, the row of free vertex i is (S^-1 e_i)'B.
    """
    single = np.diff(held.indptr) == 1
    fixed, names = held[single].indices.astype(np.int64), np.flatnonzero(single)
    if len(np.unique(fixed)) < len(fixed):
        raise SimCoreError("constraints: two coarse vertices are the same fine one")
    shape = (len(energy.indptr) - 1, len(held.indptr) - 1)
    made = [csr_array((np.ones(len(fixed)), (fixed, names)), shape=shape)]
    free, lost = np.setdiff1d(np.arange(shape[0]), fixed), np.zeros(shape[0])
    if not len(free):
        return made[0], lost
    springs = HOLD * energy.diagonal().mean() * held[~single]
    system = csr_array(energy + springs.T @ held[~single])[free]
    every = csr_array(eye_array(shape[1]))
    right = springs.T[free] @ every[~single] - system[:, fixed] @ every[single]
    right = csr_array(right.T)
    solved = _factorised(csc_array(system[:, free]))
    for begin in range(0, len(free), BLOCK):
        chosen = np.arange(begin, min(begin + BLOCK, len(free)))
        unit = np.zeros((len(free), len(chosen)))
        unit[chosen, chosen - begin] = 1.0
        dense = (right @ solved.solve(unit)).T
        small = np.abs(dense) < cut * np.abs(dense).max(1, keepdims=True)
        lost[free[chosen]] = np.abs(np.where(small, dense, 0.0)).sum(1)
        row = csr_array(np.where(small, 0.0, dense)).tocoo()
        made.append(csr_array((row.data, (free[chosen][row.row], row.col)), shape=shape))
    whole = csr_array(sum(made[1:], start=made[0]))
    return csr_array(
        (whole.data, whole.indices.astype(np.int32), whole.indptr.astype(np.int32)), shape=shape
    ), lost


def _factorised(system: csc_array) -> SuperLU:
    """A positive definite system, ordered and factorised."""
    try:
        return splu(
            system, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError:
        raise SimCoreError(
            "constraints: the coarse vertices do not hold the sheet – give three not in line"
        ) from None


def _affine(matrix: csr_array, coarse: np.ndarray, fine: np.ndarray) -> tuple[csr_array, np.ndarray]:
    """The matrix with rows that are exact for affine maps, and the sum of changes in each (V,)."""
    matrix.sort_indices()
    row = np.repeat(np.arange(len(fine)), np.diff(matrix.indptr))
    about = np.column_stack([np.ones(len(row)), coarse[matrix.indices] - fine[row]])
    start, wanted = matrix.data.copy(), np.array([1.0, 0.0, 0.0])
    first = matrix.indptr[:-1]
    for _ in range(ONCE_MORE):
        size = np.abs(matrix.data)
        missing = wanted - np.add.reduceat(matrix.data[:, None] * about, first)
        moments = np.add.reduceat(size[:, None, None] * about[:, :, None] * about[:, None, :], first)
        multiplier = np.einsum("vij,vj->vi", np.linalg.pinv(moments, rcond=1e-12, hermitian=True), missing)
        matrix.data += size * (about * multiplier[row]).sum(1)
    missing = wanted - np.add.reduceat(matrix.data[:, None] * about, first)
    if np.abs(missing).max() > EXACT:
        raise SimCoreError(
            "constraints: the coarse vertices near a fine one lie in line – keep others, or cut less"
        )
    return matrix, np.add.reduceat(np.abs(matrix.data - start), first)
