"""A scan from a GLB: every triangle that its scene shows, nodes' transforms applied."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim_core.gltf import GlbError, GlbParts, glb_parts, node_matrix
from sim_core.mesh.scan.files.pictures import decoded, plain
from sim_core.mesh.scan.scan import MOST_TRIANGLES, Scan, ScanError

__all__ = ["read_glb_scan"]

TRIANGLES = 4
PACKED = {  # what would need a decoder, and how to be rid of it
    "KHR_draco_mesh_compression": "open it in Blender and export it as .glb with Compression off",
    **dict.fromkeys(
        ("EXT_meshopt_compression", "KHR_meshopt_compression"),
        "unpack it by: gltfpack -noq -i scan.glb -o plain.glb",
    ),
    "KHR_texture_basisu": "export it again with its pictures as PNG or JPEG",
}


@dataclass(frozen=True)
class _Piece:
    """One primitive where it stands."""

    vertices: np.ndarray
    faces: np.ndarray
    uv: np.ndarray | None
    material: int
    colours: np.ndarray | None


def read_glb_scan(path: Path) -> Scan:
    """The scan in a GLB. Raises ScanError naming the fault, OSError where it cannot be read."""
    try:
        parts = glb_parts(path.read_bytes())
        _refuse(parts.document)
        pieces = list(_pieces(parts))
        if not pieces:
            raise ScanError("it holds no triangles", "export the scan with its mesh")
        return _joined(parts, pieces)
    except GlbError as error:
        raise ScanError(str(error), error.fix) from error
    except (
        KeyError,
        IndexError,
        TypeError,
        AttributeError,
        ValueError,
        ArithmeticError,
        RecursionError,
    ) as error:
        if isinstance(error, ScanError):
            raise
        reason = f"{type(error).__name__}: {error}"[:120]
        raise ScanError(
            f"it is cut off, or its glTF part is inconsistent ({reason})", "export it again"
        ) from error


def _refuse(document: dict[str, Any]) -> None:
    named = {*document.get("extensionsUsed", ()), *document.get("extensionsRequired", ())}
    for extension, fix in PACKED.items():
        if extension in named:
            raise ScanError(f"it is compressed by {extension}", fix)
    for entry in [*document.get("buffers", ()), *document.get("images", ())]:
        if "uri" in entry:
            shown = str(entry["uri"])[:60]
            raise ScanError(
                f"it refers to another file, {shown!r}", "export it with everything embedded (.glb)"
            )
    many = sum(
        document["accessors"][p.get("indices", p["attributes"]["POSITION"])]["count"] // 3
        for mesh in document.get("meshes", ())
        for p in mesh["primitives"]
    )
    if many > MOST_TRIANGLES:
        raise ScanError(
            f"it has {many} triangles, at most {MOST_TRIANGLES}", "decimate it in the scanning software"
        )


def _pieces(parts: GlbParts) -> Iterator[_Piece]:
    document = parts.document
    nodes = document.get("nodes", [])
    children = {child for node in nodes for child in node.get("children", ())}
    scenes = document.get("scenes", [])
    roots = [n for n in range(len(nodes)) if n not in children]
    if scenes:
        roots = scenes[document.get("scene", 0)].get("nodes", [])
    todo, met = [(n, np.eye(4)) for n in reversed(roots)], set()
    while todo:
        number, above = todo.pop()
        if number in met:
            raise ScanError(f"its node {number} has two parents or is in a loop", "export it again")
        met.add(number)
        node = nodes[number]
        matrix = above @ node_matrix(node)
        todo += [(child, matrix) for child in node.get("children", ())]
        if "mesh" in node:
            for primitive in document["meshes"][node["mesh"]]["primitives"]:
                yield _piece(parts, primitive, matrix)


def _piece(parts: GlbParts, primitive: dict[str, Any], matrix: np.ndarray) -> _Piece:
    if primitive.get("mode", TRIANGLES) != TRIANGLES:
        raise ScanError("it holds strips, lines or points", "export it as single triangles")
    attributes, document = primitive["attributes"], parts.document
    for number in (*attributes.values(), *([primitive["indices"]] if "indices" in primitive else [])):
        if "sparse" in document["accessors"][number]:
            raise ScanError("it holds sparse accessors", "export it again, without shape keys")
    points = parts.numbers(attributes["POSITION"])
    index = np.arange(len(points))
    if "indices" in primitive:
        index = parts.numbers(primitive["indices"]).reshape(-1)
    faces = index[: len(index) // 3 * 3].astype(np.int64).reshape(-1, 3)
    if len(faces) and not 0 <= faces.min() <= faces.max() < len(points):
        raise ScanError("its triangles name vertices that it does not hold", "export it again")
    if np.linalg.det(matrix[:3, :3]) < 0:
        faces = faces[:, ::-1]
    material = primitive.get("material", -1)
    channel, turn = _texture(document, material)
    uv = None
    if channel in attributes:
        uv = parts.numbers(attributes[channel])[:, :2] @ turn[:2, :2].T + turn[:2, 2]
    colours = None
    if "COLOR_0" in attributes:
        colours = _srgb(parts.numbers(attributes["COLOR_0"])[:, :3])
    with np.errstate(all="ignore"):  # what is not finite is counted later
        placed = points @ matrix[:3, :3].T + matrix[:3, 3]
    return _Piece(placed, faces, uv, material, colours)


def _texture(document: dict[str, Any], material: int) -> tuple[str, np.ndarray]:
    """The attribute a material's picture goes by, and what KHR_texture_transform does to it (3, 3)."""
    look = document["materials"][material].get("pbrMetallicRoughness", {}) if material >= 0 else {}
    told = look.get("baseColorTexture", {})
    moved = told.get("extensions", {}).get("KHR_texture_transform", {})
    cosine, sine = np.cos(moved.get("rotation", 0.0)), np.sin(moved.get("rotation", 0.0))
    turn = np.eye(3)
    turn[:2, :2] = np.array([[cosine, sine], [-sine, cosine]]) * np.array(moved.get("scale", (1.0, 1.0)))
    turn[:2, 2] = moved.get("offset", (0.0, 0.0))
    return f"TEXCOORD_{moved.get('texCoord', told.get('texCoord', 0))}", turn


