"""Charts side by side in one picture: shelves of falling height, each chart with a border of one texel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hall_app.light.model import LightError, Surfaces

__all__ = ["BORDER", "Atlas", "atlas_of", "pack"]

BORDER = 1  # [texel] around every chart, a copy of its rim: filtering between texels never meets a neighbour
LARGEST = 4096  # [texel] a side of the picture; what every machine with WebGL 2 takes

Ints = NDArray[np.int32]


@dataclass(frozen=True)
class Atlas:
    """Where charts lie: corner (C, 2) x, y of the first texel inside the border; size (C, 2) in texels as they lie;
    turned (C,) bool, x and y swapped; width, height of the picture; place (F, 3, 2) corners of faces [texel]."""

    corner: Ints
    size: Ints
    turned: NDArray[np.bool_]
    width: int
    height: int
    place: NDArray[np.float64]

    def chart_image(self) -> Ints:
        """(H, W) chart of each texel, −1 outside and on borders."""
        image = np.full((self.height, self.width), -1, np.int32)
        for chart, ((x, y), (w, h)) in enumerate(zip(self.corner, self.size, strict=True)):
            image[y : y + h, x : x + w] = chart
        return image


def pack(sizes: Ints) -> tuple[Ints, int, int]:
    """Corners (N, 2) of boxes (N, 2: wide, high, border included) that do not overlap, and the picture's sides.

    The picture is about a third wider than high; sides are whole, no powers of two. Raises LightError when the boxes
    do not fit into LARGEST squared.
    """
    if not len(sizes):
        return np.zeros((0, 2), np.int32), 1, 1
    order = np.lexsort((-sizes[:, 0], -sizes[:, 1]))
    area = float(sizes.astype(np.int64).prod(1).sum())
    width = max(int(np.ceil(np.sqrt(area * 1.35) / 4) * 4), int(sizes[:, 0].max()))
    corners = np.zeros((len(sizes), 2), np.int32)
    x, y, shelf = 0, 0, 0
    for index in order:
        wide, high = sizes[index]
        if x + wide > width:
            x, y, shelf = 0, y + shelf, 0
        corners[index] = x, y
        x, shelf = x + int(wide), max(shelf, int(high))
    height = y + shelf
    if max(width, height) > LARGEST:
        raise LightError(
            f"light: charts need {width} × {height} texels, at most {LARGEST} fit – lower surfaces.density"
        )
    return corners, width, height


def atlas_of(surfaces: Surfaces) -> Atlas:
    """Every chart stretched to whole texels (never fewer than its density asks), lying on its longer side, packed."""
    count = len(surfaces.density)
    extent = np.zeros((count, 2))
    charted = surfaces.chart >= 0
    chart = surfaces.chart[charted]
    np.maximum.at(extent, chart, surfaces.chart_uv[charted].max(1))
    texels = np.maximum(1, np.ceil(extent * surfaces.density[:, None] - 1e-6)).astype(np.int32)
    turned = texels[:, 1] > texels[:, 0]
    lying = np.where(turned[:, None], texels[:, ::-1], texels).astype(np.int32)
    corners, width, height = pack(lying + 2 * BORDER)
    corners = corners + BORDER
    place = np.zeros((len(surfaces.faces), 3, 2))
    scaled = surfaces.chart_uv[charted] * (texels / np.maximum(extent, 1e-9))[chart][:, None]
    scaled = np.where(turned[chart][:, None, None], scaled[..., ::-1], scaled)
    place[charted] = scaled + corners[chart][:, None]
    return Atlas(corners, lying, turned, width, height, place)
