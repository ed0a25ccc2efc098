"""Which of an outfit's layers is the garment one comes to see: a belt over a robe is an accessory to it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

__all__ = ["ACCESSORY", "cloth_area", "garment_at"]

# [m2] of cloth: belts, sashes and cords have less, and the least of dresses, a bodice, has more.
ACCESSORY = 0.25


def garment_at(areas: Sequence[float]) -> int:
    """The place of the outermost layer that is no accessory, by the cloth [m2] of each layer from the skin outwards;
    of accessories alone the outermost."""
    garments = [k for k, area in enumerate(areas) if area >= ACCESSORY]
    return garments[-1] if garments else len(areas) - 1


def cloth_area(pattern: Any, faces: Any) -> float:
    """What faces (F, 3) of a flat pattern (P, 2) [m] measure, in m2."""
    first, second, third = (np.asarray(pattern)[np.asarray(faces)[:, k]] for k in range(3))
    u, v = second - first, third - first
    return float(0.5 * np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum())
