"""How a cloth is coloured: by its yarns or a dye, near and from some steps away, where yarns are seen no more."""

from __future__ import annotations

import numpy as np

from sim_core.weave.maps.averages import MapsLike, line_angle
from sim_core.weave.maps.figured_maps import FiguredMaps

__all__ = [
    "SHEER",
    "coarser_direction",
    "coloured",
    "coverage",
    "dyed",
    "linear",
    "mean_colour",
    "seen_afar",
    "srgb",
]

Colour = tuple[float, float, float]  # sRGB 0..1

SHEER = 0.8  # mean coverage; denser cloth is drawn opaque, its pores as the shade between yarns
PORE = 0.35  # of the mean colour
STRIPED = 0.1  # of a linear colour, from end to end of a cloth: seen in the hall
FIGURE_PIXEL = 0.0006  # [m] of a figured cloth's repeat in the hall, at most


def linear(srgb: np.ndarray) -> np.ndarray:
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def mean_colour(maps: MapsLike) -> np.ndarray:
    """Mean linear colour of the yarns, weighted by what they cover."""
    weight = maps.opacity.astype(float) + 1e-6
    return (linear(maps.albedo / 255.0) * weight[..., None]).sum((0, 1)) / weight.sum()


def dyed(dye: Colour | None, mean: np.ndarray) -> np.ndarray:
    """The linear colour (3,) of a whole cloth: its dye, else its yarns' mean."""
    return mean if dye is None else linear(np.asarray(dye))


def coverage(maps: MapsLike) -> float:
    return float(maps.opacity.mean()) / 255


def srgb(linear: np.ndarray) -> np.ndarray:
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def coloured(
    maps: MapsLike, mean: np.ndarray, dye: Colour | None, opaque: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Albedo (n, m, 3) uint8 and what it is multiplied by (3,): the yarns' own colours, or what they differ from a dye.

    The pores of an opaque cloth take the shade of the yarns round them.
    """
    light = linear(maps.albedo / 255.0)
    if opaque:
        cover = maps.opacity[..., None] / 255.0
        light = light * cover + PORE * mean * (1 - cover)
    if dye is None:
        return np.round(255 * srgb(light)).astype(np.uint8), np.ones(3)
    # As bright as the dye leaves room for: a factor of glTF is 1 at most.
    wanted, share = dyed(dye, mean), light / np.maximum(mean, 1e-3)
    peak = min(float(np.quantile(share, 0.98)), 1.0 / max(float(wanted.max()), 1e-3))
    return np.round(255 * srgb(np.clip(share / peak, 0, 1))).astype(np.uint8), wanted * peak


def coarser(picture: np.ndarray, size: tuple[float, float], pixel: float = FIGURE_PIXEL) -> np.ndarray:
    """Means of a repeat's picture over so many pixels that one is `pixel` [m] wide at most, each way by itself."""
    for axis, side in ((0, size[1]), (1, size[0])):
        count = picture.shape[axis]
        wanted = max(1, int(pixel * count / side))
        times = max(k for k in range(1, wanted + 1) if count % k == 0)
        shape = list(picture.shape)
        shape[axis : axis + 1] = [count // times, times]
        picture = picture.reshape(shape).mean(axis=axis + 1)
    return picture


def coarser_direction(maps: FiguredMaps) -> np.ndarray:
    """`coarser` of the directions, which way a yarn runs along its line being no matter: means of twice the angle."""
    told = maps.direction.astype(float)
    run = told[..., :2] / 127.5 - 1
    twice = coarser((run[..., 0] + 1j * run[..., 1]) ** 2 * told[..., 2], maps.size)
    angle = line_angle(0.5 * np.angle(twice))
    way = 127.5 + 127.5 * np.dstack([np.cos(angle), np.sin(angle)])
    return np.dstack([way, np.minimum(np.abs(twice), 255.0)])


def seen_afar(
    maps: MapsLike, dye: Colour | None, pixel: float = FIGURE_PIXEL
) -> tuple[np.ndarray | None, np.ndarray]:
    """A repeat (h, w, 3) uint8 sRGB whose pixels are `pixel` [m] wide at most, and the linear colour (3,) it is
    multiplied by; no repeat, and the colour of the whole, where that is all that is seen."""
    mean = mean_colour(maps)
    picture, factor = coloured(maps, mean, dye, coverage(maps) >= SHEER)
    light = coarser(linear(picture / 255.0), maps.size, pixel)
    if not isinstance(maps, FiguredMaps) and np.ptp(light, axis=(0, 1)).max() <= STRIPED:
        return None, dyed(dye, mean)
    return np.rint(255 * srgb(light)).astype(np.uint8), np.clip(factor, 0, 1)
