"""The Laplacian of a flat mesh at its inner edges, and its square: a bending energy that no affine map has."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array, diags_array

from sim_core.learn.topology import border_edges

__all__ = ["squared_laplacian"]


def squared_laplacian(rest: np.ndarray, faces: np.ndarray) -> csr_array:
    """K'M^-1 K (V, V) of a sheet at rest (V, 2) [m], faces (F, 3), with Crouzeix-Raviart elements (Bergou et al. 2006).

    K is the cotangent stiffness at the middles of edges, M their lumped mass, a third of both faces; K x at an edge is
    its length times the jump of the gradient across it. Inner edges alone are summed: the stiffness at vertices does
    not vanish on affine maps at the border, and summed over inner vertices alone leaves the border free to swing.
    On equilateral triangles the energy is the integral of 3 (u_xx + u_yy)^2 - 8 (u_xx u_yy - u_xy^2), of which the
    second term acts at the border alone. Raises SimCoreError for a mesh that branches.
    """
    border_edges(faces, len(rest))
    a, b, c = (
        np.concatenate([faces[:, (k + turn) % 3] for k in range(3)]).astype(np.int64) for turn in range(3)
    )
    key = np.minimum(a, b) * len(rest) + np.maximum(a, b)
    order = np.argsort(key, kind="stable")
    twin = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    first, second = order[twin], order[twin + 1]
    a, b, c, d = a[first], b[first], c[first], c[second]
    along = rest[b] - rest[a]
    length2 = (along**2).sum(1)
    rows, columns, values = [], [], []
    twice_area = np.zeros(len(a))
    for apex in (c, d):
        away = rest[apex] - rest[a]
        foot = (away * along).sum(1) / length2
        double = np.abs(along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0])
        slope = length2 / double  # length over height: length times the gradient across the edge
        twice_area += double
        rows += [np.arange(len(a))] * 3
        columns += [apex, a, b]
        values += [slope, -slope * (1.0 - foot), -slope * foot]
    jump = csr_array(
        (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(len(a), len(rest))
    )
    return csr_array(jump.T @ diags_array(6.0 / twice_area) @ jump)
