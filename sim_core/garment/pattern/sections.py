"""How wide a garment is where a limb lies in it: closed sections of the sewn cloth as it is laid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.garment.pattern.cloth import Cloth
from sim_core.metrics import components

__all__ = ["Section", "sections"]


@dataclass(frozen=True)
class Section:
    """A closed line round a garment: its length [m] in the cloth, lowest and highest corner (3,) [m] as it is laid."""

    length: float
    low: np.ndarray
    high: np.ndarray


def sections(cloth: Cloth, laid: np.ndarray, axis: int, at: float) -> list[Section]:
    """Where the closed cloth, laid (P, 3) [m], is cut across `axis` at a coordinate [m]; open lines are left out.

    Seams count as sewn: what lies on both sides of one lies in their middle. Lengths are those of the cloth, however it
    is laid.
    """
    count = np.bincount(cloth.closed)
    sewn = np.stack([np.bincount(cloth.closed, laid[:, c]) / count for c in range(3)], axis=1)
    height = sewn[:, axis] - at
    height = np.where(height == 0.0, 1e-12, height)  # a plane through a vertex passes just below it
    faces = cloth.closed[cloth.faces]
    above = height[faces] > 0
    cut = np.flatnonzero(above.any(1) & ~above.all(1))
    if not len(cut):
        return []
    ends = np.stack([faces[cut], np.roll(faces[cut], -1, axis=1)], axis=2)  # (C, 3, 2) of each side
    rest = cloth.vertices[cloth.faces[cut]]
    here, there = (height[ends[:, :, k]] for k in range(2))
    crossing = (here > 0) != (there > 0)
    share = here / np.where(crossing, here - there, 1.0)
    point = rest + share[:, :, None] * (np.roll(rest, -1, axis=1) - rest)
    place = sewn[ends[:, :, 0]] + share[:, :, None] * (sewn[ends[:, :, 1]] - sewn[ends[:, :, 0]])
    rows = np.nonzero(crossing)
    pairs = point[rows].reshape(-1, 2, 2)
    length = np.linalg.norm(pairs[:, 1] - pairs[:, 0], axis=1)
    sides = np.sort(ends[rows], axis=1)
    _, number, shared = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    number = number.reshape(-1, 2)  # the two sides each face is entered and left by
    of_side = components(len(shared), number[:, 0], number[:, 1])
    of_face = of_side[number[:, 0]]
    open_ = np.unique(of_side[shared != 2])
    corners = place[rows].reshape(-1, 2, 3)
    out = []
    for part in np.setdiff1d(np.unique(of_face), open_):
        own = corners[of_face == part].reshape(-1, 3)
        out.append(Section(float(length[of_face == part].sum()), own.min(0), own.max(0)))
    return out
