"""Vertices, edges and faces put in an order in which neighbours lie at constant distances in memory.

On a regular patch of a mesh the edges of a row, counted along it, lead from vertex i + t to vertex j + t and are
coupled to edges a + t, b + t, …: a *run*, which the compiler turns into vector instructions on consecutive memory.
Where a mesh is irregular a run has one member; the loops are the same.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sim_core.cloth.sheet.sheet import Sheet
from sim_core.metrics import components

GROUP = 6  # neighbours that are handled in one go; an inner vertex of a regular mesh has as many


class Bands(NamedTuple):
    """Runs and their coefficients. V vertices, E edges, F faces of a sheet in band order; all indices uint64.

    A padded neighbour is the vertex itself, held by the edges E, E + 1, …: the tensions end in V zeros for them.
    """

    edge_runs: np.ndarray  # (R, 4) first edge, count, first vertices i and j
    tension_runs: np.ndarray  # (R, 6) first edge, count, the four edges it is coupled to
    length2: np.ndarray  # (E,) [m2]
    own: np.ndarray  # (E,) [N/m3], twice K: tension per strain
    coupling: np.ndarray  # (4, E), likewise
    vertex_runs: np.ndarray  # (R, 3 + 12) first vertex, count, 1 for a further group; 6 neighbours, 6 edges
    bend_runs: (
        np.ndarray
    )  # (R, 4 + 6) first vertex, count, first row of weights, 1 for a further group; 6 neighbours
    bend: np.ndarray  # (K, V) off-diagonal entries of the bending matrix, a row per place in the stencil
    face_runs: np.ndarray  # (R, 5) first face, count, first vertices a, b, c


def band_order(sheet: Sheet) -> np.ndarray:
    """The vertices (V,) panel by panel, each in rows across the warp."""
    panel = _panels(sheet)
    return np.lexsort((sheet.rest[:, 0], np.round(sheet.rest[:, 1], 7), panel))


def _panels(sheet: Sheet) -> np.ndarray:
    """A number per vertex, equal for all that lie in one pattern piece (faces joined by equal coordinates)."""
    corner = np.column_stack([sheet.faces.reshape(-1, 1), np.round(sheet.corner.reshape(-1, 2), 7)])
    _, name = np.unique(corner, axis=0, return_inverse=True)
    count = int(name.max()) + 1
    name = name.reshape(-1, 3)
    ends = np.concatenate([name[:, [0, 1]], name[:, [1, 2]]])
    piece = components(count, ends[:, 0], ends[:, 1])[name]
    panel = np.zeros(len(sheet.rest), np.int64)
    panel[sheet.faces.ravel()[::-1]] = piece.ravel()[::-1]
    return panel


def bands_of(sheet: Sheet) -> Bands:
    """The runs of a sheet whose vertices, edges and faces are in band order (see `ordered`)."""
    stencil = sheet.stencil
    count, edges = len(sheet.mass), stencil.edges.astype(np.int64)
    number = np.arange(len(edges))
    around, coupling = stencil.around.astype(np.int64), stencil.coupling
    by_place = np.argsort(around - number[:, None], axis=1, kind="stable")
    around = np.take_along_axis(around, by_place, 1)
    coupling = np.take_along_axis(coupling, by_place, 1)
    first, size = _runs(edges)
    edge_runs = np.column_stack([first, size, edges[first]])
    first, size = _runs(around)
    tension_runs = np.column_stack([first, size, around[first]])
    vertex_runs = _vertex_runs(stencil.rows, stencil.neighbour, stencil.edge_of, count, len(edges))
    bend_runs, bend = _bend_runs(stencil.rows, stencil.neighbour, stencil.bend, count)
    first, size = _runs(sheet.faces.astype(np.int64))
    face_runs = np.column_stack([first, size, sheet.faces[first]])
    return Bands(
        edge_runs=np.ascontiguousarray(edge_runs, np.uint64),
        tension_runs=np.ascontiguousarray(tension_runs, np.uint64),
        length2=stencil.length2,
        own=2.0 * stencil.own,
        coupling=np.ascontiguousarray(2.0 * coupling.T),
        vertex_runs=np.ascontiguousarray(vertex_runs, np.uint64),
        bend_runs=np.ascontiguousarray(bend_runs, np.uint64),
        bend=bend,
        face_runs=np.ascontiguousarray(face_runs, np.uint64),
    )


def _runs(index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First rows and sizes of the longest stretches in which every column of `index` (N, K) counts up by 1."""
    begins = np.ones(len(index), bool)
    begins[1:] = (np.diff(index, axis=0) != 1).any(1)
    first = np.flatnonzero(begins)
    return first, np.diff(np.r_[first, len(index)])


