"""Trial runs of a scene on coarse meshes: how they converge says what finer ones will err by."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import KDTree

from sim_core.cloth.scenes.catalogue import Scene
from sim_core.cloth.sheet.sheet import Sheet

GRID = 32  # material points a side at which runs are compared
NEAR = 12  # faces whose middle is nearest, among which a point's own is
TRIAL_EDGES = (0.064, 0.0453, 0.032, 0.0226, 0.016)  # [m]


def grid_film(sheet: Sheet, size: Sequence[float], film: np.ndarray) -> np.ndarray:
    """Positions (T, P, 3) float32 [m] of a GRID of material points in a film (T, V, 3), linear within each face."""
    lines = [np.linspace(0.005, 0.995, GRID) * s for s in size]
    points = np.stack([g.ravel() for g in np.meshgrid(*lines, indexing="ij")], axis=1)
    corners = sheet.rest[sheet.faces]
    near = np.asarray(KDTree(corners.mean(1)).query(points, k=min(NEAR, len(corners)))[1])
    first = corners[near, 0]
    sides = np.stack([corners[near, 1] - first, corners[near, 2] - first], axis=-1)
    inner = np.linalg.solve(sides, (points[:, None] - first)[..., None])[..., 0]
    weights = np.concatenate([1 - inner.sum(-1, keepdims=True), inner], axis=-1)
    best = np.argmax(weights.min(-1), axis=1)
    row = np.arange(len(points))
    there = film[:, sheet.faces[near[row, best]]]
    return np.einsum("tpcx,pc->tpx", there, weights[row, best]).astype(np.float32)


def apart(coarse: np.ndarray, fine: np.ndarray) -> float:
    """Mean distance [mm] of the grid's points in two films (T, P, 3) [m], in the worst frame: facets are part of it."""
    return 1e3 * float(np.linalg.norm(coarse - fine, axis=2).mean(1).max())


def gap(films: Sequence[np.ndarray]) -> float:
    """What three films on finer and finer meshes tell [mm]: the geometric mean of both distances from the finest."""
    far, near, finest = films
    return float(np.sqrt(apart(far, finest) * apart(near, finest)))


def trial_film(made: Scene, size: Sequence[float], frames: int) -> np.ndarray:
    """Film (T, P, 3) float32 [m] of the grid's points in the first frames of a scene on a coarse mesh."""
    film: list[np.ndarray] = []
    made.lasting(frames).drape(on_frame=lambda _, x: film.append(x))
    return grid_film(made.sheet, size, np.stack(film))
