"""One half of a mirrored garment as a sheet: its middle lies in x = 0, rings of images continue it there.

The images take the places their masters have, so that membrane and bending across the middle are those of the whole
garment, at half the price, and both halves come out equal to the bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim_core.cloth import Holds, Material, Sheet
from sim_core.cloth.sheet.mass_lumping import evened
from sim_core.garment.pattern.cloth import Cloth

__all__ = ["Half", "half_sheet", "whole_holds"]

RINGS = 3  # of images: what bends at the middle is a face, its neighbours, and at a border theirs
APART = 5.0  # [m] panels that overlap in pattern axes are laid apart for what counts as one stretch of cloth


@dataclass(frozen=True)
class Half:
    """A sheet of one half with images.

    number: (P,) sheet vertex of each pattern vertex; middle: (M,) sheet vertices on x = 0; slaves: (K, 2) image and
    master; real: how many vertices are no images.
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


def half_sheet(
    cloth: Cloth,
    number: np.ndarray,
    materials: Sequence[Material],
    kind: np.ndarray,
    apart: np.ndarray,
    *,
    even: bool = False,
) -> Half:
    """The half as a sheet whose twins under `number` (P,) are one; kind (F,) of material, apart (F,) layers of it.

    even: with its mass shared out so that time steps are longer (`cloth.evening`).
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
    sheet = Sheet.of_corners(corners, whole, materials, kinds)
    if even:
        density = np.array([material.density for material in materials])
        sheet = evened(sheet, density[kinds], own=len(on))
    slaves = np.column_stack([image[masters], masters]).astype(np.int32)
    return Half(sheet, number, middle, slaves, len(on))


def whole_holds(holds: Holds, half: Half, cloth: Cloth) -> Holds:
    """The holds of one half and its mirror image, of the draped vertices of both: bounds and the limit of lengths."""
    weld = cloth.mirrored().closed
    count, own = int(weld.max()) + 1, len(cloth.vertices)
    low, high = np.full(count, -np.inf), np.full(count, np.inf)
    if len(holds.low):
        low[weld[:own]], high[weld[:own]] = holds.low[half.number], holds.high[half.number]
        low[weld[own:]], high[weld[own:]] = -holds.high[half.number], -holds.low[half.number]
    return Holds.of(count, low=low, high=high, limit=holds.limit)
