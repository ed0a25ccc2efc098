"""Growth triangulation (Eq. 9) with a front of open edges and a grid search: O(n) for evenly spread points.

The point C that minimises (AC^2 + BC^2 - AB^2) / (|AC| |BC|) = 2 cos C on the left of A -> B is the one whose circle
through A and B holds no other point on that side: the Delaunay triangle. Comparing two candidates by the exact
`incircle` test instead of by the cosine makes the choice free of rounding. Candidates on one circle are a tie; the
fan rule (all of them become a fan from the one with the lowest index) settles it alike from whichever edge the
circle is met. The paper's stop rule "all points used" may leave holes: growth stops when the front is empty.
"""

import numpy as np
from numba import njit

from sim_core.mesh.exact import incircle, orient

__all__ = ["grow_snapped"]

OK, TOO_MANY, NO_APEX = 0, 1, 2


def grow_snapped(
    points: np.ndarray, seeds: np.ndarray | None, *, walls: bool = False
) -> tuple[np.ndarray, int, int]:
    """Triangulate snapped points.

    points: (n, 2) whole numbers in float64, y up, no two equal.  seeds: (m, 2) int, directed outline edges with the
    cloth on their left, or None to start from a nearest pair and grow to the convex hull.  walls: no triangle may
    reach across a seed (constrained Delaunay); slower, for outlines whose steps are not Delaunay edges by themselves.
    Returns faces (F, 3) int32 counter-clockwise, a status (0 done, 1 endless front, 2 seed without an apex) and the
    index of the point where it failed.
    """
    start, items, cell, columns, rows = _point_grid(points)
    closed = seeds is not None
    edges = _nearest_pair(points) if seeds is None else np.ascontiguousarray(seeds, dtype=np.int64)
    barrier = edges if walls and closed else edges[:0]
    count, faces, status, where = _grow(
        np.ascontiguousarray(points), edges, closed, barrier, start, items, cell, columns, rows
    )
    return faces[:count].astype(np.int32), int(status), int(where)


def _nearest_pair(points: np.ndarray) -> np.ndarray:
    """Both directions of the edge from point 0 to its nearest neighbour, which is a Delaunay edge always."""
    square = ((points - points[0]) ** 2).sum(axis=1)
    square[0] = np.inf
    nearest = int(square.argmin())
    return np.array([[0, nearest], [nearest, 0]], dtype=np.int64)


