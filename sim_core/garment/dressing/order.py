"""Whether fronts that overlap lie in the order they are meant to: one over the other."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from sim_core.garment.garment import Garment
from sim_core.garment.pattern import SIDES, Pattern

__all__ = ["layer_order", "overlap"]

REACH = 0.03  # [m] within which cloth lies on other cloth
FACING = 0.7  # cosine between the way to other cloth and the outward normal of the wearer: it lies over or under it
SLIGHT = 0.0005  # [m] by which cloth may lie under what it should lie over: the shell's own give


def layer_order(garment: Garment, over: str = "left") -> int:
    """How many vertices of the outer front lie under the inner one.

    Outwards is away from what lies beneath. over: the side of the wearer whose front is outside. 0 of a garment that
    says nothing of its order, or does not say what it lies on.
    """
    under, _ = overlap(garment, over)
    return under


def overlap(garment: Garment, over: str = "left") -> tuple[int, int]:
    """Vertices of the outer front that lie under the inner one, and those that lie over it."""
    pattern = Pattern.from_dict(garment.cut) if garment.cut.get("panels") else None
    if (
        pattern is None
        or garment.settled is None
        or not garment.settled.beneath.surfaces
        or not pattern.mirror
    ):
        return 0, 0
    other = "right" if over == "left" else "left"
    outer, inner = (_front(garment, pattern, f" {side}") for side in (over, other))
    if not len(outer) or not len(inner):
        return 0, 0
    field = garment.settled.beneath.field()
    tree = KDTree(garment.positions[inner])
    away, near = tree.query(garment.positions[outer], distance_upper_bound=REACH)
    close = np.isfinite(away) & (away > 1e-9)
    here, there = garment.positions[outer[close]], garment.positions[inner[np.asarray(near)[close]]]
    _, outward = field.with_gradient(0.5 * (here + there))
    size = np.linalg.norm(outward, axis=1)
    towards = here - there
    height = (towards * outward).sum(1) / np.maximum(size, 1e-9)
    facing = (size > 0.3) & (np.abs(height) > FACING * np.linalg.norm(towards, axis=1))
    return int((facing & (height < -SLIGHT)).sum()), int((facing & (height > SLIGHT)).sum())


def _front(garment: Garment, pattern: Pattern, side: str) -> np.ndarray:
    """Draped vertices of the front panels of one side that no seam shares with the other."""
    assert side in SIDES
    own: list[np.ndarray] = []
    rest: list[np.ndarray] = []
    for number, name in enumerate(garment.panels):
        faces = garment.pattern_faces[garment.panel == number]
        used = np.unique(faces)
        ahead = used[garment.pattern[used, 1] > 0.05]
        (own if name.endswith(side) else rest).append(garment.weld[ahead])
    mine = np.unique(np.concatenate([np.zeros(0, int), *own]))
    others = np.unique(np.concatenate([np.zeros(0, int), *rest]))
    return np.setdiff1d(mine, others)
