"""Bending in balance: no force on any vertex of a sheet of constant curvature, on irregular meshes too.

That the energy of every constant curvature is right (`bending.py`) is half of what convergence takes. The other half is
the patch test: bent to a constant curvature, a sheet must not push its inner vertices up or down. On irregular meshes
the six-point patches do, the sheet gives way by a share of every triangle, and stays too soft by some percent however
fine the mesh is. So each triangle's stiffness becomes area (1 + X) instead of area, X symmetric, for curvatures scaled
by the roots of the stiffness: the smallest X (sum of area |X|^2) for which inner vertices feel nothing, vertices at a
straight border nothing of the curvature along it (the one that a free border bears), and the mean of X over every
cluster of triangles vanishes, which keeps the energy. The patches, so also the entries of Q, are the same ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

ENTRIES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))  # of X
TIMES = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # how often each stands in X
CLUSTER = 32  # faces, at most
MOST = 0.75  # aim for X's eigenvalues: faces beyond it are spared
SOFTEST = 0.9  # beyond this, X of the whole cluster is made smaller
ROUNDS, STEPS = 5, 200  # of sparing, and of conjugate gradients
LEFT = 3e-3  # share of the forces that may be left: what a sheet gives way by goes with its square
STRAIGHT = 1.0 - 1e-6  # share of one direction in the border around a vertex: within a tenth of a degree
WORTH = 0.3  # share of the forces that may be left after all: else patches stay as they are
CONGRUENT = 0.25  # of a lattice's faces, at least: those of a few columns at its sides are not
ALIKE = 1e-6  # relative difference of sides and forces that is none


@dataclass(frozen=True)
class Patches:
    """What the curvature of every face is made of; F faces, V vertices.

    corner (F, 3, 2) [m], faces (F, 3), twin (F, 3): the corner across each side, -1 at a border, turns (F, 3, 3, 3),
    bend (F, 3) [N m], operator (3 F, V): curvatures times the roots of stiffness and area, count: V.
    """

    corner: np.ndarray
    faces: np.ndarray
    twin: np.ndarray
    turns: np.ndarray
    bend: np.ndarray
    operator: sparse.csr_array
    count: int


def balance(patches: Patches, *, lattices: bool = False) -> np.ndarray | None:
    """The roots (F, 3, 3) of 1 + X; None where nothing is to be done, or little came of it: lattices stay as they
    are unless asked for."""
    if patches.operator.nnz == 0:
        return None
    area, group = areas(patches.corner), _groups(patches)
    seen = _seen(patches)
    force, forces = _forces(patches, area)
    kinds = _kinds(patches, seen)
    if not lattices and _lattice(patches, force, kinds[0], seen):
        return None
    rule, wanted = _rules(patches, force, forces, kinds)
    clusters = _clusters(patches.corner.mean(1), group)
    means = sparse.coo_array(
        (np.ones(6 * len(area)), _sixfold(clusters, np.arange(len(area)))),
        (6 * (clusters.max() + 1), 6 * len(area)),
    )
    means = means.tocsr() @ sparse.diags_array(np.repeat(area, 6))
    rules = sparse.csr_array(sparse.vstack([rule, means]))
    wanted = np.concatenate([wanted, np.zeros(means.shape[0])])
    size = np.sqrt(np.asarray(rules.multiply(rules).sum(1)).ravel())
    keep = size > 0
    rules = sparse.csr_array(sparse.diags_array(1 / size[keep]) @ rules[np.flatnonzero(keep)])
    wanted = wanted[keep] / size[keep]
    change = _bounded(_smallest(rules, wanted, area), clusters, area)
    entries = np.column_stack([change[:, p, q] for p, q in ENTRIES]).ravel()
    left = rules @ entries - wanted
    if (left * left).sum() > WORTH**2 * (wanted * wanted).sum():
        return None
    return _roots(change)


def areas(corner: np.ndarray) -> np.ndarray:
    """Areas (F,) [m2] of triangles with these corners (F, 3, 2) [m]."""
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    return 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _plain(patches: Patches) -> np.ndarray:
    """(F, 3): across this side lies the same panel and the same cloth (or nothing)."""
    other = np.maximum(patches.twin, 0) // 3
    same = (np.abs(patches.turns - np.eye(3)).max((2, 3)) == 0) & (
        patches.bend[other] == patches.bend[:, None]
    ).all(2)
    return same | (patches.twin < 0)


def _groups(patches: Patches) -> np.ndarray:
    """Which panel (F,) of one cloth each face belongs to."""
    face, side = np.nonzero(_plain(patches) & (patches.twin >= 0))
    count = len(patches.faces)
    joined = sparse.coo_array((np.ones(len(face)), (face, patches.twin[face, side] // 3)), (count, count))
    return connected_components(joined, directed=False)[1]


def _seen(patches: Patches) -> sparse.csr_array:
    """(V, F): whose curvature depends on this vertex."""
    entry = sparse.coo_array(patches.operator)
    shape = (patches.count, len(patches.faces))
    found = sparse.coo_array((np.ones(entry.nnz), (entry.col, entry.row // 3)), shape).tocsr()
    found.data[:] = 1.0
    return found


def _forces(patches: Patches, area: np.ndarray) -> tuple[np.ndarray, sparse.csr_array]:
    """What each constant curvature does to every vertex: (V, 3) as it is, and (3 V, 6 F) times the entries of X."""
    entry = sparse.coo_array(patches.operator)
    face, of = np.divmod(entry.row, 3)
    value, count = np.sqrt(area[face]) * entry.data, patches.count
    force = np.zeros((count, 3))
    np.add.at(force, (entry.col, of), value)
    rows, columns, values = [], [], []
    for number, (p, q) in enumerate(ENTRIES):
        for one, two in {(p, q), (q, p)}:
            here = of == two
            rows.append(3 * entry.col[here] + one)
            columns.append(6 * face[here] + number)
            values.append(value[here])
    parts = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    return force, sparse.coo_array(parts, (3 * count, 6 * len(patches.faces))).tocsr()


def _kinds(patches: Patches, seen: sparse.csr_array) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices all around which cloth lies, those at one straight border, and (V, 2) the way that one runs."""
    corner, twin = patches.corner, patches.twin
    mixed = seen @ (~_plain(patches)).any(1).astype(float) > 0
    border = np.zeros((len(corner), 3))
    for c in range(3):
        side = corner[:, (c + 2) % 3] - corner[:, (c + 1) % 3]
        side = side / np.linalg.norm(side, axis=1)[:, None]
        way = np.column_stack([side[:, 0] ** 2, side[:, 1] ** 2, side[:, 0] * side[:, 1]])
        border += np.where(twin[:, c, None] < 0, way, 0.0)
    xx, yy, xy = (seen @ border).T
    whole = xx + yy
    middle, spread = 0.5 * whole, np.hypot(0.5 * (xx - yy), xy)
    angle = 0.5 * np.arctan2(2 * xy, xx - yy)
    straight = (whole > 0) & (middle + spread > STRAIGHT * whole)
    return (whole == 0) & ~mixed, straight & ~mixed, np.column_stack([np.cos(angle), np.sin(angle)])