def _point_grid(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, float, int, int]:
    """Points sorted into square cells of about two points: start (cells + 1,), items (n,), cell size, columns, rows."""
    extent = np.maximum(points.max(axis=0), 1.0)
    cell = float(
        max(np.sqrt(2 * extent[0] * extent[1] / len(points)), extent.max() / (2 * len(points) + 2), 1.0)
    )
    columns, rows = int(extent[0] // cell) + 1, int(extent[1] // cell) + 1
    index = (points[:, 1] // cell).astype(np.int64) * columns + (points[:, 0] // cell).astype(np.int64)
    items = np.argsort(index, kind="stable")
    start = np.searchsorted(index[items], np.arange(columns * rows + 1))
    return start, items, cell, columns, rows


@njit(cache=True)
def _grow(points, seeds, closed, walls, start, items, cell, columns, rows):
    n = points.shape[0]
    limit = 2 * n + 8
    faces = np.zeros((limit, 3), np.int64)
    head = np.full(n, -1, np.int64)  # per point: a linked list of the open edges that leave it
    size = 2 * limit + seeds.shape[0] + 8
    origin, target, later = np.zeros(size, np.int64), np.zeros(size, np.int64), np.zeros(size, np.int64)
    top = 0  # the front is a stack: edges met last are grown first, which keeps the search in cached memory
    for k in range(seeds.shape[0] - 1, -1, -1):
        top = _open(head, origin, target, later, top, seeds[k, 0], seeds[k, 1])
    count = 0
    while top > 0:
        top -= 1
        a, b = origin[top], target[top]
        if not _close(head, target, later, a, b):
            continue
        c = _apex(points, a, b, walls, start, items, cell, columns, rows)
        if c < 0:
            if closed:
                return count, faces, NO_APEX, a
            continue
        if count == limit:
            return count, faces, TOO_MANY, a
        faces[count, 0], faces[count, 1], faces[count, 2] = a, b, c
        count += 1
        if not _close(head, target, later, b, c):
            top = _open(head, origin, target, later, top, c, b)
        if not _close(head, target, later, c, a):
            top = _open(head, origin, target, later, top, a, c)
    return count, faces, OK, -1


@njit(cache=True)
def _open(head, origin, target, later, top, a, b):
    """Put the directed edge a -> b on the front, which needs a triangle on its left; returns the new top."""
    origin[top], target[top] = a, b
    later[top] = head[a]
    head[a] = top
    return top + 1


@njit(cache=True)
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


@njit(cache=True)
def _apex(points, a, b, walls, start, items, cell, columns, rows):
    """The optimal point C left of a -> b (Eq. 9 with the fan rule), or -1 where no point lies there.

    Rings of cells around the expected centre; a ring beyond the circle of the best point so far cannot hold a better.
    """
    ax, ay, bx, by = points[a, 0], points[a, 1], points[b, 0], points[b, 1]
    qx, qy, column, row, margin = _search_start(ax, ay, bx, by, cell, columns, rows)
    best, lowest, near_a, near_b = -1, -1, -1, -1
    ox, oy, radius = 0.0, 0.0, np.inf
    for ring in range(max(columns, rows) + 1):
        reach = (ring - 1) * cell + margin
        if best >= 0 and reach > np.hypot(qx - ox, qy - oy) + radius:
            break
        for i in range(max(row - ring, 0), min(row + ring, rows - 1) + 1):
            step = 1 if abs(i - row) == ring else max(2 * ring, 1)
            for j in range(column - ring, column + ring + 1, step):
                if j < 0 or j >= columns or _beyond(i, j, cell, ox, oy, radius):
                    continue
                for k in range(start[i * columns + j], start[i * columns + j + 1]):
                    c = items[k]
                    cx, cy = points[c, 0], points[c, 1]
                    if c == a or c == b or orient(ax, ay, bx, by, cx, cy) <= 0:
                        continue
                    side = 1
                    if best >= 0:
                        side = incircle(ax, ay, bx, by, points[best, 0], points[best, 1], cx, cy)
                    if side >= 0 and _hidden(points, walls, a, b, c):
                        continue
                    if side > 0:
                        best, lowest, near_a, near_b = c, c, c, c
                        ox, oy, radius = _circle(ax, ay, bx, by, cx, cy)
                    elif side == 0:
                        lowest = min(lowest, c)
                        if orient(ax, ay, points[near_a, 0], points[near_a, 1], cx, cy) < 0:
                            near_a = c
                        if orient(bx, by, points[near_b, 0], points[near_b, 1], cx, cy) > 0:
                            near_b = c
    if best < 0 or lowest < min(a, b):
        return lowest
    return near_a if a < b else near_b


@njit(cache=True)
def _search_start(ax, ay, bx, by, cell, columns, rows):
    """Expected centre of the triangle on a -> b, its cell, and its distance from the cell's nearest side."""
    qx = (ax + bx) / 2 - (by - ay) * 0.29  # the centre of an equilateral triangle on a -> b
    qy = (ay + by) / 2 + (bx - ax) * 0.29
    qx, qy = min(max(qx, 0.0), columns * cell), min(max(qy, 0.0), rows * cell)
    column, row = min(int(qx // cell), columns - 1), min(int(qy // cell), rows - 1)
    margin = min(qx - column * cell, (column + 1) * cell - qx, qy - row * cell, (row + 1) * cell - qy)
    return qx, qy, column, row, margin


@njit(cache=True)
def _beyond(i, j, cell, ox, oy, radius):
    """Whether the cell in row i, column j lies wholly outside the circle (with a hair of room for rounding)."""
    if radius == np.inf:
        return False
    dx = max(j * cell - ox, 0.0, ox - (j + 1) * cell)
    dy = max(i * cell - oy, 0.0, oy - (i + 1) * cell)
    return dx * dx + dy * dy > radius * radius * (1 + 1e-9)


@njit(cache=True)
def _circle(ax, ay, bx, by, cx, cy):
    """Centre and radius of the circle through three points."""
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    double = 2 * (ux * vy - uy * vx)
    u, v = ux * ux + uy * uy, vx * vx + vy * vy
    dx, dy = (vy * u - uy * v) / double, (ux * v - vx * u) / double
    return ax + dx, ay + dy, np.hypot(dx, dy) * (1 + 1e-9)


@njit(cache=True)
def _hidden(points, walls, a, b, c):
    """Whether a wall keeps c from being joined to a or to b."""
    for k in range(walls.shape[0]):
        p, q = walls[k, 0], walls[k, 1]
        if _crosses(points, a, c, p, q) or _crosses(points, b, c, p, q):
            return True
    return False


@njit(cache=True)
def _crosses(points, a, c, p, q):
    """Whether the inside of a c meets the wall p q elsewhere than at shared points."""
    ax, ay, cx, cy = points[a, 0], points[a, 1], points[c, 0], points[c, 1]
    px, py, qx, qy = points[p, 0], points[p, 1], points[q, 0], points[q, 1]
    if max(px, qx) < min(ax, cx) or min(px, qx) > max(ax, cx):
        return False
    if max(py, qy) < min(ay, cy) or min(py, qy) > max(ay, cy):
        return False
    if p == a or p == c or q == a or q == c:
        return False
    s1, s2 = orient(ax, ay, cx, cy, px, py), orient(ax, ay, cx, cy, qx, qy)
    s3, s4 = orient(px, py, qx, qy, ax, ay), orient(px, py, qx, qy, cx, cy)
    apart = (s1 > 0 and s2 > 0) or (s1 < 0 and s2 < 0) or (s3 > 0 and s4 > 0) or (s3 < 0 and s4 < 0)
    return not apart
