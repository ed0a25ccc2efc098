"""How cloth looks as a material of glTF: from a hand's breadth (`close`) and from a few steps away (`hall`)."""

from __future__ import annotations

from collections.abc import Callable
from hashlib import sha256
from math import pi, sqrt
from typing import Any

import numpy as np

from sim_core.garment.garment import Colour
from sim_core.gltf import GlbFile
from sim_core.weave.maps import (
    SHEER,
    FiguredMaps,
    MapsLike,
    coarser_direction,
    coloured,
    coverage,
    dyed,
    far_look,
    linear,
    mean_colour,
    seen_afar,
)

__all__ = ["cloth_close", "cloth_hall", "plain"]

SLUB_SIZE = 0.06  # [m] of cloth per tile of the hall's relief
MOST_PIXELS = 2048  # a side, of the textures that every telephone has
SLUB_QUALITY, CELL_QUALITY, FIGURE_QUALITY = 85, 82, 88  # JPEG


def _silk(colour: np.ndarray, alpha: float, name: str) -> dict[str, Any]:
    """Two-sided silk; sheer cloth blends (a cut-out closes at a distance, dithering sparkles)."""
    tint = 0.55 * (0.5 * colour + 0.5)
    return {
        "name": name,
        "doubleSided": True,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(float(c) for c in np.clip(colour, 0, 1)), alpha],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.45,
        },
        "extensions": {
            "KHR_materials_sheen": {
                "sheenColorFactor": [float(c) for c in tint],
                "sheenRoughnessFactor": 0.38,
            }
        },
    }


def _once(kept: dict[str, Any], name: str, make: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    if name not in kept:
        kept[name] = make()
    return kept[name]


def _look_of(picture: np.ndarray) -> str:
    """Equal for equal pictures: panels of several dyes that are as bright share what their yarns differ by."""
    return sha256(picture.tobytes()).hexdigest()


def plain(name: str, colour: Colour, roughness: float) -> dict[str, Any]:
    """Matter of one colour [sRGB]."""
    return {
        "name": name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(float(c) for c in linear(np.asarray(colour))), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": roughness,
        },
    }


def _gleam(
    glb: GlbFile, material: dict[str, Any], maps: MapsLike, textures: dict[str, Any], *, far: bool
) -> None:
    """Makes the highlight narrow along the yarns, wide across; far: of a figured cloth as coarse as the hall shows it.

    glTF's direction is the one in which the highlight is wide.
    """
    if isinstance(maps, FiguredMaps):
        across = (coarser_direction(maps) if far else maps.direction).astype(float)
        run, strength = across[..., :2] / 127.5 - 1, across[..., 2:]
        turned = np.dstack([127.5 - 127.5 * run[..., 1:], 127.5 + 127.5 * run[..., :1], strength])
        tile = [1e-3 / maps.size[0], 1e-3 / maps.size[1]]
        texture = _once(textures, "gleam", lambda: glb.texture(np.rint(turned).astype(np.uint8), tile))
        gleam: dict[str, Any] = {"anisotropyStrength": 1.0, "anisotropyTexture": texture}
        roughness = float(np.mean(maps.roughness)) / 255
    else:
        look = far_look(maps)
        share = max((look.across - look.along) / max(1.0 - look.along, 1e-6), 0.0)
        gleam = {"anisotropyStrength": sqrt(share), "anisotropyRotation": look.angle + pi / 2}
        roughness = sqrt(look.along)
    material["pbrMetallicRoughness"]["roughnessFactor"] = roughness
    material["extensions"]["KHR_materials_anisotropy"] = gleam


def _cells(glb: GlbFile, material: dict[str, Any], maps: FiguredMaps, textures: dict[str, Any]) -> None:
    """Adds what is seen from a hand's breadth: which cell lies at each crossing, and the yarns of each.

    glTF has no place for them. They go where lacquer and iridescence have their textures, whose factors of 0 keep them
    from being seen; our page reads them by `extras.silk`. A cell's picture holds its normal (red, green) and its
    brightness over its mean (blue, 128 = 1). Beyond four cells, or of a repeat of more crossings than a telephone's
    textures have pixels, nothing is added: the repeat's picture has to do.
    """
    if len(maps.cells) > 4 or max(maps.crossings.shape) > MOST_PIXELS:
        return
    repeat = [1e-3 / maps.size[0], 1e-3 / maps.size[1]]

    def pattern(cell: MapsLike) -> dict[str, Any]:
        light = linear(cell.albedo / 255.0) @ (0.2126, 0.7152, 0.0722)
        bright = np.clip(128 * light / light.mean(), 0, 255)
        picture = np.dstack([cell.normal[..., :2], np.rint(bright)]).astype(np.uint8)
        return glb.texture(picture, [1e-3 / cell.size[0], 1e-3 / cell.size[1]], quality=CELL_QUALITY)

    kept = [
        _once(textures, f"cell {k}", lambda cell=cell: pattern(cell)) for k, cell in enumerate(maps.cells)
    ]
    number = _once(textures, "number", lambda: glb.texture(maps.crossings[::-1], repeat))
    lacquer = dict(zip(("clearcoatNormalTexture", "clearcoatRoughnessTexture"), kept[:2], strict=False))
    film = dict(zip(("iridescenceTexture", "iridescenceThicknessTexture"), kept[2:], strict=False))
    material["extensions"]["KHR_materials_clearcoat"] = {
        "clearcoatFactor": 0.0,
        "clearcoatTexture": number,
        **lacquer,
    }
    if film:
        material["extensions"]["KHR_materials_iridescence"] = {"iridescenceFactor": 0.0, **film}
    sizes = [[float(side) for side in cell.size] for cell in maps.cells]
    material["extras"] = {"silk": {"repeat": [float(side) for side in maps.size], "cells": sizes}}


