"""Lanes: the runs of a lattice of rows, bridged over the rows' ends, with coefficients that repeat in short tables.

In rows that are by turns one vertex longer and shorter every edge leads from vertex i to i + d with one of three
offsets d. Each offset gets a slot for *every* i: a slot without an edge is a ghost, whose coefficients are zero, so its
tension is zero and what it joins does not matter. A pass over the sheet is then one long loop an offset, not one a row:
a row of 75 vertices is nine vectors and a remainder, which costs as much as the vectors do. And every other row is the
same again: the coefficients of a few rows are kept, small enough for the nearest cache, not those of the whole sheet.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.kernels.bands import GROUP, Bands

OFFSETS = 3  # directions of the edges of a lattice of triangles
TABLE_BYTES = 4096  # of a coefficient that repeats: with five others it stays in the nearest cache
SAME = 1e-10  # of the largest coefficient: what differs by less is rounding of the pattern's coordinates


class Odd(NamedTuple):
    """Entries of the bending matrix one by one."""

    rows: np.ndarray  # (M + 1,) where those of each vertex begin
    vertex: np.ndarray  # (M,)
    other: np.ndarray  # (N,)
    weight: np.ndarray  # (N,) [N/m]


class Lanes(NamedTuple):
    """Bands whose runs name where their coefficients begin, and what does not fit the runs of bending.

    Runs of edges, tensions and bending end in a further column, their first coefficient.
    """

    bands: Bands
    edges: int  # slots, ghosts included
    further_runs: np.ndarray  # (R, 15) of `vertex_runs`: seventh and later neighbours
    odd: Odd


def lattice_lanes(sheet: Sheet, bands: Bands, real: type = np.float64) -> Lanes | None:
    """The lanes of a sheet in band order that is a lattice of rows, of numbers `real`; None if it is none.

    bands: of this sheet.
    """
    count = len(sheet.mass)
    ends = sheet.edges.astype(np.int64)
    steps, kind = np.unique(ends[:, 1] - ends[:, 0], return_inverse=True)
    if len(steps) != OFFSETS or len(ends) < 2.5 * count:
        return None
    base = np.cumsum(np.r_[0, steps[:-1] + count]) + steps
    slots = int(base[-1]) + count
    slot = base[kind] + ends[:, 0]
    first = np.array([ends[kind == k, 0].min() for k in range(OFFSETS)])
    size = np.array([ends[kind == k, 0].max() for k in range(OFFSETS)]) + 1 - first
    coupled = _couplings(sheet, kind, slot)
    if coupled is None:
        return None
    near, coupling = coupled
    begin = base + first
    reach = begin[:, None] + near
    if reach.min() < 0 or (reach + size[:, None]).max() > slots:
        return None
    stencil, folds = sheet.stencil, Folds(int(steps[1] + steps[2]), real)
    spread = np.zeros((6, slots))
    spread[:, slot] = np.vstack([stencil.length2, 2.0 * stencil.own, coupling.T])
    edge_runs, tension_runs, table = [], [], 0
    tables = []
    for k in range(OFFSETS):
        span = slice(begin[k], begin[k] + size[k])
        kept, places = folds.of(spread[:, span], int(first[k]))
        for t, length, place in places:
            edge_runs.append([begin[k] + t, length, first[k] + t, first[k] + steps[k] + t, table + place])
            tension_runs.append([begin[k] + t, length, *(reach[k] + t), table + place])
        tables.append(kept)
        table += kept.shape[1]
    coefficients = np.ascontiguousarray(np.concatenate(tables, axis=1), real)
    bend, bend_runs, odd = _bends(sheet, count, folds)
    made = bands._replace(
        edge_runs=np.array(edge_runs, np.uint64),
        tension_runs=np.array(tension_runs, np.uint64),
        length2=coefficients[0],
        own=coefficients[1],
        coupling=coefficients[2:],
        vertex_runs=_vertex_runs(steps, base, count),
        bend=bend,
        bend_runs=bend_runs,
    )
    return Lanes(made, slots, np.zeros((0, 15), np.uint64), odd)


def plain_lanes(bands: Bands, real: type = np.float32) -> Lanes:
    """The bands of any sheet as lanes, of numbers `real`."""
    further = bands.vertex_runs[:, 2] > 0
    first = bands._replace(
        edge_runs=_own_coefficients(bands.edge_runs),
        tension_runs=_own_coefficients(bands.tension_runs),
        bend_runs=_own_coefficients(bands.bend_runs),
        vertex_runs=np.ascontiguousarray(bands.vertex_runs[~further]),
        length2=bands.length2.astype(real),
        own=bands.own.astype(real),
        coupling=bands.coupling.astype(real),
        bend=bands.bend.astype(real),
    )
    none = np.zeros(0, np.int64)
    rest = np.ascontiguousarray(bands.vertex_runs[further])
    odd = Odd(rows=np.zeros(1, np.int64), vertex=none, other=none, weight=np.zeros(0, real))
    return Lanes(first, len(bands.own), rest, odd)


def _own_coefficients(runs: np.ndarray) -> np.ndarray:
    """The runs with coefficients of their own for every member."""
    return np.ascontiguousarray(np.column_stack([runs, runs[:, 0]]), np.uint64)


class Folds:
    """Tables of coefficients that repeat every `period` vertices, but at the ends of the sheet."""

    def __init__(self, period: int, real: type) -> None:
        self.period, self.real = period, real
        self.length = period * max(1, TABLE_BYTES // (period * np.dtype(real).itemsize))

    def of(self, values: np.ndarray, first: int) -> tuple[np.ndarray, list[tuple[int, int, int]]]:
        """What is kept of values (K, N), those of vertices first, first + 1, …, and the stretches that it serves.

        A stretch is (first value, count, column of what is kept). Vertices are cut where a period begins.
        """
        count, period = values.shape[1], self.period
        close = SAME * np.abs(values).max(axis=1, initial=0.0)[:, None]
        kept: list[np.ndarray] = []
        known: list[tuple[int, int, int]] = []  # of what is kept: first value, count, column
        places, width = [], 0
        for a, b in self._cut(first, first + count):
            part = values[:, a - first : b - first]
            place = next(
                (
                    column
                    for begin, size, column in known
                    if size >= b - a
                    and (a - first - begin) % period == 0
                    and (np.abs(values[:, begin : begin + b - a] - part) <= close).all()
                ),
                None,
            )
            if place is None:
                place = width
                known.append((a - first, b - a, width))
                kept.append(part)
                width += b - a
            places.append((a - first, b - a, place))
        return np.concatenate(kept, axis=1), places

    def _cut(self, first: int, end: int) -> Sequence[tuple[int, int]]:
        """Stretches of vertices: some rows at the top, blocks of one length, and some rows at the bottom."""
        margin = 3 * self.period
        top = min(end, -(-first // self.period) * self.period + margin)
        bottom = max(top, (end - margin) // self.period * self.period)
        cuts = sorted({first, *range(top, bottom, self.length), bottom, end})
        return list(zip(cuts[:-1], cuts[1:], strict=True))


def _couplings(sheet: Sheet, kind: np.ndarray, slot: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Per offset the four slots an edge is coupled to, from its own (3, 4), and the coefficients (E, 4) in that order.

    None where an edge has a fifth.
    """
    around, coupling = slot[sheet.stencil.around], 2.0 * sheet.stencil.coupling
    near, out = np.zeros((OFFSETS, 4), np.int64), np.zeros_like(coupling)
    for k in range(OFFSETS):
        mine = np.flatnonzero(kind == k)
        there, weight = around[mine] - slot[mine, None], coupling[mine]
        found = np.unique(there[weight != 0.0])
        if len(found) > 4:
            return None
        near[k, : len(found)] = found
        place = np.searchsorted(found, there)
        rows = np.broadcast_to(mine[:, None], place.shape)
        used = weight != 0.0
        np.add.at(out, (rows[used], place[used]), weight[used])
    return near, out