def _lattice(patches: Patches, force: np.ndarray, inside: np.ndarray, seen: sparse.csr_array) -> bool:
    """Six faces around every vertex within, many congruent, and nothing among these alone out of balance."""
    faces, twin, count = patches.faces, patches.twin, len(force)
    around = np.bincount(faces.ravel(), minlength=count)
    at_border = np.zeros(count, bool)
    for c in range(3):
        at_border[faces[twin[:, c] < 0][:, [(c + 1) % 3, (c + 2) % 3]]] = True
    side = patches.corner - np.roll(patches.corner, 1, axis=1)
    length = np.sort(np.sqrt((side**2).sum(2)), axis=1)
    same = np.abs(length - np.median(length, axis=0)).max(1) < ALIKE * length.max()
    if (around[~at_border] != 6).any() or same.mean() < CONGRUENT:
        return False
    same &= (twin >= 0).all(1) & same[np.maximum(twin, 0) // 3].all(1)
    quiet = inside & (seen @ (~same).astype(float) == 0)
    scale = np.abs(patches.operator.data).max() * np.sqrt(areas(patches.corner).max())
    return not quiet.any() or bool(np.abs(force[quiet]).max() < ALIKE * scale)


def _rules(
    patches: Patches, force: np.ndarray, forces: sparse.csr_array, kinds: tuple
) -> tuple[sparse.csr_array, np.ndarray]:
    """Rows times X, and what they must give, for nothing to push: three a vertex inside, one at a border."""
    inside, along, way = kinds
    bend = np.zeros((len(force), 3))
    bend[patches.faces] = patches.bend[:, None]
    three = (3 * np.flatnonzero(inside)[:, None] + np.arange(3)).ravel()
    at = np.flatnonzero(along & (bend > 0).all(1))
    # A free border bears the moment along itself alone; its curvatures, times the roots of the stiffness.
    t = way[at]
    moment = np.column_stack([t[:, 0] ** 2, t[:, 1] ** 2, np.sqrt(2) * t[:, 0] * t[:, 1]]) / np.sqrt(bend[at])
    moment /= np.linalg.norm(moment, axis=1)[:, None]
    where = (np.repeat(np.arange(len(at)), 3), (3 * at[:, None] + np.arange(3)).ravel())
    pick = sparse.coo_array((moment.ravel(), where), (len(at), 3 * len(force))).tocsr()
    rules = sparse.vstack([forces[three], sparse.csr_array(pick @ forces)])
    return sparse.csr_array(rules), -np.concatenate([force.ravel()[three], pick @ force.ravel()])


def _clusters(middle: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Which cluster (F,) a face of this middle (F, 2) belongs to: panels halved across until they are small."""
    out, number = np.zeros(len(middle), int), 0
    order = np.argsort(group, kind="stable")
    heap = np.split(order, np.flatnonzero(np.diff(group[order])) + 1)
    while heap:
        part = heap.pop()
        if len(part) <= CLUSTER:
            out[part] = number
            number += 1
            continue
        axis = np.argmax(np.ptp(middle[part], axis=0))
        part = part[np.argsort(middle[part, axis], kind="stable")]
        heap += [part[: len(part) // 2], part[len(part) // 2 :]]
    return out


def _sixfold(row: np.ndarray, column: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return (6 * row[:, None] + np.arange(6)).ravel(), (6 * column[:, None] + np.arange(6)).ravel()


def _smallest(rules: sparse.csr_array, wanted: np.ndarray, area: np.ndarray) -> np.ndarray:
    """The smallest X (F, 3, 3) that keeps the rules; where it is too large for a face, one that spares this face."""
    cost = area.copy()
    change, pull = np.zeros((len(area), 3, 3)), np.zeros(len(wanted))
    for _ in range(ROUNDS):
        ease = 1 / (np.repeat(cost, 6) * np.tile(TIMES, len(area)))
        pull = _solved(rules, ease, wanted, pull)
        entries = ease * (rules.T @ pull)
        for number, (p, q) in enumerate(ENTRIES):
            change[:, p, q] = change[:, q, p] = entries[number::6]
        largest = np.abs(np.linalg.eigvalsh(change)).max(1)
        if largest.max() <= MOST:
            break
        cost *= np.maximum(1.0, largest / (0.8 * MOST)) ** 2
    return change


def _bounded(change: np.ndarray, clusters: np.ndarray, area: np.ndarray) -> np.ndarray:
    """X with a mean of nothing over every cluster, to rounding, and no face softer than 1 - SOFTEST."""
    count = clusters.max() + 1
    weight = np.bincount(clusters, area, count)
    for p, q in ENTRIES:
        mean = np.bincount(clusters, area * change[:, p, q], count) / weight
        change[:, p, q] = change[:, q, p] = change[:, p, q] - mean[clusters]
    deepest = np.zeros(count)
    np.maximum.at(deepest, clusters, np.abs(np.linalg.eigvalsh(change)).max(1))
    return change * np.minimum(1.0, SOFTEST / np.maximum(deepest, 1e-9))[clusters, None, None]


def _solved(rules: sparse.csr_array, ease: np.ndarray, wanted: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Multipliers by conjugate gradients; sums are NumPy's own: a BLAS rounds by its number of threads."""
    back = sparse.csr_array(rules.T)
    scale = 1 / (rules.multiply(rules) @ ease)
    at, left = start.copy(), wanted - rules @ (ease * (back @ start))
    way = scale * left
    old, goal = (left * way).sum(), LEFT**2 * (wanted * scale * wanted).sum()
    for _ in range(STEPS):
        if old <= goal:
            break
        push = rules @ (ease * (back @ way))
        step = old / (way * push).sum()
        at += step * way
        left -= step * push
        eased = scale * left
        new = (left * eased).sum()
        way = eased + new / old * way
        old = new
    return at


def _roots(change: np.ndarray) -> np.ndarray:
    value, vector = np.linalg.eigh(change)
    return np.einsum("fik,fk,fjk->fij", vector, np.sqrt(1 + value), vector)
