"""Tileable texture maps of a cloth: albedo, normal, height and opacity, with the seam measured."""

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.geometry import TextureMaps, YarnGeometry
from sim_core.weave.lines import YarnSystem, yarn_systems
from sim_core.weave.model import Weave
from sim_core.weave.raster import rasterise

__all__ = ["repeats_in_tile", "texture_maps"]

SAMPLES = 3  # per pixel and direction
YARNS_WANTED = 28  # in a tile: enough that the irregularity does not catch the eye as a pattern
PIXELS_PER_YARN = 10
BAND = 6  # pixels on both sides of the border that are rendered again to measure the seam


def repeats_in_tile(weave: Weave, pixels: int) -> tuple[int, int]:
    """Repeats (across, down) that make a nearly square tile of about YARNS_WANTED yarns, fine enough to be drawn."""
    width, height = weave.size
    most = max(1, int(pixels / PIXELS_PER_YARN / weave.draft.ends))
    best, best_cost = (1, 1), np.inf
    for across in range(1, most + 1):
        down = max(1, round(across * width / height))
        skew = abs(np.log(across * width / (down * height)))
        cost = 4 * skew + abs(np.log(across * weave.draft.ends / YARNS_WANTED))
        if cost < best_cost and down * weave.draft.picks * 4 <= pixels:
            best, best_cost = (across, down), cost
    return best


def texture_maps(weave: Weave, geometry: YarnGeometry, *, pixels: int = 512, seed: int = 0) -> TextureMaps:
    """Draw the relaxed cloth as tileable maps.

    geometry: of the same weave.  pixels: width and height of each map, 32 to 4096.  seed: of the irregularity of the
    yarns, which is periodic over the tile like everything else. Raises WeaveError for a map size out of range.
    """
    if not 32 <= pixels <= 4096:
        raise WeaveError(f"weave {weave.name}: {pixels} pixels – give 32 to 4096")
    if geometry.warp_height.shape != weave.draft.lift.shape:
        raise WeaveError(f"weave {weave.name}: the yarn geometry belongs to another draft – relax this weave")
    across, down = repeats_in_tile(weave, pixels)
    systems = yarn_systems(weave, geometry, (across, down), seed)
    size = across * weave.size[0], down * weave.size[1]
    pixel = size[1] / pixels, size[0] / pixels
    limits = _limits(systems)
    maps = _levels(_draw(systems, (0, 0), pixel, (pixels, pixels), limits), systems, limits)
    seam = _seam(maps, systems, pixel, limits)
    albedo, normal, height, opacity = maps
    return TextureMaps(albedo, normal, height, opacity, size, limits[1] - limits[0], seam)


def _draw(systems, origin, pixel, shape, limits) -> np.ndarray:
    warp, weft = systems
    return rasterise(warp, weft, origin, pixel, shape, SAMPLES, limits[0], limits[1])


def _limits(systems: tuple[YarnSystem, YarnSystem]) -> tuple[float, float]:
    """Lowest and highest surface height [m] with a little room for swollen yarns."""
    room = 1.15
    low = min(float(s.height.min()) - room * s.half_height for s in systems)
    return low, max(float(s.height.max()) + room * s.half_height for s in systems)


def _levels(picture: np.ndarray, systems, limits) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Channels of the rasteriser to 8-bit maps. Gaps take the yarns' mean colour, so that mip levels do not darken."""
    cover = picture[..., 7:8]
    mean = 0.8 * (systems[0].colour + systems[1].colour) / 2
    linear = np.where(cover > 0, picture[..., :3] / np.maximum(cover, 1e-9), mean)
    normal = picture[..., 3:6] + (1 - cover) * np.array([0.0, 0.0, 1.0])
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    height = (picture[..., 6] - limits[0]) / (limits[1] - limits[0])
    return (
        _bytes(_to_srgb(np.clip(linear, 0, 1))),
        _bytes(normal / 2 + 0.5),
        _bytes(np.clip(height, 0, 1)),
        _bytes(picture[..., 7]),
    )


def _bytes(values: np.ndarray) -> np.ndarray:
    return np.rint(np.clip(values, 0, 1) * 255).astype(np.uint8)


def _to_srgb(linear: np.ndarray) -> np.ndarray:
    return np.where(
        linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    )


def _seam(maps, systems, pixel, limits) -> float:
    """Render bands across the right and the lower border as one piece and compare them with the tiled maps."""
    pixels = len(maps[2])
    wrapped = np.arange(pixels - BAND, pixels + BAND) % pixels
    worst = 0
    for origin, shape, axis in (
        ((pixels - BAND, 0), (2 * BAND, pixels), 0),
        ((0, pixels - BAND), (pixels, 2 * BAND), 1),
    ):
        whole = _levels(_draw(systems, origin, pixel, shape, limits), systems, limits)
        for tile, band in zip(maps, whole, strict=True):
            tiled = np.take(tile, wrapped, axis=axis).astype(int)
            worst = max(worst, int(np.abs(tiled - band).max()))
    return worst / 255
