"""Maps of a figured cloth: its repeat, thousands of yarns wide, put together of the maps of its cells.

A pixel that holds many crossings takes of each cell as much as lies in it, and the slopes that it no longer shows make
its highlight wider (`averages`). So a satin damask shows its figure by the way its two faces turn the light, and one
that is drawn fine enough shows its yarns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.maps.averages import CHANNELS, averageable, composed
from sim_core.weave.maps.surface import SurfaceMaps, surface_maps
from sim_core.weave.model import Weave
from sim_core.weave.yarns.geometry import FiguredGeometry, YarnGeometry
from sim_core.weave.yarns.particles.cell import ParticleCell

__all__ = ["FiguredMaps", "drawn_maps", "figured_maps"]

CELL_PIXELS = 512  # a power of two
STRIP = 128  # rows drawn at a time


@dataclass(frozen=True, eq=False)
class FiguredMaps(SurfaceMaps):
    """As SurfaceMaps, of the whole repeat. number: (n, n) uint8, the cell most of a pixel is; cells: their maps;
    crossings: (picks, ends) uint8, the cell at every place of the draft, the first pick lowest."""

    number: np.ndarray
    cells: tuple[SurfaceMaps, ...]
    crossings: np.ndarray


def drawn_maps(
    weave: Weave, geometry: YarnGeometry | ParticleCell | FiguredGeometry, *, pixels: int = 1024
) -> SurfaceMaps:
    """The maps of any cloth: of a figured one its whole repeat, of another some dozen yarns; raises WeaveError."""
    if isinstance(geometry, FiguredGeometry):
        return figured_maps(weave, geometry, pixels=pixels)
    return surface_maps(weave, geometry, pixels=pixels)


def figured_maps(
    weave: Weave, geometry: FiguredGeometry, *, pixels: int = 1024, seed: int = 0
) -> FiguredMaps:
    """Draw the repeat of a figured cloth from its cells. pixels: 32 to 4096; seed: of the yarns' unevenness.

    Raises WeaveError for a map size out of range, a weave without a figure and the geometry of another one.
    """
    numbers = weave.numbers
    if numbers is None or len(geometry.cells) != len(weave.cells):
        raise WeaveError(f"weave {weave.name}: the yarn geometry belongs to another draft – solve this weave")
    if not 32 <= pixels <= 4096:
        raise WeaveError(f"weave {weave.name}: {pixels} pixels – give 32 to 4096")
    cells = tuple(
        surface_maps(cell, rest, pixels=CELL_PIXELS, seed=seed + k, repeats=_dividing(weave, cell))
        for k, (cell, rest) in enumerate(zip(weave.cells, geometry.cells, strict=True))
    )
    shares = np.stack([_averaged(numbers[::-1] == k, pixels) for k in range(len(cells))])
    pixel = weave.size[0] / pixels, weave.size[1] / pixels
    small = [_reduced(averageable(cell), cell, pixel) for cell in cells]
    relief = max(cell.relief for cell in cells)
    strips = [
        composed(_mixed(small, cells, shares, pixel, rows), relief)
        for rows in np.array_split(np.arange(pixels), -(-pixels // STRIP))
    ]
    albedo, normal, height, roughness, direction, opacity = (
        np.concatenate(parts) for parts in zip(*strips, strict=True)
    )
    number = shares.argmax(axis=0).astype(np.uint8)
    yarn = number.astype(np.uint16) + 1
    drawn = albedo, normal, height, roughness, direction, opacity
    return FiguredMaps(
        *drawn,
        yarn,
        weave.size,
        relief,
        (1, 1),
        number=number,
        cells=cells,
        crossings=numbers.astype(np.uint8),
    )


def _dividing(weave: Weave, cell: Weave) -> tuple[int, int]:
    """How many repeats of a cell are drawn: as many as fit the whole cloth without a rest, some dozen yarns wide."""
    counts = []
    for whole, own, yarns in zip(weave.size, cell.size, (cell.draft.ends, cell.draft.picks), strict=True):
        times, wanted = round(whole / own), max(1.0, 28 / yarns)
        divisors = [k for k in range(1, times + 1) if times % k == 0 and k <= 2 * wanted]
        counts.append(min(divisors, key=lambda k: abs(np.log(k / wanted))))
    return counts[0], counts[1]


def _averaged(there: np.ndarray, pixels: int) -> np.ndarray:
    """(pixels, pixels) float32 share of each pixel in which a picture (rows, columns) bool is set."""
    from PIL import Image

    picture = Image.fromarray(there.astype(np.float32), "F")
    return np.asarray(picture.resize((pixels, pixels), Image.Resampling.BOX))


def _reduced(made: np.ndarray, maps: SurfaceMaps, pixel: tuple[float, float]) -> np.ndarray:
    """The channels averaged until a pixel is about as large as one of the repeat's, each way by itself."""
    for axis in (0, 1):
        own = maps.size[1 - axis] / made.shape[axis]
        times = 2 ** int(np.clip(np.round(np.log2(pixel[1 - axis] / own)), 0, np.log2(made.shape[axis])))
        shape = list(made.shape)
        shape[axis : axis + 1] = [shape[axis] // times, times]
        made = made.reshape(shape).mean(axis=axis + 1)
    return made


def _mixed(small, cells, shares: np.ndarray, pixel: tuple[float, float], rows: np.ndarray) -> np.ndarray:
    """(rows, n, 10) channels of some rows of the repeat, row 0 at its top: of each cell as much as there is of it."""
    pixels = shares.shape[1]
    mixed = np.zeros((len(rows), pixels, CHANNELS), np.float32)
    for values, maps, share in zip(small, cells, shares, strict=True):
        up = (pixels - rows - 0.5) * pixel[1] / maps.size[1]  # laps of the cell's tile, from the lower edge
        along = (np.arange(pixels) + 0.5) * pixel[0] / maps.size[0]
        row = (values.shape[0] - 1 - np.floor((up % 1.0) * values.shape[0])).astype(int)
        column = np.floor((along % 1.0) * values.shape[1]).astype(int)
        mixed += share[rows, :, None] * values[np.ix_(row, column)]
    return mixed
