"""The quadratic bending energy x.Q.x / 2 of a mesh, exact for every constant curvature on every mesh.

The six points of a triangle and its three neighbours, laid out flat, fix a quadratic: the heights h of the three outer
ones over the triangle's plane are h = A kappa, so its curvature is kappa = A^-1 h and its energy
area/2 kappa.D.kappa, D = diag(Bx, By, 2 sqrt(Bx By)) in (xx, yy, xy), x the weft's way and y the warp's: a plate
without Poisson's effect. A triangle at a border, or one whose six points lie near a conic, takes the mean curvature
of its neighbours, turned from their panels into its own. On equilateral rows this is what the hinges of Bergou et al.
(2006) give at a third of their stiffness, but for nu = 0 instead of -1/3. That is half of convergence; the other half
is `balance.py`.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from sim_core.cloth.sheet.balance import Patches, areas, balance

LEAST_RATIO = 0.12  # of the singular values of A; below, the six points say too little of the curvature
TWIST = np.sqrt(np.array([1.0, 1.0, 2.0]))  # xy counts twice


def bending_matrix(
    corner: np.ndarray,
    faces: np.ndarray,
    face_edges: np.ndarray,
    edges: int,
    bend: np.ndarray,
    count: int,
    *,
    balanced: bool | None = False,
    creases: np.ndarray | None = None,
) -> sparse.csr_array:
    """Q (V, V) [N/m] from the corners of each face in its panel (F, 3, 2) [m]; edges: how many.

    bend (F, 3) [N m]: against curvature xx, yy and (twice) xy. balanced: so that constant curvatures push no vertex
    (`balance.py`); None: unless the mesh is a lattice. creases: edges (k,) across which nothing resists, as if both
    sides ended there.
    """
    twin = _twins(face_edges, edges)
    if creases is not None and len(creases):
        twin[np.isin(face_edges, creases)] = -1
    curved, known = _curvatures(corner, faces, twin, count)
    turns = _turns(corner, faces, twin)
    operator = _lent(curved, known, twin, turns)
    weight = np.sqrt(areas(corner)[:, None] * bend)
    scaled = sparse.csr_array(sparse.diags_array((weight * TWIST).ravel()) @ operator)
    root = None
    if balanced is not False:
        root = balance(Patches(corner, faces, twin, turns, bend, scaled, count), lattices=balanced is True)
    if root is not None:
        found = len(faces)
        scaled = sparse.bsr_array((root, np.arange(found), np.arange(found + 1))).tocsr() @ scaled
    matrix = sparse.csr_array(scaled.T @ scaled)
    # What rounding leaves of entries that cancel would cost the loops as much as any other.
    matrix.data[np.abs(matrix.data) < 1e-12 * np.abs(matrix.data).max(initial=0.0)] = 0.0
    matrix.eliminate_zeros()
    return matrix


def _twins(face_edges: np.ndarray, edges: int) -> np.ndarray:
    """The corner (3 f + c) across every side (F, 3); -1 at a border."""
    side = face_edges.ravel()
    order = np.argsort(side, kind="stable")
    same = np.flatnonzero(side[order][1:] == side[order][:-1])
    twin = np.full(len(side), -1)
    first, second = order[same], order[same + 1]
    twin[first], twin[second] = second, first
    return twin.reshape(-1, 3)


def _curvatures(
    corner: np.ndarray, faces: np.ndarray, twin: np.ndarray, count: int
) -> tuple[sparse.csr_array, np.ndarray]:
    """Curvature (xx, yy, xy) of every face as (3 F, V) times the heights, and which faces have one of their own."""
    found = len(faces)
    rows, heights = np.zeros((found, 3, 3)), []
    for c in range(3):
        # The side opposite corner c, seen by this face and by its twin; along it both are laid together.
        p, q = corner[:, (c + 1) % 3], corner[:, (c + 2) % 3]
        other = np.maximum(twin[:, c], 0)
        face, place = other // 3, other % 3
        start = faces[:, (c + 1) % 3]
        tip = corner[face, place]
        one, two = (place + 1) % 3, (place + 2) % 3
        flip = faces[face, one] != start
        u = corner[face, np.where(flip, two, one)]
        v = corner[face, np.where(flip, one, two)]
        side = ((v - u) ** 2).sum(1)
        along = ((tip - u) * (v - u)).sum(1) / side
        high = np.abs((v - u)[:, 0] * (tip - u)[:, 1] - (v - u)[:, 1] * (tip - u)[:, 0]) / np.sqrt(side)
        normal = np.column_stack([-(q - p)[:, 1], (q - p)[:, 0]]) / np.linalg.norm(q - p, axis=1)[:, None]
        own = ((corner[:, c] - p) * normal).sum(1)
        outer = p + along[:, None] * (q - p) - (np.sign(own) * high)[:, None] * normal
        share = _barycentric(corner, outer)
        square = [
            outer[:, i] * outer[:, j] - np.einsum("fk,fk->f", share, corner[:, :, i] * corner[:, :, j])
            for i, j in ((0, 0), (1, 1), (0, 1))
        ]
        rows[:, c] = np.stack([0.5 * square[0], 0.5 * square[1], square[2]], axis=1)
        heights.append((faces[face, place], share))
    whole = np.all(twin >= 0, axis=1)
    scale = np.abs(rows).max(axis=(1, 2))[:, None, None]
    unit = np.where(whole[:, None, None], rows / np.maximum(scale, 1e-300), np.eye(3))
    singular = np.linalg.svd(unit, compute_uv=False)
    known = whole & (singular[:, 2] > LEAST_RATIO * singular[:, 0])
    inverse = np.zeros_like(rows)
    inverse[known] = np.linalg.inv(rows[known])
    entries, at, vertex = [], [], []
    for c, (tip, share) in enumerate(heights):
        for r in range(3):
            part = inverse[:, r, c]
            for values, index in ((part, tip), *((-part * share[:, k], faces[:, k]) for k in range(3))):
                entries.append(values)
                at.append(3 * np.arange(found) + r)
                vertex.append(index)
    data = (np.concatenate(entries), (np.concatenate(at), np.concatenate(vertex)))
    return sparse.coo_array(data, (3 * found, count)).tocsr(), known


def _barycentric(corner: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Weights (F, 3) of the corners that give the point (F, 2)."""
    a, b, d = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0], point - corner[:, 0]
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    s = (d[:, 0] * b[:, 1] - d[:, 1] * b[:, 0]) / area
    t = (a[:, 0] * d[:, 1] - a[:, 1] * d[:, 0]) / area
    return np.column_stack([1 - s - t, s, t])


