"""A start whose layers lie exactly on each other: which is above is told by how they turn, not by where they are.

Of a sheet folded once, and of sheets in a pile, that is enough. One folded several times needs a start with its layers
apart: which fold lies within which is a question without a short answer (flat foldability).
"""

from __future__ import annotations

import numpy as np

from sim_core.cloth.contact.layers.near_pairs import Near
from sim_core.cloth.contact.layers.pairs import Mesh

EXACT = 1e-3  # of the thickness, below which layers lie on each other: there is no side that they are on
PARTED = 0.25  # of the thickness, that each of two such layers goes


def parted(x: np.ndarray, mesh: Mesh, near: Near, thickness: float) -> np.ndarray:
    """x (V, 3) [m] with layers that lie exactly on each other a little apart; x itself where none do.

    Faces turned away from each other, as those of a fold are, each go the way their own normal points; of faces turned
    alike, as those of sheets in a pile are, the one with the higher numbers goes up.
    """
    faces, edges = mesh.faces, mesh.edges
    _, many, more = near.count
    vertex, face = near.points[:many, 0], near.points[:many, 1]
    first, second = near.crossings[:more, 0], near.crossings[:more, 1]
    gaps = _gaps_of_points(x, vertex, faces[face]), _gaps_of_edges(x, edges[first], edges[second])
    on, over = (gap < EXACT * thickness for gap in gaps)
    if not on.any() and not over.any():
        return x
    normal = _normals(x, faces)
    sides = [(np.repeat(vertex[on, None], 3, axis=1).ravel(), faces[face[on]].ravel())]
    for a in range(2):
        for b in range(2):
            sides.append((edges[first[over], a], edges[second[over], b]))
    one = np.concatenate([i for i, _ in sides] + [j for _, j in sides])
    other = np.concatenate([j for _, j in sides] + [i for i, _ in sides])
    alike = (normal[one] * normal[other]).sum(1)
    way = np.where(alike > 0.0, np.sign(one - other), 1)[:, None] * normal[one]
    move, count = np.zeros_like(x), np.zeros(len(x))
    np.add.at(move, one, way)
    np.add.at(count, one, 1.0)
    free = (mesh.inverse_mass > 0.0) & (count > 0.0)
    there = x.copy()
    there[free] += PARTED * thickness * move[free] / count[free, None]
    return there


def _normals(x: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Of vertices (V, 3): the mean of their faces' by area, so that on a crease, where these cancel, there is none."""
    double = np.cross(x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]])
    total, size = np.zeros_like(x), np.zeros(len(x))
    for k in range(3):
        np.add.at(total, faces[:, k], double)
        np.add.at(size, faces[:, k], np.linalg.norm(double, axis=1))
    return total / np.maximum(size, 1e-30)[:, None]


def _gaps_of_points(x: np.ndarray, vertex: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Distances (K,) [m] of vertices (K,) from the faces with these corners (K, 3); endless beside a face."""
    a, b, c = (x[corners[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    size2 = np.maximum((normal**2).sum(1), 1e-300)
    away = x[vertex] - a
    v = (np.cross(away, c - a) * normal).sum(1) / size2
    w = (np.cross(b - a, away) * normal).sum(1) / size2
    within = (v > -EXACT) & (w > -EXACT) & (v + w < 1.0 + EXACT)
    return np.where(within, np.abs((away * normal).sum(1)) / np.sqrt(size2), np.inf)


def _gaps_of_edges(x: np.ndarray, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Distances (K,) [m] of edges (K, 2) where they pass each other; endless where they do not, or run alike."""
    p, r = x[one[:, 0]], x[other[:, 0]]
    d, e = x[one[:, 1]] - p, x[other[:, 1]] - r
    normal = np.cross(d, e)
    size2 = (normal**2).sum(1)
    slanted = size2 > EXACT**2 * (d**2).sum(1) * (e**2).sum(1)
    size2 = np.where(slanted, size2, 1.0)
    s = (np.cross(r - p, e) * normal).sum(1) / size2
    t = (np.cross(r - p, d) * normal).sum(1) / size2
    within = slanted & (s > 0.0) & (s < 1.0) & (t > 0.0) & (t < 1.0)
    return np.where(within, np.abs(((r - p) * normal).sum(1)) / np.sqrt(size2), np.inf)
