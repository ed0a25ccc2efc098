"""A dense mesh at falling numbers of triangles."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from sim_core.mesh.scan.levels.collapses import BORDER, STAYS, Web, best_ways, evened, prepare, take

__all__ = ["Level", "coarsened"]

BETTER = 0.5  # of the ways of a round are looked at, the best ones
SPENT = 0.002  # of the vertices: a round that takes fewer is the last but for all of its ways


@dataclass(frozen=True)
class Level:
    """A coarser mesh: vertices (N, 3) [m], faces (T, 3) int32, normals (N, 3) of the fine surface that each vertex
    stands for."""

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray


def coarsened(
    vertices: np.ndarray, faces: np.ndarray, counts: Sequence[int]
) -> Iterator[tuple[int, Level | None]]:
    """Round by round (triangles left, None); of each of `counts`, the largest first, its level once it is reached.

    vertices: (V, 3) [m]; faces: (F, 3). A level has at most its count of triangles, more where no collapse is sound
    any more; then the last one comes again. Memory: some 260 bytes a vertex and 30 a face.
    """
    web = _web(vertices, faces)
    error, onto = np.zeros(len(vertices)), np.zeros(len(vertices), np.int64)
    for wanted in sorted(counts, reverse=True):
        stuck = False
        while web.count[0] > wanted and not stuck:
            best_ways(web, error, onto)
            open_ways = np.flatnonzero(onto >= 0)
            order = open_ways[np.argsort(error[open_ways], kind="stable")]
            taken = take(web, order[: max(1, int(BETTER * len(order)))], onto, wanted)
            if taken < SPENT * len(order):
                stuck = take(web, order, onto, wanted) == 0
            yield int(web.count[0]), None
        yield int(web.count[0]), _level(web)


def _web(vertices: np.ndarray, faces: np.ndarray) -> Web:
    count = len(vertices)
    borders, kind = _borders(faces, count)
    web = Web(
        x=np.array(vertices, float, order="C"),
        faces=np.array(faces, np.int32, order="C"),
        alive=np.ones(len(faces), bool),
        head=np.full(count, -1, np.int32),
        link=np.full(3 * len(faces), -1, np.int32),
        kind=kind,
        quadric=np.zeros((count, 10)),
        upright=np.zeros((count, 3)),
        met=np.zeros(count, np.int64),
        clock=np.zeros(1, np.int64),
        count=np.array([len(faces)]),
    )
    prepare(web, borders)
    return web


def _borders(faces: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Open edges (N, 2), and the kind (V,) of each vertex: those where more than two borders or faces meet stay."""
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    low, high = ends.min(1).astype(np.int64), ends.max(1)
    key = low * count + high
    _, first, many = np.unique(key, return_index=True, return_counts=True)
    borders = ends[first[many == 1]].astype(np.int64)
    along = np.bincount(borders.ravel(), minlength=count)
    kind = np.zeros(count, np.uint8)
    kind[along > 0] = BORDER
    kind[(along != 0) & (along != 2)] = STAYS
    kind[ends[first[many > 2]].ravel()] = STAYS
    return borders, kind


def _level(web: Web) -> Level:
    used, faces = np.unique(web.faces[web.alive], return_inverse=True)
    places = np.zeros((len(used), 3))
    evened(web, used.astype(np.int64), places)
    normals = web.upright[used]
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    return Level(places, faces.reshape(-1, 3).astype(np.int32), normals)
