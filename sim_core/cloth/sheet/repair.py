"""Meshes with double vertices and faces without area, made fit to be simulated."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from sim_core.errors import SimCoreError
from sim_core.validation import coordinates, triangles


def mended(
    rest: np.ndarray, faces: np.ndarray, *, near: float = 1e-6
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rest (W, 2), faces (G, 3) and the new number (V,) of every vertex of rest (V, 2) [m], faces (F, 3).

    Vertices closer than `near` [m] become one; faces that lose a corner or have no area (height below `near`), and
    those that are there twice, go; vertices no face names get the number -1. Raises SimCoreError if nothing is left.
    """
    rest, faces = coordinates("rest", rest), triangles("faces", faces)
    if faces.min() < 0 or faces.max() >= len(rest):
        raise SimCoreError(f"faces: {faces.min()} to {faces.max()} – there are vertices 0 to {len(rest) - 1}")
    number = np.arange(len(rest))
    for a, b in sorted(KDTree(rest).query_pairs(near)):
        number[number == number[b]] = number[a]
    faces = number[faces]
    a, b, c = (rest[faces[:, k]] for k in range(3))
    double = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    longest = np.sqrt(np.maximum.reduce([((p - q) ** 2).sum(1) for p, q in ((a, b), (b, c), (c, a))]))
    faces = faces[double > near * longest]
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    faces = faces[np.sort(first)]
    if not len(faces):
        raise SimCoreError("faces: none has an area – the mesh is empty once mended")
    used = np.unique(faces)
    place = np.full(len(rest), -1)
    place[used] = np.arange(len(used))
    return rest[used], place[faces].astype(np.int32), place[number]
