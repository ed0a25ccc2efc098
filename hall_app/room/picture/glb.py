"""The room as one GLB: meshes of one material each, drawn unlit, with tiling textures and, once baked, a light map.

A renderer leaves out what lies beside or behind the view mesh by mesh, and a software renderer pays for every corner
that it does not: so what reaches through all of the hall is cut into neighbourhoods.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hall_app.room.patch import Patch
from hall_app.room.raising import Room
from hall_app.room.surface.palette import MATERIALS, linear
from hall_app.room.surface.textures import texture
from sim_core.gltf import GlbFile

if TYPE_CHECKING:
    from hall_app.light.model import LightMap

__all__ = ["room_glb"]

Floats = NDArray[np.float64]
_TEXTURE_QUALITY, _SHEET_QUALITY = 87, 70
_SHEET_BYTES, _LEAST_QUALITY = 186_000, 30  # photographs weigh more than letters do
_SHADED_SHEET_QUALITY = 72  # where corners carry colours, too: both kinds of room keep within the same bytes
_UNLIT, _WEBP = "KHR_materials_unlit", "EXT_texture_webp"
# Triangles of a mesh: half of the room or less is drawn before an exhibit, by 20 to 60 calls.
_NEIGHBOURS = 650
# Even light from above and a little from the front left, for a room whose light is not baked.
_TOP, _SIDE, _UNDER, _SWING = 1.0, 0.86, 0.66, 0.08


def room_glb(room: Room, light: LightMap | None = None) -> bytes:
    """The GLB of the room; without `light` it is shaded by the surfaces' directions alone."""
    glb = GlbFile()
    corners = None if light is None else _corners(room, light)
    quality = _SHADED_SHEET_QUALITY if light is None else _SHEET_QUALITY
    rng = np.random.default_rng(3)
    offsets = rng.random((len(room.patches), 2))
    for name in MATERIALS:
        chosen = [k for k, patch in enumerate(room.patches) if patch.material == name]
        if not chosen:
            continue
        material = _material(glb, name, room, [room.patches[k] for k in chosen], quality)
        lit = corners is not None and not MATERIALS[name].glow
        for near in _neighbourhoods(room.patches, chosen):
            patches = [room.patches[k] for k in near]
            starts = np.cumsum([0, *(len(patch.vertices) for patch in patches)])
            faces = np.concatenate([p.faces + s for p, s in zip(patches, starts, strict=False)])
            uv = np.concatenate([_uv(room.patches[k], offsets[k]) for k in near])
            glb.mesh(
                f"hall_{name}",
                np.concatenate([patch.vertices for patch in patches]),
                faces,
                material,
                uv if MATERIALS[name].texture is not None else None,
                colours=_shade(patches) if light is None and not MATERIALS[name].glow else None,
                uv1=np.concatenate([corners[k] for k in near]) if corners is not None and lit else None,
                shading=False,
            )
    if light is not None:
        _add_light(glb, light)
    return glb.bytes("hall", [_UNLIT, _WEBP], "hall_app.room")


def _neighbourhoods(patches: Sequence[Patch], chosen: Sequence[int]) -> list[list[int]]:
    """The chosen patches' numbers in groups of at most _NEIGHBOURS triangles, halved across their longest side."""
    counts = np.array([len(patches[k].faces) for k in chosen])
    if counts.sum() <= _NEIGHBOURS or len(chosen) == 1:
        return [list(chosen)]
    middles = np.array([(patches[k].vertices.min(0) + patches[k].vertices.max(0)) / 2 for k in chosen])
    order = np.argsort(middles[:, np.ptp(middles, axis=0).argmax()], kind="stable")
    half = int(np.searchsorted(np.cumsum(counts[order]), counts.sum() / 2)) + 1
    cut = min(half, len(chosen) - 1)
    sides = order[:cut], order[cut:]
    return [group for side in sides for group in _neighbourhoods(patches, [chosen[k] for k in side])]


