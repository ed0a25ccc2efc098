"""Pooling by quadric error, summed over the frames of training (Garland and Heckbert 1997), by half-edge collapse.

A vertex that goes lays its planes on the neighbour that takes its place, and the cost of that is the sum of area times
squared distance from them, over all frames. The quadrics of different frames cannot be added, since each is asked at
its own frame's place; nor are they held: a vertex holds which fine faces it stands for, a list of whole numbers, and
the sum is taken over their planes when it is asked for. Memory is the planes, 32 F T bytes for F faces and T frames.
"""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heappop, heappush

import numpy as np
from numba import njit

from sim_core.errors import SimCoreError
from sim_core.learn.pooling.curvature import mean_absolute_curvature
from sim_core.learn.pooling.pooled import Pooled, protected_vertices, staying
from sim_core.learn.topology import border_edges, border_vertices, checked_sheet
from sim_core.mesh import triangle_areas
from sim_core.mesh.measures import stars
from sim_core.validation import finite

__all__ = ["collapse"]

MOST = 24  # faces round a vertex
FAIR = 0.1  # shape of a triangle at rest (1: equilateral) that is aimed at; any above 0 where nothing else is left
FLAT = (
    1e-6  # of area times squared edge, added: flat parts are thinned evenly, and curved ones by their planes
)
STRAIGHT = 1e-9  # of its area that a star at the border may lose


def collapse(
    rest: np.ndarray,
    faces: np.ndarray,
    frames: np.ndarray,
    share: float = 0.6,
    *,
    pins: Sequence[int] = (),
    border: bool = True,
    penalty: float = 0.0,
) -> Pooled:
    """Less than a share of the vertices, those without which the frames lose least; the triangles at rest stay valid.

    rest: (V, 2) [m]; faces: (F, 3); frames: (T, V, 3) [m] of training, a few dozen. border: all of it stays; else its
    straight runs may be thinned. penalty lambda: costs are multiplied by 1 + lambda |K| / median |K|, K being the
    vertex's Gauss curvature. Raises SimCoreError for frames of another mesh, and where the share cannot be reached.
    """
    rest, faces = checked_sheet(rest, faces)
    frames = np.asarray(frames, float)
    if frames.ndim != 3 or frames.shape[1:] != (len(rest), 3) or not len(frames):
        raise SimCoreError(f"frames: shape {frames.shape} – (T, {len(rest)}, 3) [m] is meant, T > 0")
    if not np.isfinite(frames).all():
        raise SimCoreError("frames: coordinates that are not finite")
    penalty = finite("penalty", penalty, least=0.0)
    protected = protected_vertices(faces, len(rest), pins, border)
    most = staying(len(rest), share, protected)
    factor = np.ones(len(rest))
    if penalty > 0.0:
        curvature = mean_absolute_curvature(frames, faces)
        middle = np.median(curvature[~border_vertices(faces, len(rest))])
        if middle > 0.0:  # else most of the cloth is flat in every frame, and there is nothing to weigh by
            factor += penalty * curvature / middle
    sense = np.sign(triangle_areas(rest, faces).sum()) or 1.0
    edge = border_edges(faces, len(rest))
    planes, holders = _planes(frames, faces, edge)
    star, corners = stars(faces, len(rest))
    if np.diff(star).max() > MOST:
        raise SimCoreError(
            f"faces: {np.diff(star).max()} round one vertex – a mesh of {MOST} at most is meant"
        )
    alive, made = _collapsed(
        rest * [1.0, -sense],
        faces,
        np.ascontiguousarray(frames.transpose(1, 0, 2)),
        (planes, holders),
        (star, corners),
        (protected, border_vertices(faces, len(rest))),
        factor,
        most,
    )
    if alive.sum() > most:
        raise SimCoreError(
            f"share: {share:g} – only {alive.mean():.2f} can be reached with valid triangles at rest"
        )
    place = np.cumsum(alive) - 1
    kept = np.flatnonzero(alive).astype(np.int64)
    return Pooled(kept, place[made].astype(np.int32), len(kept) / len(rest))


