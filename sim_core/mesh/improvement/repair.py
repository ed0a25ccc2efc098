"""Insertion and deletion where smoothing alone leaves a small angle or a point of odd valence.

A patch of a few edges around the spot is taken out, one point is removed or added in it, the patch is smoothed and
grown again; the trial with the largest smallest angle stays if it is better than what was there. Points of valence
4 or less are crowded, of 8 or more lonely: they are spots even where no angle is small.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from sim_core.mesh.improvement.smoothing import centre, open_angles, sharpest_angle
from sim_core.mesh.measures.triangles import stars, triangle_areas
from sim_core.mesh.measures.verification import open_edges
from sim_core.mesh.triangulation.growth import CLOSED, grow_points

__all__ = ["SPOTS", "repaired"]

REACH = 4.5  # longest sides of the worst triangle: radius of a patch
ENOUGH = np.cos(np.radians(39.0))
SPOTS = 24  # most spots that are treated in one mesh
SWEEPS = 6
MOST_FACES = 1200  # of a patch: a long face among much finer ones is no spot that a patch could mend


class Patch(NamedTuple):
    """Part of a mesh. ids: (p,) vertices, those that may move last.  first: where these begin.  seeds: (m, 2) its
    rim, by place in ids.  cosine: of its smallest angle.  faces: (k,) which faces of the mesh it takes out."""

    ids: np.ndarray
    first: int
    seeds: np.ndarray
    cosine: float
    faces: np.ndarray


def repaired(
    places: np.ndarray, faces: np.ndarray, free: np.ndarray, weights: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Treat the worst spots of a mesh; returns places (V', 2), weights and free anew. The mesh is to be grown again.

    places: (V, 2), y up.  faces: (F, 3).  free: (m,) vertices that may move or go.  weights: (V,) as in `centre`.
    """
    movable = np.zeros(len(places), dtype=bool)
    movable[free] = True
    tried: list[np.ndarray] = []
    for _ in range(SPOTS):
        spot = _worst_spot(places, faces, movable, tried)
        if spot is None:
            break
        tried.append(places[spot].mean(axis=0))
        patch = _patch(places, faces, movable, spot)
        found = _best_trial(places, weights, patch, spot) if len(patch.faces) <= MOST_FACES else None
        if found is not None:
            places, faces, movable, weights = _replaced(places, faces, movable, weights, patch, *found)
    return places, weights, np.flatnonzero(movable)


def _worst_spot(places, faces, movable, tried) -> np.ndarray | None:
    """The three vertices of the face to treat next, or None: smallest angle first, then odd valences."""
    cosines = _cosines(places, faces)
    valence = np.bincount(faces.ravel(), minlength=len(places))
    odd = movable & ((valence < 5) | (valence > 7))
    badness = np.where(odd[faces].any(axis=1), np.maximum(cosines, ENOUGH + 1e-9), cosines)
    worst = np.argsort(-badness)[: 4 * len(tried) + 8]
    worst = worst[badness[worst] > ENOUGH]
    corners = places[faces[worst]]
    steps = corners - np.roll(corners, 1, axis=1)
    side = np.hypot(steps[..., 0], steps[..., 1]).max(axis=1)
    away = corners.mean(axis=1)[:, None] - np.array(tried).reshape(-1, 2)
    fresh = (np.hypot(away[..., 0], away[..., 1]) > side[:, None]).all(axis=1)
    return faces[worst[fresh.argmax()]] if fresh.any() else None


def _patch(places, faces, movable, spot) -> Patch:
    corners = places[spot]
    reach = REACH * np.hypot(*(corners - np.roll(corners, 1, axis=0)).T).max()
    near = ((places - corners.mean(axis=0)) ** 2).sum(axis=1) <= reach**2
    inner = np.flatnonzero(near[faces].all(axis=1))
    rim, _ = open_edges(faces[inner], len(places))
    used = np.unique(faces[inner])
    moves = movable[used] & ~np.isin(used, rim)
    ids = np.concatenate([used[~moves], used[moves]])
    where = np.zeros(len(places), np.int64)
    where[ids] = np.arange(len(ids))
    return Patch(ids, int((~moves).sum()), where[rim], float(_cosines(places, faces[inner]).max()), inner)


def _best_trial(places, weights, patch: Patch, spot) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Points (p', 2), weights and faces of the best patch that could be made, or None where none is better."""
    own, weight = places[patch.ids], weights[patch.ids]
    corners = places[spot]
    added = [(corners[k] + corners[k - 1]) / 2 for k in range(3)] + [corners.mean(axis=0)]
    gone = [int(np.flatnonzero(patch.ids == v)[0]) for v in spot]
    trials = [(own, weight)]
    trials += [(np.delete(own, k, axis=0), np.delete(weight, k)) for k in gone if k >= patch.first]
    trials += [(np.vstack([own, p]), np.append(weight, weights[spot].mean())) for p in added]
    best, kept = patch.cosine - 1e-6, None
    area = None
    for points, density in trials:
        points = points.copy()
        faces, cosine = _settled(points, density, patch)
        if faces is None or cosine >= best:
            continue
        area = area or _area(own, patch.seeds)
        if abs(float(-triangle_areas(points, faces).sum()) - area) < 1e-9 * area:
            best, kept = cosine, (points, density, faces)
    return kept


def _area(points, rim) -> float:
    a, b = points[rim[:, 0]] - points[0], points[rim[:, 1]] - points[0]
    return float(0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())


def _settled(points, density, patch: Patch):
    """Grow a patch, smooth it and open its angles (in place): faces or None, and the cosine of the smallest angle."""
    free = np.arange(patch.first, len(points))
    for turn in range(5):
        grown = grow_points(points, patch.seeds)
        if grown.status != CLOSED or len(grown.faces) == 0:
            return None, 2.0
        start, items = stars(grown.faces, len(points))
        if turn < 2:
            centre(points, grown.faces, start, items, free, density, SWEEPS)
        elif turn == 4 or open_angles(points, grown.faces, start, items, free, ENOUGH, 6) == 0:
            break
    return grown.faces, float(sharpest_angle(points, grown.faces))


def _replaced(places, faces, movable, weights, patch: Patch, points, density, new_faces):
    """The mesh with a patch put back in: rim and fixed points keep their numbers, moved ones go to the end."""
    gone = patch.ids[patch.first :]
    keep = np.ones(len(places), dtype=bool)
    keep[gone] = False
    number = np.cumsum(keep) - 1
    rest = np.delete(faces, patch.faces, axis=0)
    base = int(keep.sum())
    local = np.concatenate([number[patch.ids[: patch.first]], base + np.arange(len(points) - patch.first)])
    joined = np.concatenate([number[rest], local[new_faces]]).astype(np.int32)
    moved = len(points) - patch.first
    return (
        np.concatenate([places[keep], points[patch.first :]]),
        joined,
        np.concatenate([movable[keep], np.ones(moved, dtype=bool)]),
        np.concatenate([weights[keep], density[patch.first :]]),
    )


@njit(cache=True, error_model="numpy")
def _cosines(places, faces):
    """Cosine of the smallest angle of each face."""
    found = np.zeros(faces.shape[0])
    for f in range(faces.shape[0]):
        found[f] = sharpest_angle(places, faces[f : f + 1])
    return found