def _uv(patch: Patch, offset: Floats) -> Floats:
    """Texture coordinates: metres along and across the grain in repeats, shifted at random from patch to patch."""
    if patch.uv is not None:
        return patch.uv
    order = [patch.grain, 1 - patch.grain]
    return patch.flat[:, order] / MATERIALS[patch.material].tile + offset


def _material(glb: GlbFile, name: str, room: Room, patches: list[Patch], quality: int) -> int:
    """quality: of the picture of signs."""
    material = MATERIALS[name]
    look: dict[str, Any] = {"metallicFactor": 0.0, "roughnessFactor": 1.0}
    if material.texture == "signs":
        look["baseColorTexture"] = glb.picture(_sheet(room.sheet.picture, quality), "image/webp")
    elif material.texture is not None:
        look["baseColorTexture"] = glb.picture(_tile(material.texture, material.colour), "image/jpeg")
    else:
        look["baseColorFactor"] = [*linear(material.colour).tolist(), 1.0]
    return glb.material(
        {
            "name": f"hall_{name}",
            "doubleSided": any(patch.two_sided for patch in patches),
            "pbrMetallicRoughness": look,
            "extensions": {_UNLIT: {}},
        }
    )


def _sheet(picture: NDArray[np.uint8], quality: int) -> bytes:
    """The picture of signs as WebP, coarser where it would weigh too much."""
    while True:
        made = _encoded(picture, "WEBP", quality=quality, method=6)
        if len(made) <= _SHEET_BYTES or quality <= _LEAST_QUALITY:
            return made
        quality -= 6


@lru_cache(maxsize=64)
def _tile(name: str, colour: str) -> bytes:
    """A material's texture as JPEG; the same for every room."""
    options = {"quality": _TEXTURE_QUALITY, "subsampling": 0, "optimize": True}
    return _encoded(texture(name, colour), "JPEG", **options)


def _encoded(picture: NDArray[np.uint8], kind: str, **options: Any) -> bytes:
    from PIL import Image

    stream = BytesIO()
    Image.fromarray(picture).save(stream, kind, **options)
    return stream.getvalue()


def _shade(patches: list[Patch]) -> NDArray[np.uint8]:
    """(V, 3) factors on the colours, of 255, by the direction each patch's triangles look in."""
    shades = [np.broadcast_to(_even(patch)[:, None], patch.vertices.shape) for patch in patches]
    return np.rint(255 * np.clip(np.concatenate(shades), 0.0, 1.0)).astype(np.uint8)


def _even(patch: Patch) -> Floats:
    corners = patch.vertices[patch.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    summed = np.zeros_like(patch.vertices)
    for k in range(3):
        np.add.at(summed, patch.faces[:, k], normals)
    summed /= np.maximum(np.linalg.norm(summed, axis=1, keepdims=True), 1e-12)
    x, y, z = summed.T
    side = _SIDE + _SWING * (-0.5 * x + 0.86 * z)
    return np.where(y > 0, side + (_TOP - side) * y**2, side + (_UNDER - side) * y**2)


def _corners(room: Room, light: LightMap) -> list[Floats]:
    """Per patch (V, 2): where its vertices lie in the light map."""
    found, start = [], 0
    for patch in room.patches:
        uv = np.zeros((len(patch.vertices), 2))
        uv[patch.faces.reshape(-1)] = light.uv[start : start + len(patch.faces)].reshape(-1, 2)
        found.append(uv)
        start += len(patch.faces)
    return found


def _add_light(glb: GlbFile, light: LightMap) -> None:
    """The light map, carried by a triangle of a millimetre deep under the floor."""
    from hall_app.light import light_jpeg

    data = light_jpeg(light)
    look = {"baseColorTexture": glb.picture(data, "image/jpeg"), "metallicFactor": 0.0}
    material = glb.material({"name": "lightmap", "pbrMetallicRoughness": look, "extensions": {_UNLIT: {}}})
    points = np.array([[0, -5, 0], [0.001, -5, 0], [0, -5, 0.001]])
    glb.mesh("lightmap", points, np.array([[0, 2, 1]]), material, np.zeros((3, 2)), shading=False)
