"""Which of an outfit's layers is the garment one comes to see: a belt or a scarf over a robe is an accessory to it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

__all__ = ["ACCESSORY", "cloth_area", "garment_at"]

# [m2] of cloth: belts, sashes and cords have less, and the least of dresses, a bodice, has more.
ACCESSORY = 0.25


def garment_at(layers: Sequence[tuple[float, bool | None]]) -> int:
    """The place of the outermost layer that is no accessory; of accessories alone the outermost.

    layers: from the skin outwards, the cloth [m2] of each, and whether its outfit calls it an accessory, None where it
    does not say and the cloth decides.
    """
    garments = [
        k for k, (area, told) in enumerate(layers) if not (area < ACCESSORY if told is None else told)
    ]
    return garments[-1] if garments else len(layers) - 1


def cloth_area(pattern: Any, faces: Any) -> float:
    """What faces (F, 3) of a flat pattern (P, 2) [m] measure, in m2."""
    first, second, third = (np.asarray(pattern)[np.asarray(faces)[:, k]] for k in range(3))
    u, v = second - first, third - first
    return float(0.5 * np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum())