def _turns(corner: np.ndarray, faces: np.ndarray, twin: np.ndarray) -> np.ndarray:
    """What makes (xx, yy, xy) of the face across each side one's own: (F, 3, 3, 3), 1 where the panel is the same."""
    out = np.zeros((*twin.shape, 3, 3))
    for c in range(3):
        other = np.maximum(twin[:, c], 0)
        face, place = other // 3, other % 3
        one, two = (place + 1) % 3, (place + 2) % 3
        flip = faces[face, one] != faces[:, (c + 1) % 3]
        first, last = np.where(flip, two, one), np.where(flip, one, two)
        mine = _axes(corner[:, (c + 1) % 3], corner[:, (c + 2) % 3], corner[:, c])
        there = _axes(corner[face, first], corner[face, last], corner[face, place]) * [[[1.0], [-1.0]]]
        a, b, d, e = np.einsum("fki,fkj->ijf", mine, there).reshape(4, -1)
        rows = [[a * a, b * b, 2 * a * b], [d * d, e * e, 2 * d * e], [a * d, b * e, a * e + b * d]]
        out[:, c] = np.moveaxis(np.array(rows), 2, 0)
        out[np.abs(out[:, c] - np.eye(3)).max((1, 2)) < 1e-9, c] = np.eye(3)
    return out


def _axes(p: np.ndarray, q: np.ndarray, tip: np.ndarray) -> np.ndarray:
    """Unit vectors (F, 2, 2) along the side from p to q and across it, towards the tip, (F, 2) each."""
    along = (q - p) / np.linalg.norm(q - p, axis=1)[:, None]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    return np.stack([along, across * np.sign(((tip - p) * across).sum(1))[:, None]], axis=1)


def _lent(
    curved: sparse.csr_array, known: np.ndarray, twin: np.ndarray, turns: np.ndarray
) -> sparse.csr_array:
    """Faces without a curvature of their own take the mean of their neighbours', ring by ring."""
    found = len(known)
    known = known.copy()
    neighbour = np.where(twin >= 0, twin // 3, -1)
    operator = curved
    while not known.all():
        has = (neighbour >= 0) & known[neighbour]
        give = ~known & has.any(1)
        if not give.any():
            break
        row, slot = np.nonzero(has & give[:, None])
        share = 1.0 / has[row].sum(1)
        keep = np.flatnonzero(known)
        index = np.concatenate([keep, row])
        source = np.concatenate([keep, neighbour[row, slot]])
        same = np.broadcast_to(np.eye(3), (len(keep), 3, 3))
        block = np.concatenate([same, share[:, None, None] * turns[row, slot]])
        at, of, entry = np.nonzero(block)
        place = (3 * index[at] + of, 3 * source[at] + entry)
        mix = sparse.coo_array((block[at, of, entry], place), (3 * found, 3 * found)).tocsr()
        operator = sparse.csr_array(mix @ operator)
        known |= give
    return operator
