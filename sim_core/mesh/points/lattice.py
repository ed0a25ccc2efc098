"""Staggered points: the equilateral lattice of Eq. 1-8."""

import numpy as np

__all__ = ["lattice_points", "lattice_size", "staggered_points"]


def staggered_points(low: np.ndarray, high: np.ndarray, edge: float) -> np.ndarray:
    """Equilateral lattice over a rectangle, row by row from its upper left corner (y down).

    low, high: (2,) [m] corners with the least and largest coordinates; edge: [m] L.  Returns (n, 2) [m].
    Row i lies at y0 + i L sqrt(3)/2 (Eq. 8), column j at x0 + j L, moved by -L/2 in odd rows (Eq. 1-7). The paper
    prints the parity condition of Eq. 7 for the column j; its own Eq. 3 and 5 stagger the row, as done here.
    """
    rows, columns = lattice_size(low, high, edge)
    return lattice_points(low, edge, *np.divmod(np.arange(rows * columns), columns))


def lattice_size(low: np.ndarray, high: np.ndarray, edge: float) -> tuple[int, int]:
    """Rows and columns of `staggered_points`."""
    rows = int(np.floor((high[1] - low[1]) / (edge * np.sqrt(3) / 2))) + 1
    return rows, int(np.floor((high[0] - low[0]) / edge)) + 2


def lattice_points(low: np.ndarray, edge: float, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Points (n, 2) [m] of `staggered_points` in rows i and columns j (n,)."""
    x = low[0] + j * edge - (i % 2) * edge / 2
    y = low[1] + i * edge * np.sqrt(3) / 2
    return np.column_stack([x, y])
