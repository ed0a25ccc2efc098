"""Closed triangle meshes from a sampled distance: one vertex per cell the surface passes (surface nets)."""

from __future__ import annotations

import numpy as np

__all__ = ["split_quads", "surface_net"]


def surface_net(
    values: np.ndarray, axes: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """The surface values = 0 of samples (nx, ny, nz) at the lines axes (each increasing [m]), negative inside.

    Returns vertices (V, 3), each the mean of its cell's edge crossings, and quads (Q, 4) int32, closed and
    counter-clockwise from outside wherever the surface stays off the border (Gibson 1998).
    """
    inside = values < 0
    shape = np.array(values.shape) - 1
    total, count = np.zeros((*shape, 3)), np.zeros(shape)
    quads = []
    cell_number = np.arange(shape.prod()).reshape(shape)
    for axis in range(3):
        low = [slice(None)] * 3
        high = [slice(None)] * 3
        low[axis], high[axis] = slice(0, -1), slice(1, None)
        a, b = values[tuple(low)], values[tuple(high)]
        node = np.argwhere(inside[tuple(low)] != inside[tuple(high)])
        # Edges on the border have no four cells around them.
        others = [c for c in range(3) if c != axis]
        node = node[((node[:, others] > 0) & (node[:, others] < shape[others])).all(1)]
        first, second = a[tuple(node.T)], b[tuple(node.T)]
        point = np.stack([axes[c][node[:, c]] for c in range(3)], axis=1).astype(float)
        share = first / (first - second)
        point[:, axis] += share * (axes[axis][node[:, axis] + 1] - axes[axis][node[:, axis]])
        around = []
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for du, dv in ((-1, -1), (0, -1), (0, 0), (-1, 0)):
            cell = node.copy()
            cell[:, u] += du
            cell[:, v] += dv
            np.add.at(total, tuple(cell.T), point)
            np.add.at(count, tuple(cell.T), 1.0)
            around.append(cell_number[tuple(cell.T)])
        quad = np.stack(around, axis=1)
        quads.append(np.where((first < 0)[:, None], quad, quad[:, ::-1]))
    quad = np.concatenate(quads)
    used, index = np.unique(quad, return_inverse=True)
    vertices = (total.reshape(-1, 3)[used]) / count.reshape(-1)[used, None]
    return vertices, index.reshape(-1, 4).astype(np.int32)


def split_quads(vertices: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Triangles (2 Q, 3) int32 of quads (Q, 4), each cut along its shorter diagonal."""
    apart = [((vertices[quads[:, i]] - vertices[quads[:, i + 2]]) ** 2).sum(1) for i in (0, 1)]
    across = (apart[0] <= apart[1])[:, None]
    first = np.where(across, quads[:, [0, 1, 2]], quads[:, [0, 1, 3]])
    second = np.where(across, quads[:, [0, 2, 3]], quads[:, [1, 2, 3]])
    return np.concatenate([first, second]).astype(np.int32)
