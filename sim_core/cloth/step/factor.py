"""A symmetric positive matrix factored once and solved for three right-hand sides at a time."""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy import sparse
from scipy.sparse.linalg import splu


@njit(cache=True, error_model="numpy")
def _solved(starts, rows, values, diagonal, b):
    """L D L^T x = b in place; L (unit, by columns, without its diagonal), b (N, 3)."""
    count = len(diagonal)
    for j in range(count):
        x, y, z = b[j, 0], b[j, 1], b[j, 2]
        for p in range(starts[j], starts[j + 1]):
            i, w = rows[p], values[p]
            b[i, 0] -= w * x
            b[i, 1] -= w * y
            b[i, 2] -= w * z
    for j in range(count - 1, -1, -1):
        d = diagonal[j]
        x, y, z = b[j, 0] * d, b[j, 1] * d, b[j, 2] * d
        for p in range(starts[j], starts[j + 1]):
            i, w = rows[p], values[p]
            x -= w * b[i, 0]
            y -= w * b[i, 1]
            z -= w * b[i, 2]
        b[j, 0], b[j, 1], b[j, 2] = x, y, z


class Factored:
    """L D L^T of a symmetric positive definite matrix (N, N), its rows in an order that fills in little."""

    def __init__(self, matrix: sparse.csc_array) -> None:
        # SuperLU finds the order and the factors; with its pivots on the diagonal U is D L^T.
        found = splu(
            matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
        if not np.array_equal(found.perm_r, found.perm_c):
            raise ValueError("the matrix is not symmetric positive definite: SuperLU left the diagonal")
        lower = sparse.tril(found.L, -1).tocsc()
        lower.sort_indices()
        self.place = np.asarray(found.perm_c, np.int64)
        self.order = np.argsort(self.place)
        self.starts, self.rows = lower.indptr.astype(np.int64), lower.indices.astype(np.int32)
        self.values, self.diagonal = lower.data, 1.0 / found.U.diagonal()

    def solve(self, b: np.ndarray) -> np.ndarray:
        """x (N, 3) of A x = b (N, 3)."""
        out = np.ascontiguousarray(b[self.order])
        _solved(self.starts, self.rows, self.values, self.diagonal, out)
        return out[self.place]
