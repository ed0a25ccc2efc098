"""The light map as a picture: brightness, and eight bits without bands."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray

from .model import LightMap, Surfaces
from .packing import Atlas
from .texels import face_normals

__all__ = ["gain_of", "light_jpeg"]

WALL = 0.75  # linear brightness pale walls come to
_PALE = 0.45  # mean reflectance from which a wall counts as pale
_CLIPPED = 0.999  # share of texels that stay below 1 in the picture
_SCALE = 2.0  # the file holds light / 2

Singles = NDArray[np.float32]


def gain_of(
    surfaces: Surfaces, atlas: Atlas, chart: NDArray[np.int32], image: Singles
) -> tuple[Singles, float]:
    """The image with the lamps' own glow in it, and the gain.

    The gain brings the median of pale, upright charts (all charts where there are none) to WALL of the picture, but
    never lifts more than a thousandth of the unlit texels above 1 in the picture.
    """
    count = len(atlas.size)
    albedo, glow, upright = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    charted = surfaces.chart >= 0
    number = surfaces.chart[charted]
    faces = np.maximum(np.bincount(number, minlength=count), 1)[:, None]
    np.add.at(albedo, number, surfaces.albedo[charted] / faces[number])
    np.add.at(glow, number, surfaces.emission[charted] / faces[number])
    np.add.at(upright, number, np.abs(face_normals(surfaces)[charted, 1]) / faces[number, 0])
    inside = chart >= 0
    on = chart[inside]
    dark = glow.max(1) <= 0
    picture = image[inside] * albedo[on]
    pale = dark & (upright < 0.3) & (albedo.mean(1) > _PALE)
    chosen = pale[on] if pale[on].any() else dark[on] if dark[on].any() else np.ones(len(on), bool)
    gain = WALL / max(float(np.median(picture[chosen].mean(1))), 1e-6)
    if dark[on].any():
        gain = min(gain, 1.0 / max(float(np.quantile(picture[dark[on]].max(1), _CLIPPED)), 1e-6))
    out = image.copy()
    out[inside] += (glow / np.maximum(albedo, 0.05))[on].astype(np.float32)
    return out, gain


def light_jpeg(light: LightMap, *, quality: int = 92, seed: int = 0) -> bytes:
    """8-bit sRGB of gain × light / 2 (lightMapIntensity 2π), 4:4:4; half a step of noise against banding.

    Lamps are cut off at white.
    """
    from PIL import Image

    stored = np.clip(light.image * light.gain / _SCALE, 0.0, 1.0)
    srgb = np.where(
        stored <= 0.0031308, 12.92 * stored, 1.055 * np.maximum(stored, 1e-9) ** (1 / 2.4) - 0.055
    )
    noise = np.random.default_rng(seed).uniform(-0.5, 0.5, (*stored.shape[:2], 1))
    picture = np.clip(np.round(255 * srgb + noise), 0, 255).astype(np.uint8)
    file = io.BytesIO()
    Image.fromarray(picture).save(file, "JPEG", quality=quality, subsampling=0, optimize=True)
    return file.getvalue()
