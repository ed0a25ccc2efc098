"""Patches: a cloth cut into small connected groups of faces, and which of them may touch.

A patch whose normals lie in a narrow cone, and whose edges are not crushed, is a graph over a plane and cannot meet
itself, nor a neighbour with which it shares the cone (Volino & Magnenat-Thalmann 1994; Provot 1997), unless its outline
does: both sides of a slit lie in one plane. So nothing is said of patches at a bay of the outline, nor across one. Of
cloth that hangs in folds nearly all is flat; what is left are pairs of patches whose boxes overlap: layers and sharp
folds.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.cloth.sheet.sheet import face_edge_table

FACES = 16  # of a patch; larger ones are flat less often, smaller ones are more to look at
CONE = math.cos(
    math.radians(60.0)
)  # of the widest angle between two normals of what cannot pass through itself
BAY = math.radians(205.0)  # of cloth around a vertex at a rim, beyond which the outline turns inwards there
WHOLE = 11  # numbers that tell how a patch moves
CRUSHED = 0.5  # of its squared length at rest, below which an edge may lie in a fold that normals do not show
HELD = 0.35  # of its length at rest, that an edge which was not crushed is foreseen to keep


class Patches(NamedTuple):
    """P patches of a cloth of V vertices, E edges, F faces; each vertex and edge belongs to the first patch with it."""

    faces: np.ndarray  # (F,) int32, patch by patch
    edges: np.ndarray  # (E,)
    vertices: np.ndarray  # (V,)
    face_start: np.ndarray  # (P + 1,) int32 into them
    edge_start: np.ndarray
    vertex_start: np.ndarray
    corners: np.ndarray  # (N,) int32 all vertices that a patch's faces name, each once
    corner_start: np.ndarray  # (P + 1,)
    sides: np.ndarray  # (E, 2) int32 the patches of the faces at each edge, lowest and highest
    beside: np.ndarray  # (N,) int32 the patches that share a vertex with each, without itself
    beside_start: np.ndarray  # (P + 1,)
    bay: (
        np.ndarray
    )  # (P,) bool: a vertex of it is where the outline turns inwards, or cloth goes on as several sheets


class Shapes(NamedTuple):
    """Working memory: where the patches and their parts are at a time."""

    vertex_normal: np.ndarray  # (V, 3)
    face: np.ndarray  # (F, 7) in the order of Patches.faces: centre, radius of the ball around it, normal
    edge: (
        np.ndarray
    )  # (E, 10) of Patches.edges: midpoint, half length, mean normal, and half the way along it
    vertex: np.ndarray  # (V, 7) of Patches.vertices: place, 0, normal
    box: np.ndarray  # (P, 6) lowest and highest corner
    cone: (
        np.ndarray
    )  # (P, 8) axis, cosine and sine of the half angle around it that holds all normals (-1, 0: crushed),
    # that angle, the least height of a face [m], and how much shorter each edge may get until it is crushed [m]
    placed: np.ndarray  # (P, 2) int64 the look at which a patch was placed last, and its parts' normals
    look: np.ndarray  # (2,) int64 the number of looks, and the last at which the vertices' normals were taken
    ahead: np.ndarray  # (P, 6) lowest and highest corner of where a patch is as long as pairs are foreseen
    opened: np.ndarray  # (P, 7) of cones as long as pairs are foreseen: half angle, axis, how it turns [rad]
    sheared: np.ndarray  # (P,) [m/s] the most by which an edge's ends go apart beside the patch's rotation
    busy: np.ndarray  # (P,) bool: a patch of a pair that is not foreseen to stay apart
    order: np.ndarray  # (P,) by the low end along the longest way
    moved: (
        np.ndarray
    )  # (P, 2 WHOLE) of the way since the mark, then of the velocity: mean, rotation about the middle, the
    # most of what is left; the furthest part from the middle, and where that is
    start: np.ndarray  # (P + 2,) int64
    ends: np.ndarray  # (2, 3) lowest and highest corner of all
    some: np.ndarray  # (2, K) int32 which of two patches' parts are near each other
    close: np.ndarray  # (K * K, 2) int32 and which pairs of them


@njit(cache=True)
def _grown(beside, size):
    """Numbers (F,) of connected groups of about `size` faces; beside (F, 3): the faces at each one's sides, or -1."""
    count = len(beside)
    patch = np.full(count, -1, np.int32)
    queue = np.zeros(count, np.int32)
    number = 0
    for seed in range(count):
        if patch[seed] >= 0:
            continue
        head, tail = 0, 1
        queue[0], patch[seed] = seed, number
        while head < tail and tail < size:
            for side in range(3):
                f = beside[queue[head], side]
                if f >= 0 and patch[f] < 0 and tail < size:
                    patch[f] = number
                    queue[tail] = f
                    tail += 1
            head += 1
        if tail < size // 4:  # a remnant between others goes to one of these
            for n in range(tail):
                for side in range(3):
                    f = beside[queue[n], side]
                    if f >= 0 and patch[f] != number:
                        for m in range(tail):
                            patch[queue[m]] = patch[f]
                        tail = 0
                        break
                if tail == 0:
                    break
            if tail == 0:
                continue
        number += 1
    return patch


