"""A model's main colour, and how far apart two colours are seen to be."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hall_app.content.models.glb import open_glb
from hall_app.content.models.pictures import LARGEST, PictureError, picture_size
from sim_core.gltf import GlbParts

__all__ = ["difference", "hex_of", "main_colour"]

Floats = NDArray[np.float64]
_SUPPORT = ("stand", "figure", "mannequin")  # nodes that hold the dress up and are not what is shown
_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
_WHITE = np.array([0.95047, 1.0, 1.08883])


def difference(first: Floats, second: Floats) -> float:
    """CIE 1976 colour difference ΔE*ab of two colours (3,) in linear light."""
    return float(np.linalg.norm(_lab(first) - _lab(second)))


def _lab(colour: Floats) -> Floats:
    ratio = _TO_XYZ @ np.clip(colour, 0, 1) / _WHITE
    f = np.where(ratio > (6 / 29) ** 3, np.cbrt(ratio), ratio / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def hex_of(colour: Floats) -> str:
    """A colour (3,) in linear light as "#rrggbb" (sRGB)."""
    value = np.clip(colour, 0, 1)
    srgb = np.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1 / 2.4) - 0.055)
    return "#" + "".join(f"{round(255 * float(c)):02X}" for c in srgb)


def main_colour(path: Path) -> Floats | None:
    """(3,) linear light: the mean colour of the material that covers most of the model at `path`, stands left out.

    None where no material covers anything. Raises what reading a broken GLB raises, PictureError for a huge texture.
    """
    parts = open_glb(path)
    document = parts.document
    area: dict[int, float] = {}
    tone: dict[int, Floats] = {}
    for node in document.get("nodes", ()):
        if "mesh" not in node or any(word in str(node.get("name", "")).lower() for word in _SUPPORT):
            continue
        for primitive in document["meshes"][node["mesh"]]["primitives"]:
            material = primitive.get("material", -1)
            covered, tint = _covered(parts, primitive)
            before = area.get(material, 0.0)
            area[material] = before + covered
            if covered > 0:
                mixed = (before * tone.get(material, tint) + covered * tint) / area[material]
                tone[material] = mixed
    if not tone:
        return None
    most = max(tone, key=lambda material: area[material])
    return tone[most] * _colour_of(parts, most)


def _covered(parts: GlbParts, primitive: dict[str, Any]) -> tuple[float, Floats]:
    """Area [m2] of a primitive's triangles and the mean of its vertex colours."""
    attributes = primitive["attributes"]
    points = parts.numbers(attributes["POSITION"])
    index = np.arange(len(points))
    if "indices" in primitive:
        index = parts.numbers(primitive["indices"]).reshape(-1).astype(int)
    corners = points[index[: len(index) // 3 * 3].reshape(-1, 3)]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    tint = np.ones(3)
    if "COLOR_0" in attributes:
        tint = parts.numbers(attributes["COLOR_0"])[:, :3].mean(0)
    return float(np.linalg.norm(cross, axis=1).sum() / 2), tint


def _colour_of(parts: GlbParts, number: int) -> Floats:
    """(3,) linear light: a material's factor times the mean of its texture."""
    if number < 0:
        return np.ones(3)
    document = parts.document
    look = document["materials"][number].get("pbrMetallicRoughness", {})
    colour = np.array(look.get("baseColorFactor", [1.0, 1.0, 1.0, 1.0])[:3], float)
    if "baseColorTexture" not in look:
        return colour
    texture = document["textures"][look["baseColorTexture"]["index"]]
    source = texture.get("source", texture.get("extensions", {}).get("EXT_texture_webp", {}).get("source"))
    return colour * _mean(parts.picture(source))


def _mean(data: bytes) -> Floats:
    from PIL import Image

    if max(picture_size(data)) > LARGEST:
        raise PictureError("the texture is too large")  # as numbers it would fill the memory
    with Image.open(io.BytesIO(data)) as picture:
        pixels = np.asarray(picture.convert("RGBA"), float) / 255
    weight = pixels[..., 3:] + 1e-6
    srgb = pixels[..., :3]
    light = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    return (light * weight).sum((0, 1)) / weight.sum()
