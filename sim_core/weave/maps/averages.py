"""Maps as what may be averaged: light instead of sRGB, slopes and their squares instead of normals and lobes.

After Olano and Baker, LEAN mapping (2010): a pixel that holds many slopes has their mean as its normal and twice their
variance in the square of its highlight's width. So a cloth from afar gleams as the mean of its yarns does.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, pi
from typing import Protocol

import numpy as np

__all__ = ["CHANNELS", "FarLook", "MapsLike", "averageable", "composed", "far_look", "line_angle"]

CHANNELS = 10
COLOUR, COVER, LEVEL, SLOPE, SQUARES = slice(0, 3), 3, 4, slice(5, 7), slice(7, 10)
STEEP = 3.0  # slopes beyond are cut off, as where a yarn's flank hides


class MapsLike(Protocol):
    """The part of `SurfaceMaps` that is averaged and that a model holds."""

    @property
    def albedo(self) -> np.ndarray: ...
    @property
    def normal(self) -> np.ndarray: ...
    @property
    def height(self) -> np.ndarray: ...
    @property
    def roughness(self) -> np.ndarray: ...
    @property
    def direction(self) -> np.ndarray: ...
    @property
    def opacity(self) -> np.ndarray: ...
    @property
    def size(self) -> tuple[float, float]: ...
    @property
    def relief(self) -> float: ...


@dataclass(frozen=True)
class FarLook:
    """The highlight of a cloth so far away that no yarn is seen. along, across: alpha along the way in which it is
    narrow and across it; angle: [rad] of that way, from weft to warp."""

    along: float
    across: float
    angle: float


def far_look(maps: MapsLike) -> FarLook:
    """How a whole tile gleams from afar."""
    mean = averageable(maps).mean(axis=(0, 1), keepdims=True)
    roughness, direction = (one[0, 0] for one in composed(mean, 1.0)[3:5])
    narrow = (float(roughness) / 255) ** 2
    cosine, sine, strength = (float(v) / 255 for v in direction)
    return FarLook(narrow, narrow + (1 - narrow) * strength**2, atan2(2 * sine - 1, 2 * cosine - 1) % pi)


def averageable(maps: MapsLike) -> np.ndarray:
    """(n, n, 10) float32: light of the yarns times cover, cover, level [m], slopes, and the means of their squares."""
    made = np.zeros((*maps.height.shape, CHANNELS), np.float32)
    cover = maps.opacity / np.float32(255)
    made[..., COLOUR] = _light(maps.albedo) * cover[..., None]
    made[..., COVER] = cover
    made[..., LEVEL] = (maps.height / np.float32(255) - 0.5) * maps.relief
    normal = maps.normal / np.float32(127.5) - 1
    slope = np.clip(-normal[..., :2] / np.maximum(normal[..., 2:], 0.1), -STEEP, STEEP)
    run = maps.direction[..., :2] / np.float32(127.5) - 1
    run /= np.maximum(np.linalg.norm(run, axis=2, keepdims=True), 1e-6)
    narrow = (maps.roughness / np.float32(255)) ** 2
    wide = narrow + (1 - narrow) * (maps.direction[..., 2] / np.float32(255)) ** 2
    c, s = run[..., 0], run[..., 1]
    lobe = np.stack([c * c * narrow**2 + s * s * wide**2, c * s * (narrow**2 - wide**2),
                     s * s * narrow**2 + c * c * wide**2], axis=-1)  # fmt: skip
    x, y = slope[..., 0], slope[..., 1]
    made[..., SLOPE] = slope
    made[..., SQUARES] = np.stack([x * x, x * y, y * y], axis=-1) + lobe / 2
    return made


def composed(mixed: np.ndarray, relief: float) -> tuple[np.ndarray, ...]:
    """Albedo, normal, height, roughness, direction and opacity of channels (rows, n, 10), all uint8."""
    cover = mixed[..., COVER]
    albedo = _srgb(mixed[..., COLOUR] / np.maximum(cover, 1e-3)[..., None])
    slope = mixed[..., SLOPE]
    normal = np.dstack([-slope, np.ones_like(cover)])
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    x, y = slope[..., 0], slope[..., 1]
    xx, xy, yy = (2 * (mixed[..., SQUARES][..., k] - one) for k, one in enumerate((x * x, x * y, y * y)))
    middle, apart = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    narrow = np.clip(np.sqrt(np.maximum(middle - apart, 1e-4)), 0, 0.98)
    wide = np.sqrt(middle + apart)
    half = 0.5 * np.arctan2(-xy, (yy - xx) / 2)  # of the narrow way, along which the yarns run
    half = line_angle(half)
    strength = np.sqrt(np.clip((wide - narrow) / (1 - narrow), 0, 1))
    direction = np.dstack([np.cos(half) / 2 + 0.5, np.sin(half) / 2 + 0.5, strength])
    level = mixed[..., LEVEL] / relief + 0.5
    maps = (albedo, normal / 2 + 0.5, level, np.sqrt(narrow), direction, cover)
    return tuple(np.rint(np.clip(one, 0, 1) * 255).astype(np.uint8) for one in maps)


def line_angle(angle: np.ndarray) -> np.ndarray:
    """Angles of lines, -90 to 90 degrees in, as `SurfaceMaps.direction` has them: -45 to 135."""
    return np.where(angle < -np.pi / 4, angle + np.pi, angle)


def _light(srgb: np.ndarray) -> np.ndarray:
    values = srgb / np.float32(255)
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4).astype(np.float32)


def _srgb(light: np.ndarray) -> np.ndarray:
    values = np.clip(light, 0, 1)
    return np.where(values <= 0.0031308, 12.92 * values, 1.055 * values ** (1 / 2.4) - 0.055)