def _joined(parts: GlbParts, pieces: list[_Piece]) -> Scan:
    begin = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    faces = np.concatenate([piece.faces + start for piece, start in zip(pieces, begin[:-1], strict=True)])
    materials = sorted({piece.material for piece in pieces})
    # What has vertex colours and no picture shows these alone.
    painted = {m: all(p.colours is not None for p in pieces if p.material == m) for m in materials}
    pictures, numbers = [], {}
    for material in materials:
        drawn = any(piece.uv is not None for piece in pieces if piece.material == material)
        picture = _picture(parts, material, 1 / len(materials), textured=drawn)
        if picture.size > 3 or not painted[material]:
            numbers[material] = len(pictures)
            pictures.append(picture)
    uv = np.zeros((len(faces), 3, 2), np.float32)
    at, number = 0, np.full(len(faces), -1, np.int16)
    for piece in pieces:
        rows = slice(at, at := at + len(piece.faces))
        number[rows] = numbers.get(piece.material, -1)
        if piece.uv is not None:
            uv[rows] = piece.uv[piece.faces]
    colours = None
    if any(piece.colours is not None for piece in pieces):
        white = [
            np.full((len(p.vertices), 3), 255, np.uint8) if p.colours is None else p.colours for p in pieces
        ]
        colours = np.concatenate(white)
    vertices = np.concatenate([piece.vertices for piece in pieces])
    return Scan(vertices, faces.astype(np.int32), uv, number, tuple(pictures), colours)


def _picture(parts: GlbParts, material: int, share: float, *, textured: bool) -> np.ndarray:
    """A material's picture times its factor."""
    document = parts.document
    look = document["materials"][material].get("pbrMetallicRoughness", {}) if material >= 0 else {}
    factor = np.array(look.get("baseColorFactor", (1.0, 1.0, 1.0, 1.0))[:3], float)
    if not textured or "baseColorTexture" not in look:
        return plain(factor if material >= 0 else np.full(3, 0.5))
    texture = document["textures"][look["baseColorTexture"]["index"]]
    source = texture.get("source", texture.get("extensions", {}).get("EXT_texture_webp", {}).get("source"))
    begin, end = parts.picture_place(source)
    if end > len(parts.data):
        raise ScanError("it is cut off: a picture goes beyond its end", "copy or export it again")
    picture = decoded(parts.data[begin:end], f"number {source}", share)
    if np.all(factor == 1.0):
        return picture
    light = _linear(np.arange(256) / 255)[:, None] * factor
    tones = np.rint(255 * _encoded(light)).astype(np.uint8)
    return np.stack([tones[picture[..., c], c] for c in range(3)], axis=-1)


def _linear(srgb: np.ndarray) -> np.ndarray:
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def _encoded(light: np.ndarray) -> np.ndarray:
    value = np.clip(light, 0, 1)
    return np.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1 / 2.4) - 0.055)


def _srgb(linear: np.ndarray) -> np.ndarray:
    """Vertex colours, linear in glTF, as sRGB bytes."""
    return np.rint(255 * _encoded(np.nan_to_num(linear))).astype(np.uint8)
