"""A start that is no sheet is made one: points thrown about are smoothed until they are a sheet again.

Where most edges are far longer than at rest and neighbouring faces do not lie alike, positions say where the cloth is
but nothing of its shape. What the membrane's forces make of them is a crumple that passes through itself and, without
self-contact, stays so. Such a start x0 is replaced, pins kept, by the x of least

    |x - x0|^2 + l^4 (curvature of x)^2,

both over the sheet's area: a low pass of fourth order with the cut-off 1/l (after Whittaker 1923, with the bending
matrix of a plate in place of differences), which leaves every affine map as it is. Averaging also shrinks; so the
nearest sheet that is hardly stretched is found by a few rounds that turn each face as it lies and solve for all of them
together (as-rigid-as-possible, Sorkine & Alexa 2007). l is doubled until edges are within a tenth of their length.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy import sparse

from sim_core.cloth.contact.layers.crossings import faces_at_edges
from sim_core.cloth.sheet.bending import bending_matrix
from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.factor import Factored

LONGER = 1.25  # times its length, that more than half of the edges of a hopeless start are longer than
ALIKE = 0.5  # mean cosine between neighbouring faces' normals, below: noise of half an edge has .4, a gale's folds .6
FEWEST = 20  # edges between two faces: of fewer any may be folded
EVEN = 1.1  # times its length: most edges may be no longer, nor shorter by as much, for the smoothing to end
MOST = 0.95  # of the edges: a vertex that belongs to no curvature, at a corner say, stays where it was thrown
GIVEN = 2.0  # times its length, or its half, that any edge may be of in a start that is given instead
ROUNDS = 8  # of turning faces
FIRM = 10.0  # stretch against the distance from the start, on the scale of the whole sheet


def hopeless(sheet: Sheet, x: np.ndarray) -> bool:
    """Whether x (V, 3) [m] is no sheet: most edges a quarter too long, faces turned anyhow.

    Neither alone: cloth may be stretched, and it may be crumpled; in no gale looked at it was both.
    """
    if 2 * np.count_nonzero(_longer(sheet, x) > LONGER) <= len(sheet.edges):
        return False
    third = faces_at_edges(sheet.edges, sheet.faces)
    inner = third[:, 1] >= 0
    a, b, c, d = (x[k] for k in (*sheet.edges[inner].T, *third[inner].T))
    one, two = np.cross(b - a, c - a), np.cross(d - a, b - a)
    size = np.linalg.norm(one, axis=1) * np.linalg.norm(two, axis=1)
    cosine = (one * two).sum(1) / np.maximum(size, 1e-300)
    return bool(len(cosine) >= FEWEST and cosine.mean() < ALIKE)


def smoothed(sheet: Sheet, start: np.ndarray, pins: Sequence[int] | np.ndarray) -> tuple[np.ndarray, float]:
    """A sheet near a hopeless start (V, 3) [m] that passes through itself nowhere, pins where they were.

    Also the length l [m] over which it was smoothed; the start itself and 0 where it is not hopeless, or where no
    such sheet is found. The centre of mass of a sheet without pins stays. Same input, same bits on one
    machine.
    """
    if not hopeless(sheet, start) or len(set(pins)) == len(start):
        return start, 0.0
    from sim_core.metrics import intersections  # what only bad starts need

    smoother = Smoother(sheet, start, np.asarray(pins, np.int64))
    length, last = 2 * float(np.sqrt(sheet.stencil.length2).mean()), 2 * float(np.sqrt(smoother.area))
    while True:
        smooth = smoother.low_pass(length)
        if np.quantile(_longer(sheet, smooth), MOST) < (EVEN if length < last else GIVEN):
            x = smoother.unstretched(length, smooth)
            longer = _longer(sheet, x)
            low, high = np.quantile(longer, [1 - MOST, MOST])
            fair = 1 / GIVEN < longer.min() and longer.max() < GIVEN
            even = length >= last or (1 / EVEN < low and high < EVEN)
            if fair and even and not intersections(x, sheet.faces):
                return x, length
        if length >= last:
            return start, 0.0
        length *= 2


def _longer(sheet: Sheet, x: np.ndarray) -> np.ndarray:
    """Every edge's length (E,) at x (V, 3), as a share of that at rest."""
    ends = sheet.edges
    return np.sqrt(((x[ends[:, 0]] - x[ends[:, 1]]) ** 2).sum(1) / sheet.stencil.length2)


class Smoother:
    """The matrices of one sheet and one start; all unknowns are the vertices that are not pinned."""

    def __init__(self, sheet: Sheet, start: np.ndarray, pins: np.ndarray) -> None:
        corner, faces, count = sheet.corner, sheet.faces, len(sheet.mass)
        plate = np.ones((len(faces), 3))  # the same along warp and weft: smooth is what is meant
        self.bend = bending_matrix(corner, faces, sheet.face_edges, len(sheet.edges), plate, count)
        sides = np.stack([corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]], axis=2)
        areas = 0.5 * np.abs(np.linalg.det(sides))
        self.area = float(areas.sum())
        self.slope = _slopes(np.linalg.inv(sides), faces, count)
        self.spread = sparse.csr_array(self.slope.T @ sparse.diags_array(np.repeat(areas, 2)))
        self.weight = sheet.mass * (self.area / sheet.mass.sum())  # of mass: its centre stays
        self.start, self.free = start, np.setdiff1d(np.arange(count), pins)

    def low_pass(self, length: float) -> np.ndarray:
        """The start without what is shorter than `length` [m] times 2 pi."""
        return self._solver(self._smooth(length))(self.weight[:, None] * self.start)

    def unstretched(self, length: float, x: np.ndarray) -> np.ndarray:
        """The sheet of its own measures nearest to the start, as smooth as that, found from x (V, 3)."""
        firm = FIRM * self.area
        solve = self._solver(self._smooth(length) + firm * (self.spread @ self.slope))
        for _ in range(ROUNDS):
            gradient = (self.slope @ x).reshape(-1, 2, 3)
            u, _, v = np.linalg.svd(gradient, full_matrices=False)
            turned = (u @ v).reshape(-1, 3)  # of all pairs of unit vectors at right angles the nearest
            x = solve(self.weight[:, None] * self.start + firm * (self.spread @ turned))
        return x

    def _smooth(self, length: float) -> sparse.csr_array:
        return sparse.csr_array(sparse.diags_array(self.weight) + length**4 * self.bend)

    def _solver(self, matrix: sparse.csr_array) -> Callable[[np.ndarray], np.ndarray]:
        rows, free = matrix[self.free], self.free
        factored = Factored(rows[:, free].tocsc())
        held = self.start.copy()
        held[free] = 0.0
        known = rows @ held

        def solve(right: np.ndarray) -> np.ndarray:
            out = self.start.copy()
            out[free] = factored.solve(np.ascontiguousarray(right[free] - known))
            return out

        return solve


def _slopes(inverse: np.ndarray, faces: np.ndarray, count: int) -> sparse.csr_array:
    """The gradient (2 F, V) [1/m] of what is linear on every face; inverse (F, 2, 2) of its two sides as columns."""
    hat = np.concatenate([-inverse.sum(1, keepdims=True), inverse], axis=1)  # (F, corner, direction)
    row = np.broadcast_to((2 * np.arange(len(faces)))[:, None, None] + np.arange(2), hat.shape)
    column = np.broadcast_to(faces[:, :, None], hat.shape)
    return sparse.coo_array((hat.ravel(), (row.ravel(), column.ravel())), (2 * len(faces), count)).tocsr()
