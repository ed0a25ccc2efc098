"""Growth triangulation (Eq. 9) with a front of open edges and a grid search: O(n) for evenly spread points.

The point C that minimises (AC^2 + BC^2 - AB^2) / (|AC| |BC|) = 2 cos C on the left of A -> B is the one whose circle
through A and B holds no other point on that side: the Delaunay triangle. Comparing two candidates by the exact
`incircle` test instead of by the cosine makes the choice free of rounding. Candidates on one circle are a tie; the
fan rule of `apex` settles it alike from whichever edge the circle is met (proof in the README). The paper's stop rule
"all points used" may leave holes: growth stops when the front is empty. Where points crowd into few cells, or walls
hide most of them, its searches grow with the number of points: past a bounded share `incremental.py` takes over.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.mesh.geometry.cells import Cells, point_cells
from sim_core.mesh.triangulation.apex import apex, block_boxes, strictly_delaunay
from sim_core.mesh.triangulation.incremental import hull_edges, inner_faces, joined_points
from sim_core.mesh.triangulation.walls import wall_cells

__all__ = ["CLOSED", "Growth", "grow_points"]

CLOSED, TOO_MANY, NO_APEX, TOO_LONG = 0, 1, 2, 3
PATIENCE = 400  # points and walls looked at, by the point: some 20 where points are spread evenly


class Growth(NamedTuple):
    """faces: (F, 3) int32 counter-clockwise with y up.  status: 0 closed, 1 endless front, 2 a seed without an apex.
    where: index of the point where it failed, or -1.  walls: number of seeds that are not Delaunay by themselves.
    work: points and walls that were looked at.  handed_over: whether `incremental.py` made the faces."""

    faces: np.ndarray
    status: int
    where: int
    walls: int
    work: int = 0
    handed_over: bool = False


def grow_points(points: np.ndarray, seeds: np.ndarray | None) -> Growth:
    """Triangulate points (n, 2) float64, y up; equal points count as one (the first of them).

    seeds: (m, 2) int, directed edges with the cloth on their left (a line inside the cloth is given in both
    directions), which cross nowhere; None starts from a nearest pair and grows to the convex hull. Where a seed is no
    Delaunay edge by itself it becomes a wall that no triangle reaches across (constrained Delaunay).
    """
    order, cells = point_cells(points)
    places = points[order]
    order, places, cells, rank = _without_equals(order, places, cells, seeds is not None)
    boxes = block_boxes(places, cells.start, cells.grid.columns, cells.grid.rows)
    spent, most = np.zeros(1, np.int64), PATIENCE * (len(places) + 64)
    walls = None
    if seeds is None:
        edges = _nearest_pair(places, cells, boxes)
    else:
        edges = rank[np.asarray(seeds, dtype=np.int64)]
        weak = ~strictly_delaunay(places, edges, *cells, boxes, spent, most)
        if weak.any() and spent[0] <= most:
            walls = wall_cells(places, edges[weak], cells, spent, most)
            spent += 0 if walls else most + 1
    count, faces, status, where = _grow(places, edges, seeds is not None, *cells, boxes, walls, spent, most)
    if status == TOO_LONG:
        return _handed_over(places, order, None if seeds is None else edges, int(spent[0]))
    found = order[faces[:count]]
    blame = int(order[where]) if where >= 0 else -1
    return Growth(found, int(status), blame, 0 if walls is None else len(walls.ends), int(spent[0]))


def _handed_over(places: np.ndarray, order: np.ndarray, edges: np.ndarray | None, work: int) -> Growth:
    """The same triangulation, up to how ties are cut, from `incremental.py`: whose time growth cannot lengthen."""
    edges = hull_edges(places) if edges is None else np.unique(edges, axis=0)
    flips, lost = joined_points(places, edges)
    if lost >= 0:
        return Growth(np.zeros((0, 3), np.int32), NO_APEX, int(order[lost]), 0, work, True)
    return Growth(order[inner_faces(flips)], CLOSED, -1, 0, work, True)


def _without_equals(
    order: np.ndarray, places: np.ndarray, cells: Cells, ranked: bool
) -> tuple[np.ndarray, np.ndarray, Cells, np.ndarray]:
    """Drop points equal to their neighbour in the order; rank (n,) int32 is every point's place in the order kept."""
    fresh = np.ones(len(order), dtype=bool)
    fresh[1:] = (places[1:] != places[:-1]).any(axis=1)
    rank = np.zeros(len(order) if ranked else 0, np.int32)
    if fresh.all():
        if ranked:
            rank[order] = np.arange(len(order), dtype=np.int32)
        return order, places, cells, rank
    kept = np.cumsum(fresh, dtype=np.int32)
    if ranked:
        rank[order] = kept - 1
    start = np.concatenate([np.zeros(1, np.int32), kept])[cells.start]
    return order[fresh], places[fresh], cells._replace(start=start), rank