def _planes(frames: np.ndarray, faces: np.ndarray, edge: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Planes (P, T, 4), normals by the root of area, of the faces and, upright on them, of border edges; who holds them
    (P, 3), -1 for none."""
    p, q, r = (frames[:, faces[:, k]] for k in range(3))
    double = np.cross(q - p, r - p)
    size = np.sqrt(np.maximum(np.linalg.norm(double, axis=2), 1e-300))
    normal = double / size[:, :, None] * np.sqrt(0.5)  # |double| = 2 area
    facing = np.zeros((len(frames), frames.shape[1], 3))
    for k in range(3):
        for t in range(len(frames)):
            np.add.at(facing[t], faces[:, k], double[t])
    a, b = frames[:, edge[:, 0]], frames[:, edge[:, 1]]
    upright = np.cross(b - a, facing[:, edge[:, 0]] + facing[:, edge[:, 1]])
    length = np.linalg.norm(b - a, axis=2, keepdims=True)
    upright *= length / np.maximum(np.linalg.norm(upright, axis=2, keepdims=True), 1e-300)
    planes = np.concatenate([normal, upright], axis=1)
    offset = -(planes * np.concatenate([p, a], axis=1)).sum(2, keepdims=True)
    both = np.concatenate([planes, offset], axis=2).transpose(1, 0, 2)
    holders = np.concatenate([faces, np.column_stack([edge, np.full(len(edge), -1)])])
    return np.ascontiguousarray(both), holders.astype(np.int64)


@njit(cache=True)
def _laid(planes, head, after, v, places):
    """Squared distances, by area and meaned over frames, of places (T, 3) from the planes that v holds."""
    total, entry = 0.0, head[v]
    while entry >= 0:
        plane = planes[entry // 3]
        for t in range(len(places)):
            away = plane[t, 0] * places[t, 0] + plane[t, 1] * places[t, 1] + plane[t, 2] * places[t, 2]
            total += (away + plane[t, 3]) ** 2
        entry = after[entry]
    return total / len(places)


@njit(cache=True)
def _apart2(a, b):
    """Mean squared distance of two vertices' places (T, 3)."""
    total = 0.0
    for t in range(len(a)):
        total += (a[t, 0] - b[t, 0]) ** 2 + (a[t, 1] - b[t, 1]) ** 2 + (a[t, 2] - b[t, 2]) ** 2
    return total / len(a)


@njit(cache=True)
def _double(flat, a, b, c):
    """Twice the area of a triangle at rest."""
    ux, uy = flat[b, 0] - flat[a, 0], flat[b, 1] - flat[a, 1]
    return ux * (flat[c, 1] - flat[a, 1]) - uy * (flat[c, 0] - flat[a, 0])


@njit(cache=True)
def _squared(flat, a, b):
    """Squared length of an edge at rest."""
    return (flat[b, 0] - flat[a, 0]) ** 2 + (flat[b, 1] - flat[a, 1]) ** 2


@njit(cache=True)
def _allowed(v, u, flat, faces, star, degree, on, least):
    """May v go and u take its place, with a mesh left that is valid at rest?"""
    shared, before, after = 0, 0.0, 0.0
    for m in range(degree[v]):
        face = faces[star[v, m]]
        a, b, c = face[0], face[1], face[2]
        before += _double(flat, a, b, c)
        if a == u or b == u or c == u:
            shared += 1
            continue
        a, b, c = u if a == v else a, u if b == v else b, u if c == v else c
        double = _double(flat, a, b, c)
        sides = _squared(flat, a, b) + _squared(flat, b, c) + _squared(flat, c, a)
        if 2.0 * np.sqrt(3.0) * double <= least * sides:
            return False
        after += double
    if on[v] and (shared != 1 or not on[u] or abs(after - before) > STRAIGHT * before):
        return False
    if not on[v] and shared != 2:
        return False
    if degree[v] + degree[u] - 2 * shared > MOST:
        return False
    common = 0  # neighbours of both: one for each face they share, else the surface would be pinched
    for m in range(degree[v]):
        for k in range(3):
            n = faces[star[v, m], k]
            if n == v or n == u:
                continue
            seen = False
            for earlier in range(m):
                for j in range(3):
                    seen = seen or faces[star[v, earlier], j] == n
            if seen:
                continue
            for i in range(degree[u]):
                face = faces[star[u, i]]
                if face[0] == n or face[1] == n or face[2] == n:
                    common += 1
                    break
    return common == shared


@njit(cache=True)
def _best(v, mesh, places, lists, own, weight, least):
    """The cheapest neighbour for v to go to, and the cost; -1 where there is none."""
    flat, faces, star, degree, on = mesh
    planes, head, after = lists
    found, cheapest = -1, np.inf
    for m in range(degree[v]):
        for k in range(3):
            u = faces[star[v, m], k]
            if u == v or u == found:
                continue
            if not _allowed(v, u, flat, faces, star, degree, on, least):
                continue
            cost = _laid(planes, head, after, v, places[u]) + own[u]
            cost = weight[0, v] * (cost + FLAT * weight[1, v] * _apart2(places[u], places[v]))
            if cost < cheapest or (cost == cheapest and u < found):
                found, cheapest = u, cost
    return found, cheapest


@njit(cache=True)
def _faces_of(around, count):
    """Faces round each vertex, (V, MOST + 1) with room for more, and how many."""
    star, degree = np.full((count, MOST + 1), -1, np.int32), np.zeros(count, np.int64)
    for v in range(count):
        for corner in around[1][around[0][v] : around[0][v + 1]]:
            star[v, degree[v]] = corner // 3
            degree[v] += 1
    return star, degree


@njit(cache=True)
def _plane_lists(holders, count):
    """The planes each vertex holds, in chains: first and last entry (V,), the one after each; entry // 3 is a plane."""
    head, tail = np.full(count, -1, np.int64), np.full(count, -1, np.int64)
    after = np.full(holders.size, -1, np.int64)
    for entry in range(holders.size):
        v = holders[entry // 3, entry % 3]
        if v >= 0:
            after[entry] = head[v]
            if head[v] < 0:
                tail[v] = entry
            head[v] = entry
    return head, tail, after


@njit(cache=True)
def _collapsed(flat, fine, places, held, around, fixed, factor, most):
    """Which vertices are left (V,) bool, and the faces between them."""
    planes, holders = held
    protected, on = fixed
    count, faces, alive = len(flat), fine.copy(), np.ones(len(flat), np.bool_)
    star, degree = _faces_of(around, count)
    head, tail, after = _plane_lists(holders, count)
    weight = np.zeros((2, count))
    weight[0] = factor
    for f in range(len(fine)):
        for k in range(3):
            weight[1, fine[f, k]] += _double(flat, fine[f, 0], fine[f, 1], fine[f, 2]) / 6.0
    own, target, version = np.zeros(count), np.full(count, -1, np.int64), np.zeros(count, np.int64)
    mesh, lists = (flat, faces, star, degree, on), (planes, head, after)
    left = count
    for least in (FAIR, 1e-6):
        heap = [(-1.0, np.int64(-1), np.int64(0))]
        heap.pop()
        for v in range(count):
            if alive[v] and not protected[v]:
                _offer(heap, np.int64(v), (target, version), mesh, places, lists, (own, weight), least)
        while left > most and len(heap) > 0:
            _, v, stamp = heappop(heap)
            if not alive[v] or stamp != version[v]:
                continue
            u = target[v]
            if not alive[u] or not _allowed(v, u, flat, faces, star, degree, on, least):
                _offer(heap, v, (target, version), mesh, places, lists, (own, weight), least)
                continue
            _give(v, u, faces, star, degree)
            alive[v] = False
            left -= 1
            after[tail[u]], tail[u] = head[v], tail[v]
            own[u] = _laid(planes, head, after, u, places[u])
            weight[1, u] += weight[1, v]
            for m in range(degree[u]):
                for k in range(3):
                    n = np.int64(faces[star[u, m], k])
                    if not protected[n] and (n != u or m == 0):
                        _offer(heap, n, (target, version), mesh, places, lists, (own, weight), least)
    whole = np.zeros(len(faces), np.bool_)
    for v in range(count):
        if alive[v]:
            whole[star[v, : degree[v]]] = True
    return alive, faces[whole]


@njit(cache=True)
def _offer(heap, v, kept, mesh, places, lists, costs, least):
    """Puts the best collapse of v on the heap; what lies there of v before counts no more."""
    target, version = kept
    own, weight = costs
    version[v] += 1
    u, cost = _best(v, mesh, places, lists, own, weight, least)
    if u >= 0:
        target[v] = u
        heappush(heap, (cost, v, version[v]))


@njit(cache=True)
def _give(v, u, faces, star, degree):
    """The faces of v become faces of u, without those of both."""
    for m in range(degree[v]):
        f = star[v, m]
        if faces[f, 0] == u or faces[f, 1] == u or faces[f, 2] == u:
            for k in range(3):
                n = faces[f, k]
                if n == v:
                    continue
                for i in range(degree[n]):
                    if star[n, i] == f:
                        degree[n] -= 1
                        star[n, i] = star[n, degree[n]]
                        break
            continue
        for k in range(3):
            if faces[f, k] == v:
                faces[f, k] = u
        star[u, degree[u]] = f
        degree[u] += 1
