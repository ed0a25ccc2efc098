"""The search of growth: the optimal point on the left of an edge (Eq. 9), exact, with the fan rule for ties.

Squares of cells around the expected place widen until a point is found; its circle bounds what can still be better,
and only the cells under that circle are searched on. Cells of one row are one stretch of memory. Where the circle is
wide (hull edges, long thin triangles) blocks of 8 x 8 cells are skipped whole.
"""

import numpy as np
from numba import njit

from sim_core.mesh.geometry.cells import cell_of
from sim_core.mesh.geometry.predicates import INCIRCLE_BOUND, ORIENT_BOUND, incircle, orient
from sim_core.mesh.triangulation.walls import hidden

__all__ = ["apex", "block_boxes", "strictly_delaunay"]

BLOCK = 8
WIDEST = 8  # cells around the expected place that are searched before blocks are
FLAT = 1e-7  # share of cancellation in a triangle's area below which its circle is not trusted as a bound


@njit(cache=True, error_model="numpy")
def apex(places, a, b, start, grid, boxes, walls, unsure, spent):
    """The optimal point C left of a -> b (Eq. 9 with the fan rule), or -1 where no point lies there.

    places: (n, 2) in growth order, sorted into the cells of `grid`, each from `start` on.  boxes: `block_boxes`.
    walls: `Walls` or None.  unsure: (n,) int32, room for points that rounding cannot tell from the circle of the best
    so far; most of them are settled by a better point, the rest exactly in the end.  spent: (1,) int64, points looked
    at, counted on.
    Fan rule: points on one circle become a fan from the one that comes first in growth order. If that is not an end
    of the edge, take it; if it is, take the neighbour of the edge's other end along the circle.

    One long function on purpose: the search lives in registers, and passing it between functions costs twice its time.
    """
    x0, y0, per_metre, columns, rows = grid
    ax, ay, bx, by = places[a, 0], places[a, 1], places[b, 0], places[b, 1]
    ux, uy = bx - ax, by - ay
    us = ux * ux + uy * uy
    alpha, beta, gamma, size_x, size_y, size_s = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    best, waiting = -1, 0
    c0, c1, r0, r1 = 0, columns - 1, 0, rows - 1  # the cells that may hold a better point
    column = cell_of(ax + 0.5 * ux - 0.866 * uy, x0, per_metre, columns)
    row = cell_of(ay + 0.5 * uy + 0.866 * ux, y0, per_metre, rows)
    reach, blocks, block, final = 0, False, 0, False
    left, right, i, last = column, column, row, row
    work = 0
    while True:
        if i > last:
            if blocks:
                # next block that is not wholly right of the edge and lies under the circle
                wide = boxes.shape[1]
                while block < wide * boxes.shape[0]:
                    if block // wide > r1 // BLOCK:
                        block = wide * boxes.shape[0]
                        break
                    m, n = block // wide, block % wide
                    block += 1
                    if m < r0 // BLOCK:
                        block = (r0 // BLOCK) * wide
                        continue
                    work += 1
                    if n * BLOCK > c1 or n * BLOCK + BLOCK <= c0 or _right_of(boxes[m, n], ax, ay, ux, uy):
                        continue
                    left, right = max(c0, n * BLOCK), min(c1, n * BLOCK + BLOCK - 1)
                    i, last = max(r0, m * BLOCK), min(r1, m * BLOCK + BLOCK - 1)
                    break
                if i > last:
                    break
            elif final or (
                row - reach <= r0 and r1 <= row + reach and column - reach <= c0 and c1 <= column + reach
            ):
                break
            elif best >= 0 and (c1 - c0 + 1) * (r1 - r0 + 1) <= 4 * (2 * reach + 3) ** 2:
                final = True
                left, right, i, last = c0, c1, r0, r1
            elif reach < WIDEST:
                reach = max(1, 2 * reach)
                left, right = max(column - reach, 0), min(column + reach, columns - 1)
                i, last = max(row - reach, 0), min(row + reach, rows - 1)
            else:
                blocks, waiting = True, 0
                continue
            if not blocks:
                waiting = 0  # the new stretch holds all that may still be better
        work += 1 + start[i * columns + right + 1] - start[i * columns + left]
        for k in range(start[i * columns + left], start[i * columns + right + 1]):
            wx, wy = places[k, 0] - ax, places[k, 1] - ay
            p, q = ux * wy, uy * wx
            area = p - q
            sure = ORIENT_BOUND * (abs(p) + abs(q))
            if area <= sure:
                if area < -sure or k == a or k == b:
                    continue
                if orient(ax, ay, bx, by, places[k, 0], places[k, 1]) <= 0:
                    continue
            ws = wx * wx + wy * wy
            if best >= 0:
                total = alpha * wx + beta * wy + gamma * ws
                bound = INCIRCLE_BOUND * (size_x * abs(wx) + size_y * abs(wy) + size_s * ws)
                if total >= -bound:
                    if total <= bound and k != best:
                        unsure[waiting] = k
                        waiting += 1
                    continue
            if walls is not None:
                if hidden(places, a, b, k, grid, walls):
                    continue
            best = k
            # The circle through a, b and k, seen from a: inside it alpha x + beta y + gamma (x x + y y) < 0.
            alpha, beta, gamma = uy * ws - wy * us, wx * us - ux * ws, area
            size_x, size_y = abs(uy) * ws + abs(wy) * us, abs(wx) * us + abs(ux) * ws
            size_s = abs(p) + abs(q)
            if gamma > FLAT * size_s:
                half = 0.5 / gamma
                ox, oy = -alpha * half, -beta * half
                radius = np.sqrt(ox * ox + oy * oy)
                radius += 1e-7 * radius + 1e-14 * (size_x + size_y) * half
                ox, oy = ox + ax, oy + ay
                c0 = cell_of(ox - radius, x0, per_metre, columns)
                c1 = cell_of(ox + radius, x0, per_metre, columns)
                r0 = cell_of(oy - radius, y0, per_metre, rows)
                r1 = cell_of(oy + radius, y0, per_metre, rows)
                last = min(last, r1)
                if final:
                    left, right = max(left, c0), min(right, c1)
        i += 1
    spent[0] += work + waiting
    if waiting == 0:
        return best
    return _settled(places, a, b, best, unsure, waiting, grid, walls)


@njit(cache=True, error_model="numpy")
def _settled(places, a, b, best, unsure, waiting, grid, walls):
    """The optimal point among `best` and those that rounding could not tell from its circle; ties by the fan rule."""
    ax, ay, bx, by = places[a, 0], places[a, 1], places[b, 0], places[b, 1]
    lowest, near_a, near_b = best, best, best
    for m in range(waiting):
        k = unsure[m]
        side = incircle(ax, ay, bx, by, places[best, 0], places[best, 1], places[k, 0], places[k, 1])
        if side < 0 or k == best:
            continue
        if walls is not None:
            if hidden(places, a, b, k, grid, walls):
                continue
        if side > 0:
            best, lowest, near_a, near_b = k, k, k, k
        else:
            lowest = min(lowest, k)
            near_a, near_b = _nearer(places, a, b, k, near_a, near_b)
    if lowest < min(a, b):
        return lowest
    return near_a if a < b else near_b


@njit(cache=True, error_model="numpy")
def _nearer(places, a, b, k, near_a, near_b):
    """The neighbours of b (near_a) and of a (near_b) on a circle that k lies on too."""
    kx, ky = places[k, 0], places[k, 1]
    if orient(places[a, 0], places[a, 1], places[near_a, 0], places[near_a, 1], kx, ky) < 0:
        near_a = k
    if orient(places[b, 0], places[b, 1], places[near_b, 0], places[near_b, 1], kx, ky) > 0:
        near_b = k
    return near_a, near_b


@njit(cache=True, error_model="numpy")
def _right_of(box, ax, ay, ux, uy):
    """Whether a block's box (left, low, right, high) lies right of the edge for certain, or is empty."""
    if box[0] > box[2]:
        return True
    p = ux * ((box[3] if ux > 0 else box[1]) - ay)  # the corner furthest to the left of the edge
    q = uy * ((box[0] if uy > 0 else box[2]) - ax)
    return p - q < -ORIENT_BOUND * (abs(p) + abs(q))


@njit(cache=True, error_model="numpy")
def block_boxes(places, start, columns, rows):
    """Bounding box (left, low, right, high) of the points in each block of 8 x 8 cells; left > right where empty."""
    boxes = np.zeros(((rows - 1) // BLOCK + 1, (columns - 1) // BLOCK + 1, 4))
    boxes[:, :, :2], boxes[:, :, 2:] = np.inf, -np.inf
    for i in range(rows):
        for j in range(0, columns, BLOCK):
            box = boxes[i // BLOCK, j // BLOCK]
            for k in range(start[i * columns + j], start[i * columns + min(j + BLOCK, columns)]):
                x, y = places[k, 0], places[k, 1]
                box[0], box[1] = min(box[0], x), min(box[1], y)
                box[2], box[3] = max(box[2], x), max(box[3], y)
    return boxes


@njit(cache=True, error_model="numpy")
def strictly_delaunay(places, edges, start, grid, boxes, spent, most):
    """Per edge (m, 2) whether some circle through its ends holds no other point, inside or on it. Returns (m,) bool.

    Such an edge is in every (constrained) Delaunay triangulation, so nothing has to keep triangles from crossing it.
    spent: as in `apex`; the search ends, with what it has, when that is above `most`.
    """
    strict = np.ones(edges.shape[0], np.bool_)
    unsure = np.zeros(places.shape[0], np.int32)
    for m in range(edges.shape[0]):
        if spent[0] > most:
            break
        a, b = edges[m, 0], edges[m, 1]
        if not _crowded(places, a, b, start, grid, spent):
            continue  # the circle over the edge as diameter is empty
        c = apex(places, a, b, start, grid, boxes, None, unsure, spent)
        d = apex(places, b, a, start, grid, boxes, None, unsure, spent)
        if c >= 0 and d >= 0:
            side = incircle(
                places[a, 0], places[a, 1], places[b, 0], places[b, 1], places[c, 0], places[c, 1],
                places[d, 0], places[d, 1],
            )  # fmt: skip
            strict[m] = side < 0
        strict[m] &= not _between(places, a, b, start, grid, spent)
    return strict


@njit(cache=True, error_model="numpy")
def _crowded(places, a, b, start, grid, spent):
    """Whether a third point may lie in the closed circle over a b as diameter (rounding counts as inside)."""
    x0, y0, per_metre, columns, rows = grid
    ax, ay, bx, by = places[a, 0], places[a, 1], places[b, 0], places[b, 1]
    mx, my = (ax + bx) / 2, (ay + by) / 2
    radius = np.hypot(bx - ax, by - ay) / 2 * (1 + 1e-9) + 1e-15 * (abs(mx) + abs(my))
    j, j2 = cell_of(mx - radius, x0, per_metre, columns), cell_of(mx + radius, x0, per_metre, columns)
    i, i2 = cell_of(my - radius, y0, per_metre, rows), cell_of(my + radius, y0, per_metre, rows)
    for m in range(i, i2 + 1):
        spent[0] += 1 + start[m * columns + j2 + 1] - start[m * columns + j]
        for k in range(start[m * columns + j], start[m * columns + j2 + 1]):
            x, y = places[k, 0], places[k, 1]
            p, q = (x - ax) * (x - bx), (y - ay) * (y - by)
            if p + q <= 8 * ORIENT_BOUND * (abs(p) + abs(q)) and k != a and k != b:
                return True
    return False


@njit(cache=True, error_model="numpy")
def _between(places, a, b, start, grid, spent):
    """Whether a point lies on the segment between its ends."""
    x0, y0, per_metre, columns, rows = grid
    ax, ay, bx, by = places[a, 0], places[a, 1], places[b, 0], places[b, 1]
    left, right = min(ax, bx), max(ax, bx)
    low, high = min(ay, by), max(ay, by)
    j, j2 = cell_of(left, x0, per_metre, columns), cell_of(right, x0, per_metre, columns)
    for i in range(cell_of(low, y0, per_metre, rows), cell_of(high, y0, per_metre, rows) + 1):
        spent[0] += 1 + start[i * columns + j2 + 1] - start[i * columns + j]
        for k in range(start[i * columns + j], start[i * columns + j2 + 1]):
            x, y = places[k, 0], places[k, 1]
            if left <= x <= right and low <= y <= high and k != a and k != b:
                if orient(ax, ay, bx, by, x, y) == 0:
                    return True
    return False
