"""A sparse matrix times the places of a sheet: of all that goes from coarse to fine, what is done most."""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy.sparse import csr_array

from sim_core.learn.topology import unsigned

__all__ = ["weighted_sums"]


def weighted_sums(matrix: csr_array, places: np.ndarray) -> np.ndarray:
    """matrix (V, C) @ places (C, 3), double: the same sums, bit by bit, in a fifth of scipy's time."""
    out = np.zeros((len(matrix.indptr) - 1, 3))
    start, columns = unsigned(matrix.indptr), unsigned(matrix.indices)
    _weighted_sums(start, columns, matrix.data, np.ascontiguousarray(places, float), out)
    return out


@njit(cache=True)
def _weighted_sums(start, columns, weights, places, out):
    for i in range(len(out)):
        x = y = z = 0.0
        for n in range(start[i], start[i + 1]):
            j, w = columns[n], weights[n]
            x, y, z = x + w * places[j, 0], y + w * places[j, 1], z + w * places[j, 2]
        out[i, 0], out[i, 1], out[i, 2] = x, y, z
