"""The runs of a lattice of rows, bridged over the rows' ends: a pass over the sheet is then one loop, not one a row.

In rows that are by turns one vertex longer and shorter every edge leads from vertex i to i + d with one of three
offsets d. Each offset gets a slot for *every* i: a slot without an edge is a ghost, whose coefficients are zero, so its
tension is zero and what it joins does not matter. Single precision only (`single.py`): a row of 75 vertices is nine
vectors and a remainder, which costs as much as the vectors do.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sim_core.cloth.bands import GROUP, Bands, bands_of
from sim_core.cloth.sheet import Sheet

OFFSETS = 3  # directions of the edges of a lattice of triangles
REAL = np.float32


class Lanes(NamedTuple):
    """Bands in single precision, and what does not fit the runs of bending: entries (N,) of odd_vertex (M,)."""

    bands: Bands
    edges: int  # slots, ghosts included
    further_runs: np.ndarray  # (R, 15) of `vertex_runs`: seventh and later neighbours
    odd_rows: np.ndarray  # (M + 1,) where the entries of each such vertex begin
    odd_vertex: np.ndarray
    odd_other: np.ndarray
    odd_weight: np.ndarray


def lanes_of(sheet: Sheet) -> Lanes:
    """The lanes of a sheet in band order: bridged where it is a lattice, else its bands as they are."""
    bands = bands_of(sheet)
    return _bridged(sheet, bands) or _plain(sheet, bands)


def _single(bands: Bands) -> Bands:
    return bands._replace(
        length2=bands.length2.astype(REAL),
        own=bands.own.astype(REAL),
        coupling=bands.coupling.astype(REAL),
        bend=bands.bend.astype(REAL),
    )


def _plain(sheet: Sheet, bands: Bands) -> Lanes:
    further = bands.vertex_runs[:, 2] > 0
    first = bands._replace(vertex_runs=np.ascontiguousarray(bands.vertex_runs[~further]))
    none = np.zeros(0, np.int64)
    rest = np.ascontiguousarray(bands.vertex_runs[further])
    return Lanes(_single(first), len(sheet.edges), rest, np.zeros(1, np.int64), none, none, np.zeros(0, REAL))


def _bridged(sheet: Sheet, bands: Bands) -> Lanes | None:
    """The lanes of a lattice; None if the sheet is none."""
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

    def spread(values: np.ndarray) -> np.ndarray:
        out = np.zeros((*values.shape[:-1], slots), REAL)
        out[..., slot] = values
        return out

    edge_runs = np.column_stack([begin, size, first, first + steps])
    bend, bend_runs, odd = _bends(sheet, count)
    made = bands._replace(
        edge_runs=np.ascontiguousarray(edge_runs, np.uint64),
        tension_runs=np.ascontiguousarray(np.column_stack([begin, size, reach]), np.uint64),
        length2=spread(bands.length2),
        own=spread(bands.own),
        coupling=spread(coupling.T),
        vertex_runs=_vertex_runs(steps, base, count),
        bend=bend,
        bend_runs=bend_runs,
    )
    return Lanes(made, slots, np.zeros((0, 15), np.uint64), *odd)


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


def _bends(
    sheet: Sheet, count: int
) -> tuple[np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]:
    """Weights (K, V) of the offsets that most vertices have, their runs, and the entries left over."""
    stencil = sheet.stencil
    vertex = np.repeat(np.arange(count), np.diff(stencil.rows))
    other, weight = stencil.neighbour.astype(np.int64), stencil.bend
    used = weight != 0.0
    vertex, other, weight = vertex[used], other[used], weight[used]
    steps, number, times = np.unique(other - vertex, return_inverse=True, return_counts=True)
    usual = np.flatnonzero(2 * times > count)
    place = np.full(len(steps), -1)
    place[usual] = np.arange(len(usual))
    width = max(1, -(-len(usual) // GROUP)) * GROUP
    rows = np.zeros((width, count), REAL)
    fits = place[number] >= 0
    rows[place[number][fits], vertex[fits]] = weight[fits]
    runs = []
    for k in range(0, width, GROUP):
        group = np.r_[steps[usual[k : k + GROUP]], np.zeros(max(0, k + GROUP - len(usual)), np.int64)]
        for a, b, inside in _segments(group[:GROUP], count):
            runs.append([a, b - a, k, int(k > 0), *np.where(inside, a + group[:GROUP], a).tolist()])
    owner, starts = np.unique(vertex[~fits], return_index=True)
    odd = np.r_[starts, (~fits).sum()], owner, other[~fits], weight[~fits].astype(REAL)
    return rows, np.array(runs, np.uint64), odd
