"""Panels as one sheet: open or closed, whole or as the half of a mirror image.

Of a half the middle lies in x = 0, and rings of images continue it there.

The images take the places their masters have, so that membrane and bending across the middle are those of the whole
garment, at half the price, and both halves come out equal to the bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim_core.cloth import Material, Sheet
from sim_core.cloth.sheet import evened
from sim_core.garment.garment_sheet import APART
from sim_core.garment.pattern import Cloth

__all__ = ["SewnSheet", "sewn_sheet"]

RINGS = 3  # of images: what bends at the middle is a face, its neighbours, and at a border theirs


@dataclass(frozen=True)
class SewnSheet:
    """A sheet of panels, of one half with images.

    number: (P,) sheet vertex of each pattern vertex; middle: (M,) sheet vertices held on x = 0; slaves:
    (K, 2) image and master; real: how many vertices are no images. A whole garment has neither middle nor images.
    """

    sheet: Sheet
    number: np.ndarray
    middle: np.ndarray
    slaves: np.ndarray
    real: int

    def gathered(self, positions: np.ndarray) -> np.ndarray:
        """Sheet positions (V, 3), images included, from positions (P, 3) of the pattern vertices: the mean of twins."""
        out = np.zeros((self.real, 3))
        count = np.bincount(self.number, minlength=self.real)
        for axis in range(3):
            out[:, axis] = np.bincount(self.number, positions[:, axis], self.real) / count
        out[self.middle, 0] = 0.0
        return np.concatenate([out, out[self.slaves[:, 1]] * [-1.0, 1.0, 1.0]])


def sewn_sheet(
    cloth: Cloth,
    number: np.ndarray,
    materials: Sequence[Material],
    kind: np.ndarray,
    apart: np.ndarray,
    *,
    even: bool = True,
    creases: np.ndarray | None = None,
) -> SewnSheet:
    """The cloth as a sheet whose twins under `number` (P,) are one; kind (F,) of material, apart (F,) layers of it.

    even: with its mass shared out so that time steps are longer (`cloth.sheet.evened`). creases: pairs (K, 2) of
    pattern vertices along the folds of pleats.
    """
    faces = number[cloth.faces]
    corner = cloth.vertices[cloth.faces] + APART * apart[:, None, None] * np.array([1.0, 0.0])
    middle = np.unique(number[cloth.middle])
    on = np.zeros(number.max() + 1, bool)
    on[middle] = True
    ring, near = on[faces].any(1), on.copy()
    for _ in range(RINGS - 1):
        near[faces[ring]] = True
        ring = near[faces].any(1)
    masters = np.setdiff1d(np.unique(faces[ring]), middle)
    image = np.arange(len(on))
    image[masters] = len(on) + np.arange(len(masters))
    whole = np.concatenate([faces, image[faces[ring]][:, [0, 2, 1]]])
    corners = np.concatenate([corner, (corner[ring] * [-1.0, 1.0])[:, [0, 2, 1]]])
    kinds = np.r_[kind, kind[ring]]
    folded = None if creases is None else number[creases]
    if folded is not None:
        folded = np.concatenate([folded, image[folded]])
    sheet = Sheet.of_corners(corners, whole, materials, kinds, creases=folded)
    if even:
        density = np.array([material.density for material in materials])
        sheet = evened(sheet, density[kinds], own=len(on))
    slaves = np.column_stack([image[masters], masters]).astype(np.int32)
    return SewnSheet(sheet, number, middle, slaves, len(on))