def _segments(steps: np.ndarray, count: int) -> list[tuple[int, int, np.ndarray]]:
    """Stretches (first, end) of vertices and which of the offsets `steps` stay within the sheet there."""
    cuts = np.clip(np.r_[0, -steps[steps < 0], count - steps[steps > 0], count], 0, count)
    cuts = np.unique(cuts)
    return [
        (int(a), int(b), (a + steps >= 0) & (b - 1 + steps < count))
        for a, b in zip(cuts[:-1], cuts[1:], strict=True)
    ]


def _vertex_runs(steps: np.ndarray, base: np.ndarray, count: int) -> np.ndarray:
    """Runs of vertices with six neighbours each; one beyond the sheet is the vertex itself, its edge a ghost."""
    around = np.r_[-steps[::-1], steps]
    edge = np.r_[(base - steps)[::-1], base]
    out = [
        [a, b - a, 0, *np.where(inside, a + around, a).tolist(), *(edge + a).tolist()]
        for a, b, inside in _segments(around, count)
    ]
    return np.array(out, np.uint64)


def _bends(sheet: Sheet, count: int, folds: Folds) -> tuple[np.ndarray, np.ndarray, Odd]:
    """Weights of the offsets that most vertices have, GROUP rows of a table each, their runs, and what is left over."""
    stencil, real = sheet.stencil, folds.real
    vertex = np.repeat(np.arange(count), np.diff(stencil.rows))
    other, weight = stencil.neighbour.astype(np.int64), stencil.bend
    used = weight != 0.0
    vertex, other, weight = vertex[used], other[used], weight[used]
    steps, number, times = np.unique(other - vertex, return_inverse=True, return_counts=True)
    usual = np.flatnonzero(2 * times > count)
    place = np.full(len(steps), -1)
    place[usual] = np.arange(len(usual))
    width = max(1, -(-len(usual) // GROUP)) * GROUP
    rows = np.zeros((width, count))
    fits = place[number] >= 0
    rows[place[number][fits], vertex[fits]] = weight[fits]
    runs, tables = [], []
    for k in range(0, width, GROUP):
        group = np.r_[steps[usual[k : k + GROUP]], np.zeros(max(0, k + GROUP - len(usual)), np.int64)][:GROUP]
        kept, places = folds.of(rows[k : k + GROUP], 0)
        for a, b, inside in _segments(group, count):
            near = np.where(inside, group, 0)
            for t, length, column in places:
                low, high = max(a, t), min(b, t + length)
                if low < high:
                    runs.append([low, high - low, k, int(k > 0), *(low + near), column + low - t])
        tables.append(kept)
    bend = np.zeros((width, max(kept.shape[1] for kept in tables)), real)
    for k, kept in enumerate(tables):
        bend[k * GROUP : (k + 1) * GROUP, : kept.shape[1]] = kept
    owner, starts = np.unique(vertex[~fits], return_index=True)
    odd = Odd(np.r_[starts, (~fits).sum()], owner, other[~fits], weight[~fits].astype(real))
    return bend, np.array(runs, np.uint64), odd