def _nearest_pair(places: np.ndarray, cells: Cells, boxes: np.ndarray) -> np.ndarray:
    """Both directions of the edge from the first point to its nearest neighbour, which is a Delaunay edge always.

    Rounded distances leave a few candidates; the nearest of them has nothing else in its diametral circle.
    """
    if len(places) < 2:
        return np.zeros((0, 2), np.int32)
    square = ((places - places[0]) ** 2).sum(axis=1)
    square[0] = np.inf
    near = np.flatnonzero(square <= square.min() * (1 + 1e-12)).astype(np.int32)
    edges = np.column_stack([np.zeros_like(near), near])
    strict = strictly_delaunay(places, edges, *cells, boxes, np.zeros(1, np.int64), np.iinfo(np.int64).max)
    nearest = int(near[strict.argmax()])
    return np.array([[0, nearest], [nearest, 0]], dtype=np.int32)


@njit(cache=True, error_model="numpy")
def _grow(places, seeds, closed, start, grid, boxes, walls, spent, most):
    n = places.shape[0]
    limit = 2 * n + 8
    faces = np.zeros((limit, 3), np.int32)
    head = np.full(n, -1, np.int32)  # per point: a linked list of the open edges that leave it
    size = 2 * limit + seeds.shape[0] + 8
    origin, target, later = np.zeros(size, np.int32), np.zeros(size, np.int32), np.zeros(size, np.int32)
    top = 0  # the front is a stack: edges met last are grown first, which keeps the search in cached memory
    for k in range(seeds.shape[0] - 1, -1, -1):
        top = _open(head, origin, target, later, top, seeds[k, 0], seeds[k, 1])
    unsure = np.zeros(n, np.int32)
    count = 0
    if spent[0] > most:
        return count, faces, TOO_LONG, -1
    while top > 0:
        top -= 1
        a, b = origin[top], target[top]
        if not _close(head, target, later, a, b):
            continue
        c = apex(places, a, b, start, grid, boxes, walls, unsure, spent)
        if spent[0] > most:
            return count, faces, TOO_LONG, a
        if c < 0:
            if closed:
                return count, faces, NO_APEX, a
            continue
        if count == limit or top + 2 > size:
            return count, faces, TOO_MANY, a
        faces[count, 0], faces[count, 1], faces[count, 2] = a, b, c
        count += 1
        if not _close(head, target, later, b, c):
            top = _open(head, origin, target, later, top, c, b)
        if not _close(head, target, later, c, a):
            top = _open(head, origin, target, later, top, a, c)
    return count, faces, CLOSED, -1


@njit(cache=True, error_model="numpy")
def _open(head, origin, target, later, top, a, b):
    """Put the directed edge a -> b on the front, which needs a triangle on its left; returns the new top."""
    origin[top], target[top] = a, b
    later[top] = head[a]
    head[a] = top
    return top + 1


@njit(cache=True, error_model="numpy")
def _close(head, target, later, a, b):
    """Take a -> b off the front; False where it was not open."""
    before, edge = -1, head[a]
    while edge >= 0:
        if target[edge] == b:
            if before < 0:
                head[a] = later[edge]
            else:
                later[before] = later[edge]
            return True
        before, edge = edge, later[edge]
    return False