def patches_of(
    edges: np.ndarray, faces: np.ndarray, same: np.ndarray, corner: np.ndarray, size: int = FACES
) -> Patches:
    """Patches of a mesh: edges (E, 2), faces (F, 3) int32, same (V,) int32, one number for vertices that are sewn.

    corner (F, 3, 2) [m]: where each face's corners lie in the pattern.
    """
    count = len(same)
    if not len(faces):
        none, start = np.zeros(0, np.int32), np.zeros(1, np.int32)
        sides = np.zeros((0, 2), np.int32)
        return Patches(
            none, none, none, start, start, start, none, start, sides, none, start, none.astype(bool)
        )
    _, face_edges = face_edge_table(faces)
    flat = face_edges.ravel()
    by_edge = np.argsort(flat, kind="stable")
    beside = np.full(len(flat), -1, np.int32)
    twin = flat[by_edge][1:] == flat[by_edge][:-1]
    first, second = by_edge[:-1][twin], by_edge[1:][twin]
    beside[first], beside[second] = second // 3, first // 3
    patch = _grown(beside.reshape(-1, 3), size)
    number = int(patch.max()) + 1
    of_vertex = np.full(count, number, np.int32)
    np.minimum.at(of_vertex, faces.ravel(), np.repeat(patch, 3))
    of_edge, last = np.full(len(edges), number, np.int32), np.zeros(len(edges), np.int32)
    key = np.sort(edges, axis=1).astype(np.int64) @ [count, 1]
    where = np.argsort(key)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        ends = np.sort(faces[:, [a, b]], axis=1).astype(np.int64) @ [count, 1]
        edge = where[np.searchsorted(key[where], ends)]
        np.minimum.at(of_edge, edge, patch)
        np.maximum.at(last, edge, patch)

    def sorted_by(owner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        start = np.searchsorted(np.sort(owner), np.arange(number + 1))
        return np.argsort(owner, kind="stable").astype(np.int32), start.astype(np.int32)

    (own_faces, face_start), (own_edges, edge_start) = sorted_by(patch), sorted_by(of_edge)
    own_vertices, vertex_start = sorted_by(of_vertex)
    named = np.unique(np.column_stack([np.repeat(patch, 3), faces.ravel()]), axis=0)
    corner_start = np.searchsorted(named[:, 0], np.arange(number + 1)).astype(np.int32)
    near, near_start = _neighbours(same[faces], patch, number)
    bay = np.zeros(number, bool)
    np.logical_or.at(bay, np.repeat(patch, 3), _at_bays(same[faces].astype(np.int64), corner).ravel())
    return Patches(
        faces=own_faces,
        edges=own_edges,
        vertices=own_vertices,
        face_start=face_start,
        edge_start=edge_start,
        vertex_start=vertex_start,
        corners=named[:, 1].astype(np.int32),
        corner_start=corner_start,
        sides=np.column_stack([np.minimum(of_edge, last), last]),
        beside=near,
        beside_start=near_start,
        bay=bay,
    )


def _at_bays(points: np.ndarray, corner: np.ndarray) -> np.ndarray:
    """Of the points that faces (F, 3) name, which are at bays, (F, 3); corner (F, 3, 2): the faces in the pattern."""
    count = int(points.max()) + 1
    a, b = points.ravel(), np.roll(points, -1, axis=1).ravel()
    ways, told = np.unique(a * count + b, return_counts=True)
    ends = np.stack([ways // count, ways % count])
    back = ends[1] * count + ends[0]
    found = np.minimum(np.searchsorted(ways, back), len(ways) - 1)
    once, met = told == 1, ways[found] == back
    one, two = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    across = one[:, :, 0] * two[:, :, 1] - one[:, :, 1] * two[:, :, 0]
    angle = np.bincount(points.ravel(), np.arctan2(np.abs(across), (one * two).sum(2)).ravel(), count)
    rim, several = np.zeros(count, bool), np.zeros(count, bool)
    rim[ends[:, once & ~met]] = True
    several[ends[:, ~once | (met & (told[found] != 1))]] = True
    return (several | (rim & (angle > BAY)))[points]


def _neighbours(corners: np.ndarray, patch: np.ndarray, number: int) -> tuple[np.ndarray, np.ndarray]:
    """Which patches share one of the points that corners (F, 3) name, patch by patch: a list (N,) and its begins."""
    touches = np.unique(np.column_stack([corners.ravel(), np.repeat(patch, 3)]).astype(np.int64), axis=0)
    point, of = touches[:, 0], touches[:, 1]
    pairs = [np.zeros((0, 2), np.int64)]
    for shift in range(1, int(np.bincount(point).max())):  # of those that meet in a point, each with each
        both = point[shift:] == point[:-shift]
        pairs.append(np.column_stack([of[:-shift][both], of[shift:][both]]))
    found = np.concatenate(pairs)
    found = np.unique(np.concatenate([found, found[:, ::-1]]), axis=0)
    start = np.searchsorted(found[:, 0], np.arange(number + 1))
    return found[:, 1].astype(np.int32), start.astype(np.int32)


def shapes_of(patches: Patches) -> Shapes:
    """Memory for a search among these patches."""
    vertices, edges, faces = len(patches.vertices), len(patches.edges), len(patches.faces)
    count = len(patches.face_start) - 1
    starts = patches.face_start, patches.edge_start, patches.vertex_start
    most = max(int(np.diff(start).max(initial=0)) for start in starts)
    return Shapes(
        vertex_normal=np.zeros((vertices, 3)),
        face=np.zeros((faces, 7)),
        edge=np.zeros((edges, 10)),
        vertex=np.zeros((vertices, 7)),
        box=np.zeros((count, 6)),
        cone=np.zeros((count, 8)),
        placed=np.zeros((count, 2), np.int64),
        look=np.zeros(2, np.int64),
        ahead=np.zeros((count, 6)),
        opened=np.zeros((count, 7)),
        sheared=np.zeros(count),
        busy=np.ones(count, bool),
        order=np.arange(count),
        moved=np.zeros((count, 2 * WHOLE)),
        start=np.zeros(count + 2, np.int64),
        ends=np.zeros((2, 3)),
        some=np.zeros((2, most), np.int32),
        close=np.zeros((most * most, 2), np.int32),
    )


@njit(cache=True, error_model="numpy")
def grown(pairs, count):
    """A list (K, N) with room for more than `count`."""
    if count < len(pairs):
        return pairs
    wider = np.zeros((2 * count + 64, pairs.shape[1]), np.int32)
    wider[: len(pairs)] = pairs
    return wider
