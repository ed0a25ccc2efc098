"""What hangs together: the connected components of a graph."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

__all__ = ["components"]


def components(count: int, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The component (count,) int32 of each of so many things, in order of their first; first, second (K,): pairs that
    hang together."""
    graph = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    return connected_components(graph, directed=False)[1]
