"""Edges, rings of neighbours in order, and the border of a triangle mesh."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.errors import SimCoreError
from sim_core.mesh.measures import open_edges, stars
from sim_core.validation import coordinates, triangles

__all__ = ["Rings", "border_edges", "border_vertices", "checked_sheet", "edges", "rings", "unsigned"]


class Rings(NamedTuple):
    """The neighbours of vertex v are items[start[v] : start[v + 1]], in the sense in which its faces are numbered.

    At the border they begin with the one that only one face leads to. start: (V + 1,) int64, items: (2 E,) int32.
    """

    start: np.ndarray
    items: np.ndarray


def checked_sheet(rest: object, faces: object) -> tuple[np.ndarray, np.ndarray]:
    """A flat mesh as arrays: rest (V, 2) float64 [m], faces (F, 3) int32.

    Raises SimCoreError for other shapes, coordinates that are not finite, or faces that name no vertex.
    """
    flat = coordinates("rest", rest)
    if flat.ndim != 2 or flat.shape[1] != 2:
        raise SimCoreError(f"rest: shape {flat.shape} – the flat positions (V, 2) [m] are meant")
    return flat, np.ascontiguousarray(triangles("faces", faces, len(flat)), np.int32)


def edges(faces: np.ndarray) -> np.ndarray:
    """Every edge (E, 2) int64 of the faces (F, 3) once, lower vertex first, in order."""
    return np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0).astype(np.int64)


def border_vertices(faces: np.ndarray, count: int) -> np.ndarray:
    """Which of so many vertices lie on an edge of one face only, (count,) bool."""
    on = np.zeros(count, bool)
    on[open_edges(np.ascontiguousarray(faces, np.int32), count)[0].ravel()] = True
    return on


def border_edges(faces: np.ndarray, count: int) -> np.ndarray:
    """Border edges (B, 2) int64 as the faces (F, 3) of so many vertices go round them.

    Raises SimCoreError for a border that meets itself in a vertex, or an edge of more than two faces.
    """
    found, twice = open_edges(np.ascontiguousarray(faces, np.int32), count)
    leaving = np.bincount(found[:, 0], minlength=count)
    if twice >= 0 or leaving.max(initial=0) > 1:
        where = twice if twice >= 0 else int(np.argmax(leaving))
        raise SimCoreError(f"faces: the sheet meets itself at vertex {where} – give one without branches")
    return found.astype(np.int64)


def rings(faces: np.ndarray, count: int) -> Rings:
    """The rings of so many vertices, faces (F, 3)."""
    faces = np.ascontiguousarray(faces, np.int32)
    start, items = stars(faces, count)
    return Rings(*_rings(faces, start, items))


@njit(cache=True)
def _rings(faces, star, corners):
    count = len(star) - 1
    start, items, filled = np.zeros(count + 1, np.int64), np.zeros(2 * len(corners), np.int32), 0
    for v in range(count):
        degree = star[v + 1] - star[v]
        right, left = np.zeros(degree, np.int32), np.zeros(degree, np.int32)
        for m in range(degree):
            corner = corners[star[v] + m]
            right[m] = faces[corner // 3, (corner % 3 + 1) % 3]
            left[m] = faces[corner // 3, (corner % 3 + 2) % 3]
        used = np.zeros(degree, np.bool_)
        for _ in range(degree):  # once round where there is no border, else once per fan
            first = -1
            for m in range(degree):
                if used[m]:
                    continue
                behind = False
                for k in range(degree):
                    behind = behind or left[k] == right[m]
                if not behind:
                    first = m
                    break
                if first < 0 or right[m] < right[first]:
                    first = m
            if first < 0:
                break
            begin, m = filled, first
            while m >= 0:
                used[m] = True
                items[filled] = right[m]
                filled += 1
                ahead = -1
                for k in range(degree):
                    if not used[k] and right[k] == left[m]:
                        ahead = k
                if ahead < 0 and left[m] != items[begin]:
                    items[filled] = left[m]
                    filled += 1
                m = ahead
        start[v + 1] = filled
    return start, items[:filled].copy()


def unsigned(numbers: np.ndarray) -> np.ndarray:
    """Whole numbers that are never negative, seen so: a compiled loop need not ask where they count from."""
    return numbers.view(f"u{numbers.dtype.itemsize}")
