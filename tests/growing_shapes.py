"""Outlines that grow: stars, combs, spirals and clusters of holes, for what must not take unbounded work."""

import numpy as np

__all__ = ["SHAPES", "small_holes"]

Panel = tuple[np.ndarray, list[np.ndarray], float]


def star(count: int) -> Panel:
    """Spikes between radius 1 and 0.02; (outline of `count` points [m], holes, edge [m])."""
    angle = np.arange(count) * 2 * np.pi / count
    radius = np.where(np.arange(count) % 2, 0.02, 1.0)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]), [], 0.16


def comb(count: int) -> Panel:
    """Teeth of 1 m side by side on a back of 2 m."""
    teeth = count // 4
    wide = 2.0 / (2 * teeth - 1)
    left = np.arange(teeth) * 2 * wide
    tooth = np.stack([left, np.ones(teeth), left, np.zeros(teeth)], axis=1).reshape(-1, 2)
    other = np.stack([left + wide, np.zeros(teeth), left + wide, np.ones(teeth)], axis=1).reshape(-1, 2)
    both = np.stack([tooth.reshape(-1, 2, 2), other.reshape(-1, 2, 2)], axis=1).reshape(-1, 2)
    return np.vstack([both[1:-1], [[2.0, 1.2], [0.0, 1.2]]]), [], 0.16


def spiral(count: int) -> Panel:
    """A ribbon that winds about the square root of count/20 times around."""
    turns = max(2.0, np.sqrt(count / 20))
    along = np.linspace(0.15, 1, count // 2)
    angle = along * turns * 2 * np.pi
    half = 0.3 / turns
    outer = np.column_stack([np.cos(angle), np.sin(angle)]) * along[:, None]
    inner = np.column_stack([np.cos(angle), np.sin(angle)]) * (along - half)[:, None]
    return np.vstack([outer, inner[::-1]]), [], 0.16


def cluster(count: int) -> Panel:
    """Holes of 8 points crowded around one place, each half as large and half as far off as the one a ring before."""
    square = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    holes = []
    rings = 12
    a_ring = max(count // (8 * rings), 3)
    turn = np.arange(8) * np.pi / 4
    for ring in range(rings):
        far = 0.9 * 0.5**ring
        for k in range(a_ring):
            angle = 2 * np.pi * k / a_ring
            middle = far * np.array([np.cos(angle), np.sin(angle)])
            reach = min(0.1, 1.0 / a_ring) * far
            holes.append(middle + reach * np.column_stack([np.cos(turn), np.sin(turn)]))
    return square, holes, 0.16


def small_holes(count: int) -> Panel:
    """Round holes of 2 mm, 50 mm apart on the whole, in a square; edge 50 mm."""
    across = int(np.sqrt(count))
    side = 0.1 * across
    turn = np.arange(32) * np.pi / 16
    ring = 0.001 * np.column_stack([np.cos(turn), np.sin(turn)])
    holes = [
        ring + (0.1 * i + 0.031 + 0.013 * (j % 3), 0.1 * j + 0.047)
        for i in range(across)
        for j in range(across)
    ]
    return np.array([[0.0, 0], [side, 0], [side, side], [0, side]]), holes, 0.05


SHAPES = {"star": star, "comb": comb, "spiral": spiral, "cluster": cluster}
