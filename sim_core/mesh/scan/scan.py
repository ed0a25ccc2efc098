"""A scan as it was read: a dense mesh with its pictures or vertex colours, in the units of its file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError

__all__ = ["MOST_TRIANGLES", "Progress", "Scan", "ScanError"]

MOST_TRIANGLES = 5_000_000
Progress = Callable[[float, str], None]  # share done, what is being done


class ScanError(SimCoreError):
    """A scan that cannot be used: what is wrong in one sentence, and the remedy (`fix`)."""

    def __init__(self, what: str, fix: str) -> None:
        super().__init__(f"{what} – {fix}")
        self.what, self.fix = what, fix


@dataclass(frozen=True)
class Scan:
    """V vertices, F triangles.

    vertices: (V, 3) float64, in the file's units and axes; faces: (F, 3) int32; uv: (F, 3, 2) float32 of each corner in
    its picture, v downwards; picture: (F,) int16 which one, -1 for none; pictures: each (H, W, 3) uint8 sRGB, a single
    pixel for a material without one; colours: (V, 3) uint8 sRGB, or None.
    """

    vertices: np.ndarray
    faces: np.ndarray
    uv: np.ndarray | None
    picture: np.ndarray
    pictures: tuple[np.ndarray, ...]
    colours: np.ndarray | None

    @property
    def coloured(self) -> bool:
        """Whether it brings colours: pictures of more than one tone, or vertex colours."""
        return self.colours is not None or any(picture.size > 3 for picture in self.pictures)
