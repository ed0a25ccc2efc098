"""What holds a cloth beside solids: sewing pairs, bounds across the middle, the other half as an image, its lengths.

A dressed cloth is simulated softer than it is, as soft as its own weight allows without being seen. Where that weight
hangs on a few threads (a neckline on sloping shoulders) or solids squeeze it (an armpit) it would give far more than
cloth does: past a small strain the crimp is gone and the yarns themselves would have to stretch. `keep_lengths` is
that end of the stress-strain curve: a limit on the length of edges (Provot 1995), which costs the time step nothing.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.errors import SimCoreError
from sim_core.validation import coordinates, excerpt, integer, numeric_array, vector, vertex_pairs

FARTHEST = 5e-6  # [m] that an edge is shortened or lengthened by in a substep: quicker, it would go through other cloth


class Holds(NamedTuple):
    """The arrays the compiled loops read; all may be empty. V vertices.

    pairs (K, 2) int32 are drawn together from their spans (K,) [m] to their ends (K,) [m]; same (V,) int32 gives both
    ends of a pair one number; low, high (V,) [m] bound x (all or none); slaves (M, 2) int32: vertex and the one it
    mirrors in x = 0.
    limit: the shares of its length at rest by which an edge may be shorter, and longer, before it is held; 1: any.
    """

    pairs: np.ndarray
    spans: np.ndarray
    ends: np.ndarray
    same: np.ndarray
    low: np.ndarray
    high: np.ndarray
    slaves: np.ndarray
    limit: tuple[float, float]

    @staticmethod
    def of(
        count: int,
        *,
        pairs: np.ndarray | None = None,
        positions: np.ndarray | None = None,
        ends: np.ndarray | None = None,
        low: np.ndarray | None = None,
        high: np.ndarray | None = None,
        slaves: np.ndarray | None = None,
        limit: tuple[float, float] = (1.0, 1.0),
    ) -> Holds:
        """Holds of a sheet of `count` vertices; spans of the pairs are taken from positions (V, 3) [m].

        ends (K,) [m]: how far apart the pairs stay in the end, 0 for what is sewn (None: all of them).
        Raises SimCoreError for indices out of range, bounds that leave no room and a limit that is no share.
        """
        count = integer("holds: count", count, 1, "vertices of the sheet, 1 or more")
        what = "two shares of an edge's length, above 0 and at most 1"
        shorter, longer = vector("holds.limit", limit, what, 2, least=1e-300, most=1.0)
        none = np.zeros((0, 2), np.int32)
        pairs = none if pairs is None else vertex_pairs("holds.pairs", pairs, count)
        slaves = none if slaves is None else vertex_pairs("holds.slaves", slaves, count)
        spans = np.zeros(len(pairs))
        if len(pairs):
            if positions is None:
                raise SimCoreError("holds: pairs need positions – give where the sheet starts")
            positions = coordinates("holds: positions", positions, (count, 3))
            spans = np.linalg.norm(positions[pairs[:, 0]] - positions[pairs[:, 1]], axis=1)
        apart = _bound("ends", ends, 0.0, len(pairs)) if len(pairs) else np.zeros(0)
        if (apart < 0).any():
            raise SimCoreError("holds.ends: below 0 – a pair is 0 m apart or more")
        spans = np.maximum(spans, apart)
        if low is None and high is None:
            low = high = np.zeros(0)
        else:
            low = _bound("low", low, -np.inf, count)
            high = _bound("high", high, np.inf, count)
            if (low > high).any():
                wrong = np.flatnonzero(low > high)[0]
                raise SimCoreError(f"holds.low: vertex {wrong} has no room – low <= high is needed")
        same = np.arange(count, dtype=np.int32)
        for a, b in pairs:  # chains of pairs count as one point, too
            same[same == same[b]] = same[a]
        return Holds(pairs, spans, apart, same, low, high, slaves, (shorter, longer))

    def renumbered(self, number: np.ndarray, order: np.ndarray) -> Holds:
        """The same holds for vertices of which i is now called number[i]; order (V,) is the way back."""
        moved = [number[a].astype(np.int32) for a in (self.pairs, self.same[order], self.slaves)]
        low, high = (a[order] if len(a) else a for a in (self.low, self.high))
        return Holds(moved[0], self.spans, self.ends, moved[1], low, high, moved[2], self.limit)


def _bound(name: str, value: np.ndarray | None, free: float, count: int) -> np.ndarray:
    """A bound (V,) [m] for each vertex, `free` where there is none; raises SimCoreError for NaN and other lengths."""
    if value is None:
        return np.full(count, free)
    what = f"expected one bound for each of {count} vertices, not NaN; -inf or inf: none"
    array = numeric_array(f"holds.{name}", value, what)
    if array.shape != (count,) or np.isnan(array).any():
        raise SimCoreError(f"holds.{name}: {excerpt(value)} – {what}")
    return np.ascontiguousarray(array, float)


@njit(cache=True, error_model="numpy")
def _bring_together(x, v, i, j, shares, along, way, speed):
    """i and j come nearer along the unit vector from j to i, by way [m] and at a speed [m/s] that they share."""
    a, b = shares
    for c in range(3):
        n = along[c]
        x[i, c] -= a * way * n
        x[j, c] += b * way * n
        v[i, c] -= a * speed * n
        v[j, c] += b * speed * n


@njit(cache=True, error_model="numpy")
def draw_together(holds, inverse_mass, x, v, share, rate):
    """No pair is further apart than `share` of the way from its end to its span.

    What is gets the speed of closing, rate * (span - end) [m/s].
    """
    for k in range(len(holds.pairs)):
        i, j = holds.pairs[k]
        way = holds.spans[k] - holds.ends[k]
        limit = holds.ends[k] + share * way
        dx, dy, dz = x[i, 0] - x[j, 0], x[i, 1] - x[j, 1], x[i, 2] - x[j, 2]
        gap = math.sqrt(dx * dx + dy * dy + dz * dz)
        total = inverse_mass[i] + inverse_mass[j]
        if gap <= limit or total == 0.0:
            continue
        a, b = inverse_mass[i] / total, inverse_mass[j] / total
        if limit <= 0.0:  # held together: one point, one velocity
            for c in range(3):
                mid, mean = b * x[i, c] + a * x[j, c], b * v[i, c] + a * v[j, c]
                x[i, c], x[j, c], v[i, c], v[j, c] = mid, mid, mean, mean
            continue
        nx, ny, nz = dx / gap, dy / gap, dz / gap
        push = gap - limit
        apart = (v[i, 0] - v[j, 0]) * nx + (v[i, 1] - v[j, 1]) * ny + (v[i, 2] - v[j, 2]) * nz
        excess = max(apart + rate * way, 0.0)
        _bring_together(x, v, i, j, (a, b), (nx, ny, nz), push, excess)


@njit(cache=True, error_model="numpy")
def keep_lengths(limit, inverse_mass, edges, length2, strain, x, v):
    """Brings edges (E, 2) back that are shorter or longer than their length at rest by more than `limit` of it.

    length2 (E,) [m2]: squared, at rest; strain (E,) [m2]: what the square was longer by a step ago. Ends share the
    way by their masses; the speed that leads on is taken away.
    """
    shorter, longer = limit
    over, under = (1.0 + longer) ** 2 - 1.0, (1.0 - shorter) ** 2 - 1.0
    if longer >= 1.0:
        over = np.inf
    for e in range(len(edges)):
        if under * length2[e] <= strain[e] <= over * length2[e]:
            continue
        i, j = edges[e]
        total = inverse_mass[i] + inverse_mass[j]
        dx, dy, dz = x[i, 0] - x[j, 0], x[i, 1] - x[j, 1], x[i, 2] - x[j, 2]
        size, rest = math.sqrt(dx * dx + dy * dy + dz * dz), math.sqrt(length2[e])
        excess = size - min(max(size, (1.0 - shorter) * rest), (1.0 + longer) * rest)
        if excess == 0.0 or total == 0.0 or size == 0.0:
            continue
        nx, ny, nz = dx / size, dy / size, dz / size
        apart = (v[i, 0] - v[j, 0]) * nx + (v[i, 1] - v[j, 1]) * ny + (v[i, 2] - v[j, 2]) * nz
        if apart * excess < 0.0:
            apart = 0.0
        a, b = inverse_mass[i] / total, inverse_mass[j] / total
        way = min(max(excess, -FARTHEST), FARTHEST)
        _bring_together(x, v, i, j, (a, b), (nx, ny, nz), way, apart)


@njit(cache=True, error_model="numpy")
def bound(holds, x, v):
    """Keeps x[:, 0] between the bounds; a vertex on one loses its speed across it."""
    for i in range(len(holds.low)):
        if x[i, 0] < holds.low[i]:
            x[i, 0] = holds.low[i]
            v[i, 0] = max(v[i, 0], 0.0)
        if x[i, 0] > holds.high[i]:
            x[i, 0] = holds.high[i]
            v[i, 0] = min(v[i, 0], 0.0)
        if holds.low[i] == holds.high[i]:
            v[i, 0] = 0.0


@njit(cache=True, error_model="numpy")
def mirror(holds, x, v):
    """Puts every slave where the mirror image of its master is."""
    for k in range(len(holds.slaves)):
        i, j = holds.slaves[k]
        x[i, 0], x[i, 1], x[i, 2] = -x[j, 0], x[j, 1], x[j, 2]
        v[i, 0], v[i, 1], v[i, 2] = -v[j, 0], v[j, 1], v[j, 2]
