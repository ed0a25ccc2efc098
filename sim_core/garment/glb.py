"""Our own GLB writer: the garment, its stand or figure as a further node, the weave's maps at true scale."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from hashlib import sha256
from math import pi, sqrt
from pathlib import Path
from typing import Any, Literal

import numpy as np

from sim_core.cloth import Cylinder
from sim_core.cloth.contact.solid_meshes import solid_mesh
from sim_core.errors import SimCoreError
from sim_core.garment.garment import Colour, Garment
from sim_core.garment.pattern import unsided
from sim_core.gltf import GlbFile
from sim_core.picture import normals, split_along
from sim_core.validation.files import written_whole
from sim_core.weave import Loom, Weave
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

Precision = Literal["close", "hall"]
LACQUER = (0.28, 0.165, 0.145)  # sRGB #482A25
LINEN = (0.84, 0.80, 0.73)  # sRGB
SLUB_SIZE = 0.06  # [m] of cloth per tile of the hall's relief
MOST_PIXELS = 2048  # a side, of the textures that every telephone has
ROUND = {"close": (32, 48), "hall": (16, 28), "afar": (8, 14)}  # sides of a stand's bars and of a base
SLUB_QUALITY, CELL_QUALITY, FIGURE_QUALITY = 85, 82, 88  # JPEG


@dataclass(frozen=True)
class Part:
    """What a figure wears by itself: its name, its colour (sRGB), and which of the faces (F,) bool it is."""

    name: str
    dye: Colour
    faces: np.ndarray


@dataclass(frozen=True)
class Shown:
    """What is shown of a figure: vertices (V, 3) [m], faces (F, 3), normals (V, 3); base: its radius and height [m];
    worn: what it wears by itself."""

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray
    base: tuple[float, float]
    worn: tuple[Part, ...] = ()


@dataclass(frozen=True)
class Clothed:
    """A garment and how its cloth looks: maps of its weave, and those of panels that have one of their own."""

    garment: Garment
    maps: MapsLike
    panels: Mapping[str, MapsLike] = field(default_factory=dict)

    def of(self, panel: int) -> MapsLike:
        """The maps of a panel, of both halves of a mirrored pattern alike."""
        return self.panels.get(unsided(self.garment.panels[panel]), self.maps)

    @staticmethod
    def woven(garment: Garment, pixels: int = 512, *, loom: Loom | None = None) -> Clothed:
        """With the maps of its own weaves, `pixels` wide, each drawn once; loom: what was woven for it before.

        Raises SimCoreError where it does not tell its weave.
        """
        if not garment.weave:
            raise SimCoreError(f"garment {garment.name}: does not tell its weave – bake it again")
        loom = loom or Loom()

        def drawn(told: dict[str, Any]) -> MapsLike:
            return loom.maps(Weave.from_dict(told), pixels)

        return Clothed(garment, drawn(garment.weave), {name: drawn(w) for name, w in garment.weaves.items()})


@dataclass(frozen=True)
class Afar:
    """How a model looks from afar: coarser garments from the skin outwards, the figure; distance [m] from which on."""

    layers: Sequence[Clothed]
    figure: Shown | None
    distance: float


def opaque(layers: Sequence[Clothed]) -> tuple[np.ndarray, np.ndarray]:
    """Positions (P, 3) [m] of all layers, and the faces (F, 3) that nothing is seen through."""
    points, faces, count = [], [], 0
    for layer in layers:
        garment = layer.garment
        dense = [k for k in range(len(garment.panels)) if coverage(layer.of(k)) >= SHEER]
        points.append(garment.positions)
        faces.append(garment.faces[np.isin(garment.panel, dense)] + count)
        count += len(garment.positions)
    return np.concatenate(points), np.concatenate(faces)


def write_glb(
    path: Path,
    layers: Sequence[Clothed],
    *,
    precision: Precision = "close",
    figure: Shown | None = None,
    afar: Afar | None = None,
) -> int:
    """Writes garments, from the skin outwards, and their stand or figure; returns the size in bytes.

    afar: a second level for far eyes, see `GlbFile.levels`; its nodes' names end with " afar".

    Panels of one look are one node: the garment's name, then its name and a number. Twins on a seam share place and
    normal, so that no seam shows but for its change of colour. A figure and what it wears stand on its base.

    Maps: tileable, uint8, size [m] of the tile. TEXCOORD_0 is pattern millimetres from the weave's origin, v downwards;
    KHR_texture_transform brings it to tiles. close: the weave itself; hall: its mean colour and coverage and a coarser
    relief, since single yarns vanish beyond a hand's breadth. A figured cloth shows its repeat in both. Highlights are
    narrow along the yarns and wide across (KHR_materials_anisotropy), of a figured cloth by a texture of directions.
    """
    if precision not in ("close", "hall"):
        raise SimCoreError(f"precision: {precision!r} – give 'close' or 'hall'")
    if not layers:
        raise SimCoreError("glb: no garment – give one or more")
    for layer in layers:
        for maps in (layer.maps, *layer.panels.values()):
            if maps.albedo.shape[:2] != maps.opacity.shape or min(maps.size) <= 0:
                raise SimCoreError(
                    f"maps: albedo {maps.albedo.shape}, opacity {maps.opacity.shape} – sizes must agree"
                )
    textures: dict[int, dict[str, Any]] = {}
    glb = GlbFile()
    _write_level(glb, layers, figure, precision, textures)
    if afar is not None:
        near = len(glb.meshes)
        _write_level(glb, afar.layers, afar.figure, "afar", textures)
        for mesh in glb.meshes[near:]:
            mesh["name"] += " afar"
        glb.levels(range(near), range(near, len(glb.meshes)), afar.distance)
    outermost = layers[-1].garment
    used = {name for material in glb.materials for name in material.get("extensions", ())}
    data = glb.bytes(outermost.name, sorted(used | {"KHR_texture_transform"}))
    with written_whole(Path(path)) as stream:
        stream.write(data)
    return len(data)


def _write_level(
    glb: GlbFile,
    layers: Sequence[Clothed],
    figure: Shown | None,
    precision: Precision | Literal["afar"],
    textures: dict[int, dict[str, Any]],
) -> None:
    """Garments and what bears them; of what is seen from afar cloth looks as in the hall."""
    look: Precision = "close" if precision == "close" else "hall"
    lift = np.array([0.0, figure.base[1] if figure else 0.0, 0.0])
    for layer in layers:
        raised = replace(layer.garment, positions=layer.garment.positions + lift)
        _write_panels(glb, replace(layer, garment=raised), look, textures)
    outermost = layers[-1].garment
    if outermost.settled is not None and outermost.settled.beneath.stand is not None:
        stand = outermost.settled.beneath.stand.mesh(ROUND[precision][0])
        glb.mesh("stand", *stand, glb.material(_lacquer()))
    if figure is not None:
        bare = ~np.any([np.zeros(len(figure.faces), bool), *(part.faces for part in figure.worn)], axis=0)
        looks = [("figure", bare, _plain("linen", LINEN, 0.9))]  # matt, light, without colour of its own
        looks += [(part.name, part.faces, _plain(part.name, part.dye, 0.6)) for part in figure.worn]
        for name, own, material in looks:
            if own.any():
                used, index = np.unique(figure.faces[own], return_inverse=True)
                faces = index.reshape(-1, 3).astype(np.int32)
                shading = figure.normals[used]
                glb.mesh(name, figure.vertices[used] + lift, faces, glb.material(material), shading=shading)
        base = Cylinder((0.0, 0.0, 0.0), (0.0, figure.base[1], 0.0), figure.base[0], 0.4 * figure.base[1])
        glb.mesh("base", *solid_mesh(base, ROUND[precision][1]), glb.material(_lacquer()))


def _write_panels(
    glb: GlbFile, layer: Clothed, precision: Precision, textures: dict[int, dict[str, Any]]
) -> None:
    """One mesh per look (dye and weave), in the order of the panels; textures: those stored already, by weave."""
    garment = layer.garment
    split, welded = split_along(garment.faces, garment.creases())
    shading = normals(garment.positions[welded], split)
    places = garment.cloth_places() * 1000.0
    looks: dict[Any, list[int]] = {}
    for number in range(len(garment.panels)):
        looks.setdefault((garment.dye_of(number), id(layer.of(number))), []).append(number)
    for count, ((dye, weave), own) in enumerate(looks.items()):
        mine = np.isin(garment.panel, own)
        corners = np.column_stack([garment.pattern_faces[mine].ravel(), split[mine].ravel()])
        used, index = np.unique(corners, axis=0, return_inverse=True)
        make = _cloth_close if precision == "close" else _cloth_hall
        name = garment.name if count == 0 else f"{garment.name} {count + 1}"
        glb.mesh(
            name,
            garment.positions[welded[used[:, 1]]],
            index.reshape(-1, 3).astype(np.int32),
            make(glb, dye, layer.of(own[0]), textures.setdefault(weave if precision == "close" else 0, {})),
            places[used[:, 0]],
            shading=shading[used[:, 1]],
        )


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


def _plain(name: str, colour: Colour, roughness: float) -> dict[str, Any]:
    """Matter of one colour [sRGB]."""
    return {
        "name": name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(float(c) for c in linear(np.asarray(colour))), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": roughness,
        },
    }


def _lacquer() -> dict[str, Any]:
    return _plain("lacquer", LACQUER, 0.38)


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


def _cloth_close(glb: GlbFile, dye: Colour | None, maps: MapsLike, textures: dict[str, Any]) -> int:
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


def _cloth_hall(glb: GlbFile, dye: Colour | None, maps: MapsLike, textures: dict[str, Any]) -> int:
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
