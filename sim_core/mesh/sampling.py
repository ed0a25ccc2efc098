"""Sampling of all contours of a panel, finer where they run close to each other."""

import numpy as np
from scipy.spatial import KDTree

from sim_core.mesh.outline import outline_samples

__all__ = ["sampled_contours"]

SPLITTING_PASSES = 12
FINEST = 32


def sampled_contours(contours: list[np.ndarray], edge: float) -> list[np.ndarray]:
    """Outline samples with shorter steps where contours run close to each other.

    A step is halved while a sample that is no neighbour of it lies in the circle over the step as diameter: then the
    step is a Delaunay edge, and growth follows the outline without any recovery of constraints. Spikes would halve
    for ever: steps stay above edge / 32.
    """
    samples = [outline_samples(contour, edge) for contour in contours]
    for _ in range(SPLITTING_PASSES):
        points = np.concatenate(samples)
        ahead = np.concatenate([np.roll(loop, -1, axis=0) for loop in samples])
        split = _crowded(points, ahead, samples) & (np.hypot(*(ahead - points).T) > edge / FINEST)
        if not split.any():
            break
        marks = np.split(split, np.cumsum([len(loop) for loop in samples])[:-1])
        samples = [_halved(loop, mark) for loop, mark in zip(samples, marks, strict=True)]
    return samples


def _crowded(points: np.ndarray, ahead: np.ndarray, samples: list[np.ndarray]) -> np.ndarray:
    """Steps whose diametral circle holds a sample other than those next to the step. Returns (steps,) bool."""
    middle, radius = (points + ahead) / 2, np.hypot(*(ahead - points).T) / 2
    behind = np.concatenate([np.roll(loop, 1, axis=0) for loop in samples])
    beyond = np.concatenate([np.roll(loop, -2, axis=0) for loop in samples])
    crowded = np.zeros(len(points), dtype=bool)
    tree, reach = KDTree(points), radius * (1 - 1e-9)
    for k in np.flatnonzero(tree.query_ball_point(middle, reach, return_length=True)):
        others = points[tree.query_ball_point(middle[k], reach[k])]
        known = np.stack([points[k], ahead[k], behind[k], beyond[k]])
        crowded[k] = bool((others[:, None] != known).any(axis=2).all(axis=1).any())
    return crowded


def _halved(loop: np.ndarray, split: np.ndarray) -> np.ndarray:
    """A closed loop with the middle of each marked step inserted."""
    middle = (loop + np.roll(loop, -1, axis=0)) / 2
    at = np.flatnonzero(split) + 1
    return np.insert(loop, at, middle[split], axis=0)
