"""Our own GLB writer: the garment, and the stand as a second node, with the weave's maps at true scale."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.garment.model import Garment
from sim_core.garment.slub import slub_normal
from sim_core.garment.stand import Stand
from sim_core.picture import normals

Precision = Literal["close", "hall"]
LACQUER = (0.28, 0.165, 0.145)  # sRGB #482A25
SLUB_SIZE = 0.06  # [m] of cloth per tile of the hall's relief
_FLOAT, _U32 = 5126, 5125


class MapsLike(Protocol):
    """The part of `sim_core.weave.TextureMaps` a GLB holds."""

    @property
    def albedo(self) -> np.ndarray: ...
    @property
    def normal(self) -> np.ndarray: ...
    @property
    def opacity(self) -> np.ndarray: ...
    @property
    def size(self) -> tuple[float, float]: ...


def write_glb(
    path: Path,
    garment: Garment,
    maps: MapsLike,
    *,
    precision: Precision = "close",
    stand: Stand | None = None,
) -> int:
    """Writes the garment and, where it has one, its stand; returns the size in bytes.

    maps: tileable albedo, normal (n, m, 3) and opacity (n, m), uint8, size [m] of the tile. TEXCOORD_0 is in
    pattern millimetres, v not flipped; KHR_texture_transform brings it to tiles. close: the weave itself; hall:
    its mean colour and coverage and a coarser relief, since single yarns vanish beyond a hand's breadth.
    """
    if precision not in ("close", "hall"):
        raise SimCoreError(f"precision: {precision!r} – give 'close' or 'hall'")
    if maps.albedo.shape[:2] != maps.opacity.shape or min(maps.size) <= 0:
        raise SimCoreError(
            f"maps: albedo {maps.albedo.shape}, opacity {maps.opacity.shape} – sizes must agree"
        )
    glb = _Glb()
    cloth = _cloth_close(glb, garment, maps) if precision == "close" else _cloth_hall(glb, garment, maps)
    uv = garment.rest * 1000.0
    glb.mesh(garment.name, garment.positions, garment.faces, cloth, uv)
    if stand is None and "stand" in garment.provenance:
        stand = Stand(**garment.provenance["stand"])
    if stand is not None:
        vertices, faces = stand.mesh(32 if precision == "close" else 16)
        glb.mesh("stand", vertices, faces, glb.material(_lacquer()))
    data = glb.bytes(garment)
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(path.name + ".part")
    beside.write_bytes(data)
    beside.replace(path)
    return len(data)


def _linear(srgb: np.ndarray) -> np.ndarray:
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def _mean_colour(maps: MapsLike) -> np.ndarray:
    """Mean linear colour of the yarns, weighted by what they cover."""
    weight = maps.opacity.astype(float) + 1e-6
    return (_linear(maps.albedo / 255.0) * weight[..., None]).sum((0, 1)) / weight.sum()


def _dyed(garment: Garment, mean: np.ndarray) -> np.ndarray:
    return mean if garment.dye is None else _linear(np.asarray(garment.dye))


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


def _lacquer() -> dict[str, Any]:
    return {
        "name": "lacquer",
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(float(c) for c in _linear(np.asarray(LACQUER))), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.38,
        },
    }


def _cloth_close(glb: _Glb, garment: Garment, maps: MapsLike) -> int:
    mean = _mean_colour(maps)
    # The map is dyed by a factor, so that its mean becomes the dye and its variation stays the yarns'.
    factor = _dyed(garment, mean) / np.maximum(mean, 1e-3)
    material = _silk(factor, 1.0, "silk_close")
    sheer = float(maps.opacity.mean()) < 250
    picture = np.dstack([maps.albedo, maps.opacity]) if sheer else maps.albedo
    tile = [1e-3 / float(maps.size[0]), 1e-3 / float(maps.size[1])]
    material["pbrMetallicRoughness"]["baseColorTexture"] = glb.texture(picture, tile)
    material["normalTexture"] = {**glb.texture(maps.normal, tile), "scale": 1.0}
    if sheer:
        material["alphaMode"] = "BLEND"
    tint = _dyed(garment, mean)
    material["extensions"]["KHR_materials_sheen"]["sheenColorFactor"] = [
        float(c) for c in 0.55 * (0.5 * tint + 0.5)
    ]
    return glb.material(material)


def _cloth_hall(glb: _Glb, garment: Garment, maps: MapsLike) -> int:
    cover = float(maps.opacity.mean()) / 255
    material = _silk(
        _dyed(garment, _mean_colour(maps)), round(cover, 4) if cover < 0.98 else 1.0, "silk_hall"
    )
    tile = [1e-3 / SLUB_SIZE, 1e-3 / SLUB_SIZE]
    material["normalTexture"] = {**glb.texture(slub_normal(256), tile), "scale": 0.5}
    if cover < 0.98:
        material["alphaMode"] = "BLEND"
    return glb.material(material)


@dataclass
class _Glb:
    """A file under construction: the JSON part and the binary blob."""

    blob: bytearray = field(default_factory=bytearray)
    views: list[dict[str, Any]] = field(default_factory=list)
    accessors: list[dict[str, Any]] = field(default_factory=list)
    images: list[dict[str, Any]] = field(default_factory=list)
    materials: list[dict[str, Any]] = field(default_factory=list)
    meshes: list[dict[str, Any]] = field(default_factory=list)

    def _view(self, data: bytes, target: int | None = None) -> int:
        self.blob.extend(b"\0" * (-len(self.blob) % 4))
        view = {"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data)}
        self.views.append(view if target is None else {**view, "target": target})
        self.blob.extend(data)
        return len(self.views) - 1

    def _accessor(self, array: np.ndarray, kind: str, component: int, target: int) -> int:
        accessor = {
            "bufferView": self._view(array.tobytes(), target),
            "componentType": component,
            "count": len(array),
            "type": kind,
        }
        if kind == "VEC3" or kind == "SCALAR":
            flat = array.reshape(len(array), -1)
            accessor |= {"min": flat.min(0).tolist(), "max": flat.max(0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def texture(self, picture: np.ndarray, scale: list[float]) -> dict[str, Any]:
        """Stores a picture as PNG; returns a texture reference whose transform maps mm to tiles."""
        from PIL import Image

        stream = BytesIO()
        Image.fromarray(picture).save(stream, "PNG", optimize=True)
        self.images.append({"bufferView": self._view(stream.getvalue()), "mimeType": "image/png"})
        transform = {"KHR_texture_transform": {"scale": scale}}
        return {"index": len(self.images) - 1, "texCoord": 0, "extensions": transform}

    def material(self, material: dict[str, Any]) -> int:
        """Adds a material."""
        self.materials.append(material)
        return len(self.materials) - 1

    def mesh(
        self, name: str, vertices: np.ndarray, faces: np.ndarray, material: int, uv: np.ndarray | None = None
    ) -> None:
        """Adds a node with one mesh; normals are the mesh's own, area-weighted."""
        attributes = {
            "POSITION": self._accessor(vertices.astype("<f4"), "VEC3", _FLOAT, 34962),
            "NORMAL": self._accessor(normals(vertices, faces).astype("<f4"), "VEC3", _FLOAT, 34962),
        }
        if uv is not None:
            attributes["TEXCOORD_0"] = self._accessor(uv.astype("<f4"), "VEC2", _FLOAT, 34962)
        kind, component = ("<u2", 5123) if len(vertices) < 65535 else ("<u4", _U32)
        index = self._accessor(faces.astype(kind).reshape(-1), "SCALAR", component, 34963)
        primitive = {"attributes": attributes, "indices": index, "material": material}
        self.meshes.append({"name": name, "primitives": [primitive]})

    def bytes(self, garment: Garment) -> bytes:
        """The finished file."""
        self.blob.extend(b"\0" * (-len(self.blob) % 4))
        numbers = range(len(self.meshes))
        document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "sim_core.garment"},
            "extensionsUsed": ["KHR_materials_sheen", "KHR_texture_transform"],
            "scene": 0,
            "scenes": [{"name": garment.name, "nodes": list(numbers)}],
            "nodes": [{"name": self.meshes[k]["name"], "mesh": k} for k in numbers],
            "meshes": self.meshes,
            "materials": self.materials,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(self.blob)}],
            "images": self.images,
            "samplers": [{"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497}],
            "textures": [{"source": k, "sampler": 0} for k in range(len(self.images))],
        }
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        size = 12 + 8 + len(text) + 8 + len(self.blob)
        head = struct.pack("<4sII", b"glTF", 2, size) + struct.pack("<I4s", len(text), b"JSON")
        return head + text + struct.pack("<I4s", len(self.blob), b"BIN\0") + bytes(self.blob)
