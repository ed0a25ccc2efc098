"""Angles that are small, and those of them that an outline has by itself."""

import numpy as np

__all__ = ["edge_keys", "sharp_corners", "small_angles"]

SHARP = np.radians(91.0)  # points of a step cannot lie in circles over another that leaves at a larger angle


def small_angles(places: np.ndarray, faces: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Faces (F,) bool with an angle below 30 degrees that is none of a corner between two steps (m, 2)."""
    count = len(places)
    corners = places[faces]
    sides = np.roll(corners, -1, axis=1) - corners  # from each corner to the next
    length = np.hypot(sides[..., 0], sides[..., 1])
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2)
    on = np.isin(edge_keys(ends, count), edge_keys(steps, count))
    behind = np.roll(sides, 1, axis=1)
    cosine = -(sides * behind).sum(axis=2) / (length * np.roll(length, 1, axis=1))
    given = on & np.roll(on, 1, axis=1)
    return ((cosine > np.cos(np.radians(30.0))) & ~given).any(axis=1)


def edge_keys(ends: np.ndarray, count: int) -> np.ndarray:
    """One number for each undirected edge (..., 2) between `count` points."""
    return np.sort(ends, axis=-1).astype(np.int64) @ (count, 1)


def sharp_corners(places: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Points (V,) bool, of places (V, 2), where two steps (m, 2) meet at less than `SHARP`."""
    pairs = np.unique(np.sort(steps, axis=1), axis=0)
    both = np.concatenate([pairs, pairs[:, ::-1]])
    along = places[both[:, 1]] - places[both[:, 0]]
    angle = np.arctan2(along[:, 1], along[:, 0])
    order = np.lexsort((angle, both[:, 0]))
    owner, angle = both[order, 0], angle[order]
    first = np.flatnonzero(np.append(True, owner[1:] != owner[:-1]))
    last = np.append(first[1:], len(owner)) - 1
    ahead = np.append(angle[1:], 0.0)
    ahead[last] = angle[first] + 2 * np.pi
    sharp = np.zeros(len(places), bool)
    sharp[owner[ahead - angle < SHARP]] = True
    return sharp
