"""The light map as a picture: brightness, and eight bits without bands."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hall_app.light.atlas.filters import frame_numbers
from hall_app.light.atlas.packing import Atlas
from hall_app.light.atlas.texels import face_normals
from hall_app.light.model import LightMap, Surfaces

__all__ = ["Shown", "light_jpeg", "show"]

WALL = 0.34  # linear brightness pale walls come to: silk is shown in little light, and is the brightest thing in view
_WELL_LIT = 0.8  # quantile of pale walls that WALL means: some of them are in deep shade or never seen
_PALE = 0.45  # mean reflectance from which a wall counts as pale
SHOULDER = 0.88  # linear brightness from which highlights are rolled off
_SCALE = 2.0  # the file holds light / 2
_QUALITY = 86  # of JPEG
_KNEE = 1.1  # light from which it is rolled off too, as the file ends at _SCALE

Singles = NDArray[np.float32]


@dataclass(frozen=True)
class Shown:
    """glow: image with the lamps' own light; shown: what a picture shows; gain.

    rolled: share of texels whose brightness is rolled off, which would burn out; dimmed: share of those whose light
    alone is, dark enough to bear it.
    """

    glow: Singles
    shown: Singles
    gain: float
    rolled: float
    dimmed: float


def _rolled(value: NDArray[Any], knee: float, limit: float) -> NDArray[Any]:
    """Factors that leave values up to `knee` alone and bring larger ones ever more slowly towards `limit`."""
    room = limit - knee
    over = np.maximum(value - knee, 0.0)
    return np.where(over > 0, (knee - room * np.expm1(-over / room)) / np.maximum(value, 1e-9), 1.0)


def show(surfaces: Surfaces, atlas: Atlas, image: Singles) -> Shown:
    """The light (H, W, 3) as it is drawn: well-lit parts of pale, upright charts (of all, where there are none)
    come to WALL of the picture; above SHOULDER brightness, and above _KNEE light itself,
    rise ever more slowly and stay below 1 and _SCALE, hue kept.
    """
    count = len(atlas.size)
    albedo, glow, upright = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    charted = surfaces.chart >= 0
    number = surfaces.chart[charted]
    faces = np.maximum(np.bincount(number, minlength=count), 1)[:, None]
    np.add.at(albedo, number, surfaces.albedo[charted] / faces[number])
    np.add.at(glow, number, surfaces.emission[charted] / faces[number])
    np.add.at(upright, number, np.abs(face_normals(surfaces)[charted, 1]) / faces[number, 0])
    chart = frame_numbers(atlas)
    on = chart.reshape(-1)
    lamp = glow.max(1) > 0
    inside = atlas.chart_image().reshape(-1) >= 0
    picture = (image.reshape(-1, 3) * albedo[on]).astype(np.float32)
    pale = (~lamp & (upright < 0.3) & (albedo.mean(1) > _PALE))[on] & inside
    plain = ~lamp[on] & inside
    chosen = pale if pale.any() else plain if plain.any() else inside
    gain = WALL / max(float(np.quantile(picture[chosen].mean(1), _WELL_LIT)), 1e-6)
    strong = gain * image.reshape(-1, 3).max(1)
    stored = _rolled(strong, _KNEE, _SCALE)
    bright = gain * picture.max(1) * stored
    factor = stored * _rolled(bright, SHOULDER, 1.0)
    over, dim = bright > SHOULDER, (strong > _KNEE) & (bright <= SHOULDER)
    factor[lamp[on]] = 1.0
    added = (glow / np.maximum(albedo, 0.05))[on].reshape(image.shape).astype(np.float32)
    lit = image + added
    shown = (gain * lit * factor.reshape(*image.shape[:2], 1)).astype(np.float32)
    rolled, dimmed = (float(share[plain].mean()) if plain.any() else 0.0 for share in (over, dim))
    return Shown(lit, shown, gain, rolled, dimmed)


def light_jpeg(light: LightMap) -> bytes:
    """8-bit sRGB of gain × light / 2 (lightMapIntensity 2π), 4:4:4; half a step of noise against banding.

    Lamps are cut off at white.
    """
    from PIL import Image

    stored = np.clip(light.shown / _SCALE, 0.0, 1.0)
    srgb = np.where(
        stored <= 0.0031308, 12.92 * stored, 1.055 * np.maximum(stored, 1e-9) ** (1 / 2.4) - 0.055
    )
    noise = np.random.default_rng(0).uniform(-0.5, 0.5, (*stored.shape[:2], 1))
    picture = np.clip(np.round(255 * srgb + noise), 0, 255).astype(np.uint8)
    file = io.BytesIO()
    Image.fromarray(picture).save(file, "JPEG", quality=_QUALITY, subsampling=0, optimize=True)
    return file.getvalue()
