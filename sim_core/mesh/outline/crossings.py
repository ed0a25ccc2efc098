"""Where segments meet that should not, of contours or their samples; which contours are close, and which lie in which.

A line sweeps from left to right over the segments and keeps those it cuts in order of height, in a treap; only
neighbours in that order are tried (Shamos and Hoey 1976), so n segments take n log n however long they are.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.mesh.geometry.predicates import orient

__all__ = ["close_contours", "crossed_steps", "enclosing", "first_crossing"]

NONE = -1


class _Sweep(NamedTuple):
    """Segments from left to right ends (n, 2), by (x, y), and those under the line: a treap by height (lower, higher,
    above, lot) whose neighbours are also linked (below, over), each (n,); root: (1,). points, following: the contours
    whose steps they are, or none: then segments with a common end never count as meeting."""

    left: np.ndarray
    right: np.ndarray
    lower: np.ndarray
    higher: np.ndarray
    above: np.ndarray
    lot: np.ndarray
    below: np.ndarray
    over: np.ndarray
    root: np.ndarray
    points: np.ndarray
    following: np.ndarray


def first_crossing(points: np.ndarray, following: np.ndarray) -> tuple[int, int]:
    """Two steps, by the points (n, 2) they begin at, that meet elsewhere than at the point they share, or (-1, -1).

    following: (n,) the point at which each step ends.
    """
    order = np.lexsort((points[:, 1], points[:, 0]))
    same = np.flatnonzero((points[order[1:]] == points[order[:-1]]).all(axis=1))
    if same.size:
        return int(order[same[0]]), int(order[same[0] + 1])
    sweep, events = _swept(points, points[following], points, following)
    i, j, _ = _meeting(sweep, events, False)
    return int(i), int(j)


def crossed_steps(lines: list[np.ndarray]) -> list[np.ndarray]:
    """Per step of open or closed lines (n, 2) [m] whether it meets a step it shares no end with. (n - 1,) bool each.

    Steps that are not marked meet no step that is not; of those that do meet, one of each pair at least is found.
    """
    a, b = (np.concatenate([line[k : len(line) - 1 + k] for line in lines]) for k in (0, 1))
    sweep, events = _swept(a, b, np.zeros((0, 2)), np.zeros(0, np.int64))
    crossed = _meeting(sweep, events, True)[2]
    return np.split(crossed, np.cumsum([len(line) - 1 for line in lines])[:-1])


def close_contours(contours: list[np.ndarray], near: float) -> np.ndarray:
    """Numbers of the contours (n, 2) [m], each simple, that meet another or come within `near` [m] of it.

    Of contours that cross, one of each pair at least is named; of others, both.
    """
    a, b, owner = _steps(contours)
    crossed = np.concatenate(crossed_steps([np.vstack([contour, contour[:1]]) for contour in contours]))
    found = {*owner[crossed].tolist(), *_near_corners(a, owner, 2 * near)}
    # What does not cross any more is swept twice: a steep side beside a corner is not under the line that stands there.
    a, b, owner = a[~crossed], b[~crossed], owner[~crossed]
    for axes in ([0, 1], [1, 0]):
        sweep, events = _swept(a[:, axes], b[:, axes], np.zeros((0, 2)), np.zeros(0, np.int64))
        found |= set(owner[_beside(sweep, events, owner, near)].tolist())
    return np.array(sorted(found), np.int64)


def _near_corners(points: np.ndarray, owner: np.ndarray, near: float) -> set[int]:
    """Contours that have a point (n, 2) within `near` of one of another's."""
    from scipy.spatial import KDTree

    pairs = KDTree(points).query_pairs(near, output_type="ndarray")
    return set(owner[pairs[owner[pairs[:, 0]] != owner[pairs[:, 1]]]].ravel().tolist())


def enclosing(contours: list[np.ndarray]) -> np.ndarray:
    """Number of the innermost contour around each of contours (n, 2) [m] that do not meet; -1: none."""
    a, b, owner = _steps(contours)
    x, y = a.T
    area = np.bincount(owner, x * b[:, 1] - b[:, 0] * y)
    sweep, events = _swept(a, b, np.zeros((0, 2)), np.zeros(0, np.int64))
    ahead = (sweep.left == a).all(axis=1)
    return _around(sweep, events, owner, ahead == (area[owner] > 0), len(contours))


