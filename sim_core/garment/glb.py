"""Our own GLB writer: the garment, its stand or figure as a further node, the weave's maps at true scale."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np

from sim_core.cloth import Cylinder
from sim_core.cloth.contact.solid_meshes import solid_mesh
from sim_core.errors import SimCoreError
from sim_core.garment.garment import Colour, Garment
from sim_core.garment.pattern import unsided
from sim_core.gltf import GlbFile
from sim_core.picture import normals
from sim_core.validation.files import written_whole
from sim_core.weave import Loom, Weave

Precision = Literal["close", "hall"]
LACQUER = (0.28, 0.165, 0.145)  # sRGB #482A25
LINEN = (0.84, 0.80, 0.73)  # sRGB
SHEER = 0.8  # mean coverage; denser cloth is drawn opaque, its pores as the shade between yarns
PORE = 0.35  # of the mean colour
SLUB_SIZE = 0.06  # [m] of cloth per tile of the hall's relief


@dataclass(frozen=True)
class Shown:
    """What is shown of a figure: vertices (V, 3) [m], faces (F, 3), normals (V, 3); base: its radius and height [m]."""

    vertices: np.ndarray
    faces: np.ndarray
    normals: np.ndarray
    base: tuple[float, float]


class MapsLike(Protocol):
    """The part of `sim_core.weave.SurfaceMaps` a GLB holds."""

    @property
    def albedo(self) -> np.ndarray: ...
    @property
    def normal(self) -> np.ndarray: ...
    @property
    def opacity(self) -> np.ndarray: ...
    @property
    def size(self) -> tuple[float, float]: ...


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


def write_glb(
    path: Path, layers: Sequence[Clothed], *, precision: Precision = "close", figure: Shown | None = None
) -> int:
    """Writes garments, from the skin outwards, and their stand or figure; returns the size in bytes.

    Panels of one look are one node: the garment's name, then its name and a number. Twins on a seam share place and
    normal, so that no seam shows but for its change of colour. A figure and what it wears stand on its base.

    Maps: tileable albedo, normal (n, m, 3) and opacity (n, m), uint8, size [m] of the tile. TEXCOORD_0 is in
    pattern millimetres, v not flipped; KHR_texture_transform brings it to tiles. close: the weave itself; hall:
    its mean colour and coverage and a coarser relief, since single yarns vanish beyond a hand's breadth.
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
    glb, lift = GlbFile(), np.array([0.0, figure.base[1] if figure else 0.0, 0.0])
    for layer in layers:
        raised = replace(layer.garment, positions=layer.garment.positions + lift)
        _write_panels(glb, replace(layer, garment=raised), precision, textures)
    outermost = layers[-1].garment
    if outermost.settled is not None and outermost.settled.beneath.stand is not None:
        vertices, faces = outermost.settled.beneath.stand.mesh(32 if precision == "close" else 16)
        glb.mesh("stand", vertices, faces, glb.material(_lacquer()))
    if figure is not None:
        glb.mesh(
            "figure", figure.vertices + lift, figure.faces, glb.material(_linen()), shading=figure.normals
        )
        base = Cylinder((0.0, 0.0, 0.0), (0.0, figure.base[1], 0.0), figure.base[0], 0.4 * figure.base[1])
        foot = solid_mesh(base, 48 if precision == "close" else 28)
        glb.mesh("base", *foot, glb.material(_lacquer()))
    data = glb.bytes(outermost.name, ["KHR_materials_sheen", "KHR_texture_transform"])
    with written_whole(Path(path)) as stream:
        stream.write(data)
    return len(data)