def _padded(rows: np.ndarray, values: np.ndarray, keep: np.ndarray, count: int, fill: int) -> np.ndarray:
    """Entries kept of each row, padded with `fill` to a multiple of GROUP: (count, K)."""
    row = np.repeat(np.arange(count), np.diff(rows))[keep]
    degree = np.bincount(row, minlength=count)
    place = np.arange(len(row)) - np.repeat(np.cumsum(degree) - degree, degree)
    width = max(1, -(-int(degree.max(initial=1)) // GROUP)) * GROUP
    out = np.full((count, width), fill, np.int64)
    out[row, place] = values[keep]
    return out


def _vertex_runs(
    rows: np.ndarray, neighbour: np.ndarray, edge_of: np.ndarray, count: int, edges: int
) -> np.ndarray:
    keep = edge_of >= 0
    other = _padded(rows, neighbour, keep, count, -1)
    edge = _padded(rows, edge_of, keep, count, edges)
    out = []
    for k in range(0, other.shape[1], GROUP):
        out += _grouped(other[:, k : k + GROUP], edge[:, k : k + GROUP], further=k > 0)
    return np.array(out, np.int64)


def _grouped(other: np.ndarray, edge: np.ndarray, *, further: bool) -> list[list[int]]:
    """Runs of vertices whose six neighbours and edges count up together; a padded one stays where it is."""
    used = other[:, 0] >= 0 if further else np.ones(len(other), bool)
    own = np.arange(len(other))
    pad = other < 0
    key = np.column_stack(
        [np.where(pad, 0, other - own[:, None]), np.where(pad, 0, edge - own[:, None]), pad]
    )
    begins = np.ones(len(other), bool)
    begins[1:] = (key[1:] != key[:-1]).any(1) | (used[1:] != used[:-1])
    out: list[list[int]] = []
    first = np.flatnonzero(begins)
    for a, b in zip(first, np.r_[first[1:], len(other)], strict=True):
        if used[a]:
            near = np.where(pad[a], a, other[a])
            out.append([int(a), int(b - a), int(further), *near.tolist(), *edge[a].tolist()])
    return out


def _bend_runs(
    rows: np.ndarray, neighbour: np.ndarray, bend: np.ndarray, count: int
) -> tuple[np.ndarray, np.ndarray]:
    keep = bend != 0.0
    other = _padded(rows, neighbour, keep, count, -1)
    place = _padded(rows, np.arange(len(bend)), keep, count, -1)
    weight = np.where(place < 0, 0.0, bend[place])
    own = np.arange(count)
    other = np.where(other < 0, own[:, None], other)
    out: list[list[int]] = []
    for k in range(0, other.shape[1], GROUP):
        used = (place[:, k] >= 0) | (k == 0)
        step = other[:, k : k + GROUP] - own[:, None]
        begins = np.ones(count, bool)
        begins[1:] = (step[1:] != step[:-1]).any(1) | (used[1:] != used[:-1])
        first = np.flatnonzero(begins)
        for a, b in zip(first, np.r_[first[1:], count], strict=True):
            if used[a]:
                out.append([int(a), int(b - a), k, int(k > 0), *other[a, k : k + GROUP].tolist()])
    return np.array(out, np.int64), np.ascontiguousarray(weight.T)


def ordered(sheet: Sheet) -> tuple[Sheet, np.ndarray]:
    """The sheet with its parts in band order, and the old number (V,) of each vertex."""
    order = band_order(sheet)
    new = np.zeros(len(order), np.int64)
    new[order] = np.arange(len(order))
    faces, turn = _turned(new[sheet.faces])
    by_face = np.lexsort((faces[:, 0], faces[:, 2] - faces[:, 0], faces[:, 1] - faces[:, 0]))
    corner = np.take_along_axis(sheet.corner, turn[:, :, None], 1)[by_face]
    side = np.take_along_axis(sheet.face_edges, turn, 1)[by_face]
    ends = np.sort(new[sheet.edges], axis=1)
    by_edge = np.lexsort((ends[:, 0], ends[:, 1] - ends[:, 0]))
    number = np.zeros(len(ends), np.int64)
    number[by_edge] = np.arange(len(ends))
    old, s = order, sheet.stencil
    row = np.repeat(new, np.diff(s.rows))
    by_row = np.lexsort((new[s.neighbour], row))
    edge_of = np.where(s.edge_of >= 0, number[s.edge_of], -1)
    rows = np.r_[0, np.cumsum(np.bincount(row, minlength=len(new)))]
    stencil = s._replace(
        inverse_mass=s.inverse_mass[old],
        edges=ends[by_edge].astype(np.int32),
        length2=s.length2[by_edge],
        own=s.own[by_edge],
        around=number[s.around][by_edge].astype(np.int32),
        coupling=s.coupling[by_edge],
        rows=rows.astype(np.int32),
        neighbour=new[s.neighbour][by_row].astype(np.int32),
        edge_of=edge_of[by_row].astype(np.int32),
        bend=s.bend[by_row],
    )
    found = Sheet(
        rest=sheet.rest[old],
        faces=faces[by_face].astype(np.int32),
        edges=stencil.edges,
        face_edges=number[side].astype(np.int32),
        mass=sheet.mass[old],
        material=sheet.material,
        stencil=stencil,
        corner=corner,
    )
    return found, order


def _turned(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Faces (F, 3) turned so that the smallest index comes first, and where each corner came from (F, 3)."""
    turn = (np.argmin(faces, axis=1)[:, None] + np.arange(3)) % 3
    return np.take_along_axis(faces, turn, 1), turn
