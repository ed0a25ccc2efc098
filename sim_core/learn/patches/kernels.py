"""Between patches and fine vertices: sums over the three corners of the coarse face in which a vertex lies at rest."""

from __future__ import annotations

import numpy as np
from numba import njit

from sim_core.learn.convolution.depthwise import FREE_ORDER

__all__ = ["add_up", "carry_over", "draw_down", "scale", "turn_into"]


@njit(cache=True, fastmath=FREE_ORDER)
def draw_down(patches, turn, corner, weights, out):
    """out (V, 3) = sum over corners i of turn[i] @ (weights[v, i] @ patches[i]); patches (C, K, 3), turn (C, 3, 3),
    corner (V, 3), weights (V, 3, K)."""
    world = np.zeros((len(patches), 3, weights.shape[2]), patches.dtype)
    for i in range(len(patches)):
        for k in range(weights.shape[2]):
            a, b, n = patches[i, k, 0], patches[i, k, 1], patches[i, k, 2]
            for c in range(3):
                world[i, c, k] = turn[i, c, 0] * a + turn[i, c, 1] * b + turn[i, c, 2] * n
    for v in range(len(corner)):
        x = y = z = out[v, 0] * 0
        for c in range(3):
            i = corner[v, c]
            for k in range(weights.shape[2]):
                w = weights[v, c, k]
                x, y, z = x + w * world[i, 0, k], y + w * world[i, 1, k], z + w * world[i, 2, k]
        out[v, 0], out[v, 1], out[v, 2] = x, y, z


@njit(cache=True, fastmath=FREE_ORDER)
def add_up(fine, turn, corner, weights, out):
    """The transpose: out (C, K, 3) = sum over vertices v of weights[v, i] times turn[i].T @ fine[v], fine (V, 3)."""
    world = np.zeros((len(out), 3, weights.shape[2]), fine.dtype)
    for v in range(len(corner)):
        fx, fy, fz = fine[v, 0], fine[v, 1], fine[v, 2]
        for c in range(3):
            i = corner[v, c]
            xs, ys, zs, w = world[i, 0], world[i, 1], world[i, 2], weights[v, c]
            for k in range(len(w)):
                xs[k] += w[k] * fx
                ys[k] += w[k] * fy
                zs[k] += w[k] * fz
    for i in range(len(out)):
        for k in range(weights.shape[2]):
            x, y, z = world[i, 0, k], world[i, 1, k], world[i, 2, k]
            out[i, k, 0] = turn[i, 0, 0] * x + turn[i, 1, 0] * y + turn[i, 2, 0] * z
            out[i, k, 1] = turn[i, 0, 1] * x + turn[i, 1, 1] * y + turn[i, 2, 1] * z
            out[i, k, 2] = turn[i, 0, 2] * x + turn[i, 1, 2] * y + turn[i, 2, 2] * z


@njit(cache=True, fastmath=FREE_ORDER)
def carry_over(fine, before, turn, corner, share, out):
    """out (V, 3) = what fine (V, 3) was in the frames `before` (C, 3, 3), in the frames `turn`; share (V, 3)."""
    for v in range(len(corner)):
        fx, fy, fz = fine[v, 0], fine[v, 1], fine[v, 2]
        x = y = z = fx * 0
        for c in range(3):
            i, w = corner[v, c], share[v, c]
            a = w * (before[i, 0, 0] * fx + before[i, 1, 0] * fy + before[i, 2, 0] * fz)
            b = w * (before[i, 0, 1] * fx + before[i, 1, 1] * fy + before[i, 2, 1] * fz)
            n = w * (before[i, 0, 2] * fx + before[i, 1, 2] * fy + before[i, 2, 2] * fz)
            x += turn[i, 0, 0] * a + turn[i, 0, 1] * b + turn[i, 0, 2] * n
            y += turn[i, 1, 0] * a + turn[i, 1, 1] * b + turn[i, 1, 2] * n
            z += turn[i, 2, 0] * a + turn[i, 2, 1] * b + turn[i, 2, 2] * n
        out[v, 0], out[v, 1], out[v, 2] = x, y, z


@njit(cache=True, fastmath=FREE_ORDER)
def scale(fine, values, corner, share, out):
    """out (V, 3) = fine (V, 3), each times the sum over corners i of share[v, i] values[i]; values (C,)."""
    for v in range(len(corner)):
        by = fine[v, 0] * 0
        for c in range(3):
            by += share[v, c] * values[corner[v, c]]
        out[v, 0], out[v, 1], out[v, 2] = by * fine[v, 0], by * fine[v, 1], by * fine[v, 2]


@njit(cache=True)
def turn_into(vectors, turn, out):
    """out (C, 3) = turn[i].T @ vectors[i]: vectors (C, 3) as frames (C, 3, 3), in columns, see them."""
    for i in range(len(out)):
        for c in range(3):
            out[i, c] = (
                turn[i, 0, c] * vectors[i, 0] + turn[i, 1, c] * vectors[i, 1] + turn[i, 2, c] * vectors[i, 2]
            )
