"""Is a triangulation (constrained) Delaunay? Decided with rational numbers, without any of the project's predicates."""

from fractions import Fraction

import numpy as np

UNIT = 2.0**-53


def orient_sign(a, b, c) -> int:
    """Sign of the area of a, b, c by rational numbers."""
    (ax, ay), (bx, by), (cx, cy) = (tuple(Fraction(float(v)) for v in p) for p in (a, b, c))
    total = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return (total > 0) - (total < 0)


def incircle_sign(a, b, c, d) -> int:
    """1 where d lies inside the circle of a, b, c (counter-clockwise), 0 on it, -1 outside; by rationals."""
    dx, dy = (Fraction(float(v)) for v in d)
    rows = []
    for p in (a, b, c):
        x, y = Fraction(float(p[0])) - dx, Fraction(float(p[1])) - dy
        rows.append((x, y, x * x + y * y))
    (a1, a2, a3), (b1, b2, b3), (c1, c2, c3) = rows
    total = a1 * (b2 * c3 - b3 * c2) - a2 * (b1 * c3 - b3 * c1) + a3 * (b1 * c2 - b2 * c1)
    return (total > 0) - (total < 0)


def delaunay_faults(vertices, faces, constraints=()) -> list[str]:
    """What is wrong with a triangulation of vertices (V, 2), y down; constraints: pairs of indices no test applies to.

    A triangulation is (constrained) Delaunay exactly when all triangles are positive and every edge that is no
    constraint is locally so: the point across lies not inside the circle. A float estimate with a generous bound
    decides clear cases, rational numbers the others. Ties (sign 0) are no fault.
    """
    up = np.asarray(vertices, dtype=float) * (1.0, -1.0)
    faces = np.asarray(faces)
    faults = []
    a, b, c = (up[faces[:, k]] for k in range(3))
    u, v = b - a, c - a
    area, size = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], np.abs(u[:, 0] * v[:, 1]) + np.abs(u[:, 1] * v[:, 0])
    for k in np.flatnonzero(area <= 16 * UNIT * size):
        if orient_sign(*up[faces[k]]) <= 0:
            faults.append(f"face {k} is not positive")
    fixed = {(min(p), max(p)) for p in np.asarray(constraints).reshape(-1, 2).tolist()}
    ahead = np.concatenate([faces[:, [0, 1, 2]], faces[:, [1, 2, 0]], faces[:, [2, 0, 1]]]).astype(np.int64)
    count = len(up)
    order = np.argsort(ahead[:, 0] * count + ahead[:, 1], kind="stable")
    keys = (ahead[:, 0] * count + ahead[:, 1])[order]
    if (keys[1:] == keys[:-1]).any():
        faults.append("an edge is used twice in one direction")
    wanted = ahead[:, 1] * count + ahead[:, 0]
    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    paired = (keys[at] == wanted) & (ahead[:, 0] < ahead[:, 1])
    quads = np.column_stack(
        [ahead[paired], ahead[order[at[paired]], 2]]
    )  # a b c counter-clockwise, d across a b
    d = up[quads[:, 3]]
    rows = [up[quads[:, k]] - d for k in range(3)]
    lift = [(r**2).sum(axis=1) for r in rows]
    total, size = np.zeros(len(quads)), np.zeros(len(quads))
    for k in range(3):
        p, q = rows[(k + 1) % 3], rows[(k + 2) % 3]
        total += lift[k] * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
        size += lift[k] * (np.abs(p[:, 0] * q[:, 1]) + np.abs(p[:, 1] * q[:, 0]))
    for k in np.flatnonzero(total >= -64 * UNIT * size):
        i, j = int(quads[k, 0]), int(quads[k, 1])
        if (min(i, j), max(i, j)) not in fixed and incircle_sign(*up[quads[k]]) > 0:
            faults.append(f"edge {i}-{j} is not Delaunay")
    return faults