def _write_panels(
    glb: GlbFile, layer: Clothed, precision: Precision, textures: dict[int, dict[str, Any]]
) -> None:
    """One mesh per look (dye and weave), in the order of the panels; textures: those stored already, by weave."""
    garment = layer.garment
    shading, worn = normals(garment.positions, garment.faces)[garment.weld], garment.worn()
    looks: dict[Any, list[int]] = {}
    for number in range(len(garment.panels)):
        looks.setdefault((garment.dye_of(number), id(layer.of(number))), []).append(number)
    for count, ((dye, weave), own) in enumerate(looks.items()):
        faces = garment.pattern_faces[np.isin(garment.panel, own)]
        used, index = np.unique(faces, return_inverse=True)
        make = _cloth_close if precision == "close" else _cloth_hall
        name = garment.name if count == 0 else f"{garment.name} {count + 1}"
        glb.mesh(
            name,
            worn[used],
            index.reshape(-1, 3).astype(np.int32),
            make(glb, dye, layer.of(own[0]), textures.setdefault(weave if precision == "close" else 0, {})),
            garment.pattern[used] * 1000.0,
            shading=shading[used],
        )


def _linear(srgb: np.ndarray) -> np.ndarray:
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def _mean_colour(maps: MapsLike) -> np.ndarray:
    """Mean linear colour of the yarns, weighted by what they cover."""
    weight = maps.opacity.astype(float) + 1e-6
    return (_linear(maps.albedo / 255.0) * weight[..., None]).sum((0, 1)) / weight.sum()


def _coverage(maps: MapsLike) -> float:
    return float(maps.opacity.mean()) / 255


def _filled(maps: MapsLike, mean: np.ndarray) -> np.ndarray:
    """Albedo (n, m, 3) uint8 of a dense cloth: its pores take the shade of the yarns round them."""
    shade = 255 * np.where(
        mean * PORE <= 0.0031308, 12.92 * mean * PORE, 1.055 * (mean * PORE) ** (1 / 2.4) - 0.055
    )
    cover = maps.opacity[..., None] / 255.0
    return np.round(maps.albedo * cover + shade * (1 - cover)).astype(np.uint8)


def _dyed(dye: Colour | None, mean: np.ndarray) -> np.ndarray:
    return mean if dye is None else _linear(np.asarray(dye))


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


def _linen() -> dict[str, Any]:
    """The figure's cover: matt, light, without colour of its own."""
    return {
        "name": "linen",
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(float(c) for c in _linear(np.asarray(LINEN))), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.9,
        },
    }


def _lacquer() -> dict[str, Any]:
    return {
        "name": "lacquer",
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(float(c) for c in _linear(np.asarray(LACQUER))), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.38,
        },
    }


def _cloth_close(glb: GlbFile, dye: Colour | None, maps: MapsLike, textures: dict[str, Any]) -> int:
    mean = _mean_colour(maps)
    # The map is dyed by a factor, so that its mean becomes the dye and its variation stays the yarns'.
    factor = _dyed(dye, mean) / np.maximum(mean, 1e-3)
    material = _silk(factor, 1.0, "silk_close")
    sheer = _coverage(maps) < SHEER
    picture = np.dstack([maps.albedo, maps.opacity]) if sheer else _filled(maps, mean)
    tile = [1e-3 / float(maps.size[0]), 1e-3 / float(maps.size[1])]
    material["pbrMetallicRoughness"]["baseColorTexture"] = _once(
        textures, "colour", lambda: glb.texture(picture, tile)
    )
    normal = _once(textures, "normal", lambda: glb.texture(maps.normal, tile))
    material["normalTexture"] = {**normal, "scale": 1.0}
    if sheer:
        material["alphaMode"] = "BLEND"
    tint = _dyed(dye, mean)
    material["extensions"]["KHR_materials_sheen"]["sheenColorFactor"] = [
        float(c) for c in 0.55 * (0.5 * tint + 0.5)
    ]
    return glb.material(material)


def _cloth_hall(glb: GlbFile, dye: Colour | None, maps: MapsLike, textures: dict[str, Any]) -> int:
    cover = _coverage(maps)
    material = _silk(_dyed(dye, _mean_colour(maps)), round(cover, 4) if cover < SHEER else 1.0, "silk_hall")
    tile = [1e-3 / SLUB_SIZE, 1e-3 / SLUB_SIZE]
    normal = _once(textures, "normal", lambda: glb.texture(_slub_normal(256), tile))
    material["normalTexture"] = {**normal, "scale": 0.5}
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