def _steps(contours: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Both ends (n, 2) [m] of every step of closed contours, and the number (n,) of its contour."""
    owner = np.repeat(np.arange(len(contours)), [len(contour) for contour in contours])
    ends = np.concatenate([np.roll(contour, -1, axis=0) for contour in contours])
    return np.concatenate(contours), ends, owner


def _swept(a, b, points, following) -> tuple[_Sweep, np.ndarray]:
    """Segments a b (n, 2) ready to be swept, and the order of their ends: k ends, n + k begins."""
    turned = (a[:, 0] > b[:, 0]) | ((a[:, 0] == b[:, 0]) & (a[:, 1] > b[:, 1]))
    left, right = np.where(turned[:, None], b, a), np.where(turned[:, None], a, b)
    count = len(a)
    ends = np.concatenate([right, left])
    begins = np.arange(2 * count) >= count  # at one place the segments that end go first
    events = np.lexsort((begins, ends[:, 1], ends[:, 0]))
    links = [np.full(count, NONE, np.int64) for _ in range(5)]
    lot = np.random.default_rng(0).random(count)
    following = np.asarray(following, dtype=np.int64)
    lower, higher, above, below, over = links
    root = np.full(1, NONE, np.int64)
    sweep = _Sweep(left, right, lower, higher, above, lot, below, over, root, points, following)
    return sweep, events


@njit(cache=True)
def _meeting(s, events, every):
    """Two segments that meet, or the marks of all that were found to: of each pair found one leaves the sweep."""
    count = s.left.shape[0]
    marked, held = np.zeros(count, np.bool_), np.zeros(count, np.bool_)
    for event in events:
        k = event % count
        if event >= count:
            other = _enter(s, k)
            if other >= 0:
                marked[k] = marked[other] = True
                if not every:
                    return k, other, marked
            else:
                held[k] = True
        elif held[k]:
            low, high = s.below[k], s.over[k]
            _leave(s, k)
            held[k] = False
            while low >= 0 and high >= 0 and _meets(s, low, high):
                marked[low] = marked[high] = True
                if not every:
                    return low, high, marked
                beyond = s.over[high]
                _leave(s, high)
                held[high] = False
                high = beyond
    return NONE, NONE, marked


@njit(cache=True)
def _beside(s, events, owner, near):
    """Marks of the segments that have an end of another contour's within `near`, and of the segment it ends."""
    count = s.left.shape[0]
    marked, held = np.zeros(count, np.bool_), np.zeros(count, np.bool_)
    for event in events:
        k = event % count
        if event >= count:
            held[k] = _enter(s, k) < 0
        if not held[k]:
            continue
        end = s.left[k] if event >= count else s.right[k]
        for other in (s.below[k], s.over[k]):
            if (
                other >= 0
                and owner[other] != owner[k]
                and _distance2(end, s.left[other], s.right[other]) <= near * near
            ):
                marked[k] = marked[other] = True
        if event < count:
            _leave(s, k)
    return marked


@njit(cache=True)
def _around(s, events, owner, cloth_above, contours):
    """The innermost contour around each: of the segment below its first point, the one whose inside lies above it."""
    count = s.left.shape[0]
    around, begun = np.full(contours, NONE, np.int64), np.zeros(contours, np.bool_)
    for event in events:
        k = event % count
        if event < count:
            _leave(s, k)
            continue
        _enter(s, k)
        mine, low = owner[k], s.below[k]
        if not begun[mine]:
            begun[mine] = True
            if low >= 0:
                around[mine] = owner[low] if cloth_above[low] else around[owner[low]]
    return around


@njit(cache=True)
def _distance2(p, a, b):
    """Squared distance of a point from a segment."""
    ux, uy, vx, vy = b[0] - a[0], b[1] - a[1], p[0] - a[0], p[1] - a[1]
    t = min(max((ux * vx + uy * vy) / max(ux * ux + uy * uy, 1e-300), 0.0), 1.0)
    return (vx - t * ux) ** 2 + (vy - t * uy) ** 2


@njit(cache=True)
def _enter(s, k):
    """Put segment k under the line; returns a segment it meets (k stays out then), or -1."""
    x, y = s.left[k, 0], s.left[k, 1]
    node, low, high = s.root[0], NONE, NONE
    parent, up = NONE, False
    while node >= 0:
        ax, ay, bx, by = s.left[node, 0], s.left[node, 1], s.right[node, 0], s.right[node, 1]
        side = orient(ax, ay, bx, by, x, y)
        if side == 0:  # it begins on the other segment
            if x != ax or y != ay:
                return node
            side = orient(ax, ay, bx, by, s.right[k, 0], s.right[k, 1])
        if side == 0:
            if _meets(s, node, k):
                return node
            side = 1.0
        parent, up = node, side > 0
        if up:
            low, node = node, s.higher[node]
        else:
            high, node = node, s.lower[node]
    if low >= 0 and _meets(s, low, k):
        return low
    if high >= 0 and _meets(s, high, k):
        return high
    s.lower[k] = s.higher[k] = NONE
    s.above[k], s.below[k], s.over[k] = parent, low, high
    if low >= 0:
        s.over[low] = k
    if high >= 0:
        s.below[high] = k
    if parent < 0:
        s.root[0] = k
    elif up:
        s.higher[parent] = k
    else:
        s.lower[parent] = k
    while s.above[k] >= 0 and s.lot[s.above[k]] < s.lot[k]:
        _lift(s, k)
    return NONE


@njit(cache=True)
def _leave(s, k):
    """Take segment k from under the line."""
    while s.lower[k] >= 0 or s.higher[k] >= 0:
        a, b = s.lower[k], s.higher[k]
        _lift(s, b if a < 0 or (b >= 0 and s.lot[b] > s.lot[a]) else a)
    parent = s.above[k]
    if parent < 0:
        s.root[0] = NONE
    elif s.lower[parent] == k:
        s.lower[parent] = NONE
    else:
        s.higher[parent] = NONE
    low, high = s.below[k], s.over[k]
    if low >= 0:
        s.over[low] = high
    if high >= 0:
        s.below[high] = low


@njit(cache=True)
def _lift(s, k):
    """Turn the treap so that k takes its parent's place."""
    parent = s.above[k]
    top = s.above[parent]
    if s.lower[parent] == k:
        inner = s.higher[k]
        s.lower[parent], s.higher[k] = inner, parent
    else:
        inner = s.lower[k]
        s.higher[parent], s.lower[k] = inner, parent
    if inner >= 0:
        s.above[inner] = parent
    s.above[parent], s.above[k] = k, top
    if top < 0:
        s.root[0] = k
    elif s.lower[top] == parent:
        s.lower[top] = k
    else:
        s.higher[top] = k


@njit(cache=True)
def _meets(s, i, j):
    """Whether two segments have a point in common that they may not have."""
    if s.following.size:
        i2, j2 = s.following[i], s.following[j]
        if i2 == j:
            return _folds_back(s.points, i, i2, j2)
        if j2 == i:
            return _folds_back(s.points, j, i, i2)
    else:
        a, b, c, d = s.left[i], s.right[i], s.left[j], s.right[j]
        if _same(a, c) or _same(a, d) or _same(b, c) or _same(b, d):
            return False
    return _meet(s.left[i], s.right[i], s.left[j], s.right[j])


@njit(cache=True)
def _same(p, q):
    return p[0] == q[0] and p[1] == q[1]


@njit(cache=True)
def _folds_back(points, a, b, c):
    """Whether b -> c runs back along a -> b."""
    if orient(points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1]) != 0:
        return False
    ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    vx, vy = points[c, 0] - points[b, 0], points[c, 1] - points[b, 1]
    return ux * vx + uy * vy < 0


@njit(cache=True)
def _meet(a, b, c, d):
    """Whether the closed segments a b and c d, each from its lesser end by (x, y), have a common point. Exact."""
    if max(a[0], c[0]) > min(b[0], d[0]):
        return False
    if max(min(a[1], b[1]), min(c[1], d[1])) > min(max(a[1], b[1]), max(c[1], d[1])):
        return False
    s1, s2 = orient(a[0], a[1], b[0], b[1], c[0], c[1]), orient(a[0], a[1], b[0], b[1], d[0], d[1])
    if (s1 > 0 and s2 > 0) or (s1 < 0 and s2 < 0):
        return False
    s3, s4 = orient(c[0], c[1], d[0], d[1], a[0], a[1]), orient(c[0], c[1], d[0], d[1], b[0], b[1])
    return not ((s3 > 0 and s4 > 0) or (s3 < 0 and s4 < 0))