def cloth_close(glb: GlbFile, dye: Colour | None, maps: MapsLike, textures: dict[str, Any]) -> int:
    mean, sheer = mean_colour(maps), coverage(maps) < SHEER
    picture, factor = coloured(maps, mean, dye, not sheer)
    material = _silk(factor, 1.0, "silk_close")
    if sheer:
        picture = np.dstack([picture, maps.opacity])
    tile = [1e-3 / float(maps.size[0]), 1e-3 / float(maps.size[1])]
    quality = None if sheer else FIGURE_QUALITY  # JPEG knows no openness
    material["pbrMetallicRoughness"]["baseColorTexture"] = _once(
        textures, _look_of(picture), lambda: glb.texture(picture, tile, quality=quality)
    )
    normal = _once(textures, "normal", lambda: glb.texture(maps.normal, tile, quality=FIGURE_QUALITY))
    material["normalTexture"] = {**normal, "scale": 1.0}
    _gleam(glb, material, maps, textures, far=False)
    if isinstance(maps, FiguredMaps):
        _cells(glb, material, maps, textures)
    if sheer:
        material["alphaMode"] = "BLEND"
    tint = dyed(dye, mean)
    material["extensions"]["KHR_materials_sheen"]["sheenColorFactor"] = [
        float(c) for c in 0.55 * (0.5 * tint + 0.5)
    ]
    return glb.material(material)


def cloth_hall(glb: GlbFile, dye: Colour | None, maps: MapsLike, textures: dict[str, Any]) -> int:
    cover, mean = coverage(maps), mean_colour(maps)
    material = _silk(dyed(dye, mean), round(cover, 4) if cover < SHEER else 1.0, "silk_hall")
    tile = [1e-3 / SLUB_SIZE, 1e-3 / SLUB_SIZE]
    normal = _once(textures, "normal", lambda: glb.texture(_slub_normal(256), tile, quality=SLUB_QUALITY))
    material["normalTexture"] = {**normal, "scale": 0.5}
    own = textures.setdefault(f"of {id(maps)}", {})
    picture, factor = seen_afar(maps, dye)
    if picture is not None:
        repeat = [1e-3 / maps.size[0], 1e-3 / maps.size[1]]
        material["pbrMetallicRoughness"]["baseColorTexture"] = _once(
            own, _look_of(picture), lambda: glb.texture(picture, repeat, quality=FIGURE_QUALITY)
        )
        material["pbrMetallicRoughness"]["baseColorFactor"][:3] = [float(c) for c in factor]
    _gleam(glb, material, maps, own, far=True)
    if cover < SHEER:
        material["alphaMode"] = "BLEND"
    return glb.material(material)


def _slub_normal(pixels: int, *, depth: float = 1.2, seed: int = 7) -> np.ndarray:
    """A tileable slub relief, what remains of a silk's weave seen from a few steps away: normal map (n, n, 3) uint8.

    Threads that swell here and there, along u mostly; periodic both ways.
    """
    rng = np.random.default_rng(seed)
    frequency = np.fft.fftfreq(pixels, 1 / pixels)
    u, v = np.meshgrid(frequency, frequency)

    def noise(along: float, across: float) -> np.ndarray:
        window = np.exp(-((u / along) ** 2) - (v / across) ** 2) * (1 - np.exp(-(u**2 + v**2) / 4))
        field = np.fft.ifft2(np.fft.fft2(rng.standard_normal((pixels, pixels))) * window).real
        return field / field.std()

    height = noise(5, 42) + 0.45 * noise(42, 5) + 0.25 * noise(60, 60)
    du = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) / 2
    dv = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) / 2
    normal = np.stack([-depth * du, depth * dv, np.ones_like(height)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.round(127.5 + 127.5 * normal).astype(np.uint8)
