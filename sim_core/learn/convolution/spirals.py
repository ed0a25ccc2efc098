"""Spiral sequences (Lim et al. 2018, in the order of SpiralNet++, Gong et al. 2019): a vertex, then ring after ring.

The paper fixes their length at L = 100 with "point filling", keeps the table in "sequential storage" and sets "the size
of storage table Rs to 50MB". L indices of 6,182 vertices take 2.5 MB, so the table that Rs bounds is read as the one of
gathered features, V x L x channels in single precision (20 channels at L = 100), row after row in memory.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from sim_core.errors import SimCoreError
from sim_core.learn.topology import checked_sheet, rings
from sim_core.validation import integer

__all__ = ["STORAGE", "check_storage", "spirals"]

STORAGE = 50_000_000  # bytes, Rs of the paper
SINGLE = 4  # bytes of a number
LONGEST = 10_000


def check_storage(vertices: int, length: int, channels: int) -> int:
    """Bytes of the gathered features of so many vertices, spirals of this length and single-precision channels.

    Raises SimCoreError where they are more than Rs.
    """
    size = SINGLE * vertices * length * channels
    if size > STORAGE:
        raise SimCoreError(
            f"spirals: {vertices} vertices x {length} x {channels} channels take {size / 1e6:.1f} MB – the table may "
            f"have {STORAGE / 1e6:g} MB (Rs); take shorter spirals, fewer channels or a pooled mesh"
        )
    return size


def spirals(faces: np.ndarray, count: int, rest: np.ndarray, *, channels: int = 1) -> np.ndarray:
    """The spiral of every vertex, (V, L) int32, row after row in memory.

    faces: (F, 3); count: L; rest: (V, 2) [m]. A row starts with its vertex and goes on with the rings, in the sense of
    the faces; the first ring from the neighbour nearest to the direction +x of the rest plane, each further one from
    the outermost neighbour of the first vertex of the ring within. Where the mesh ends the vertex itself fills the row.
    channels: for `check_storage`. Raises SimCoreError for a table above Rs.
    """
    rest, faces = checked_sheet(rest, faces)
    count = integer("count", count, 1, f"give a length of 1 to {LONGEST}", LONGEST)
    check_storage(len(rest), count, integer("channels", channels, 1, "give 1 channel or more"))
    return _spirals(*rings(faces, len(rest)), rest, count)


@njit(cache=True)
def _spirals(start, items, rest, length):
    vertices = len(start) - 1
    out = np.zeros((vertices, length), np.int32)
    seen, parent = np.full(vertices, -1, np.int64), np.zeros(vertices, np.int64)
    for v in range(vertices):
        out[v] = v
        seen[v], filled, at = v, 1, 0
        parent[v] = _towards_x(v, start, items, rest)
        while filled < length and at < filled:
            w = out[v, at]
            ring = items[start[w] : start[w + 1]]
            first = 0
            for k in range(len(ring)):
                if ring[k] == parent[w]:
                    first = k
            for k in range(len(ring)):
                n = ring[(first + k) % len(ring)]
                if seen[n] != v and filled < length:
                    seen[n], parent[n] = v, w
                    out[v, filled] = n
                    filled += 1
            at += 1
    return out


@njit(cache=True)
def _towards_x(v, start, items, rest):
    """The neighbour of v that lies nearest to the direction +x; of equals the first."""
    best, found = -2.0, -1
    for n in items[start[v] : start[v + 1]]:
        dx, dy = rest[n, 0] - rest[v, 0], rest[n, 1] - rest[v, 1]
        cosine = dx / max(np.sqrt(dx * dx + dy * dy), 1e-300)
        if cosine > best + 1e-12:
            best, found = cosine, n
    return found
