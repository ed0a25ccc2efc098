"""Reading a GLB's header: is it one, is it plain, how much does it hold? numpy only, no drawing."""

from __future__ import annotations

import io
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

# The page has no decoder for these: it would look for one on the network, and the hall works without.
REFUSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu")
MAGIC, JSON_CHUNK = 0x46546C67, 0x4E4F534A
TRIANGLES, STRIP, FAN = 4, 5, 6
Corner = tuple[float, float, float]


class GlbError(ValueError):
    """The file is no readable, plain GLB; `fix` says what to do."""

    def __init__(self, what: str, fix: str) -> None:
        super().__init__(what)
        self.fix = fix


@dataclass(frozen=True)
class GlbInfo:
    """What a GLB holds.

    size: bytes; triangles: as drawn; textures: (width, height) [pixels] of each image; low, high: lowest and
    highest corner [m] of the whole model with its nodes' transforms.
    """

    size: int
    triangles: int
    textures: tuple[tuple[int, int], ...]
    extensions: tuple[str, ...]
    low: Corner
    high: Corner


def read_glb(path: Path) -> GlbInfo:
    """Read header and JSON of the GLB at `path`. Raises GlbError naming the fault, OSError if unreadable."""
    data = path.read_bytes()
    document, binary = _chunks(data)
    extensions = tuple(document.get("extensionsUsed", ()))
    refused = sorted(set(extensions) & set(REFUSED))
    if refused:
        raise GlbError(
            f"uses {', '.join(refused)}, which the hall cannot draw offline",
            "export it again without compression",
        )
    try:
        _no_outside_files(document)
        triangles = _triangles(document)
        low, high = _bounds(document)
        return GlbInfo(len(data), triangles, _textures(document, binary), extensions, low, high)
    except GlbError:
        raise
    except (KeyError, IndexError, TypeError, AttributeError, ValueError) as error:
        raise GlbError(f"its glTF part is inconsistent ({error!r})", "export the model again") from error


def open_glb(path: Path) -> tuple[dict[str, Any], bytes]:
    """The glTF document and the binary blob of the GLB at `path`. Raises GlbError if it is none."""
    return _chunks(path.read_bytes())


def _chunks(data: bytes) -> tuple[dict[str, Any], bytes]:
    broken = "the GLB is broken or cut off"
    if len(data) < 20 or struct.unpack_from("<I", data)[0] != MAGIC:
        raise GlbError("not a GLB file", "export the model as binary glTF 2.0 (.glb)")
    _, version, length = struct.unpack_from("<III", data)
    if version != 2 or length > len(data):
        raise GlbError(
            f"{broken}: {len(data)} bytes of {length}, version {version}", "copy or export it again"
        )
    size, kind = struct.unpack_from("<II", data, 12)
    if kind != JSON_CHUNK or 20 + size > len(data):
        raise GlbError(f"{broken}: no JSON part", "export the model again")
    try:
        document = json.loads(data[20 : 20 + size])
    except (ValueError, RecursionError) as error:
        raise GlbError(f"{broken}: its JSON part cannot be read", "export the model again") from error
    if not isinstance(document, dict):
        raise GlbError(f"{broken}: its JSON part is no object", "export the model again")
    return document, data[20 + size + 8 :]


def _no_outside_files(document: dict[str, Any]) -> None:
    for entry in [*document.get("buffers", ()), *document.get("images", ())]:
        if not entry.get("uri", "data:").startswith("data:"):
            raise GlbError(f"refers to another file {entry['uri']!r}", "export with everything embedded")


def _triangles(document: dict[str, Any]) -> int:
    """Triangles drawn, each mesh counted as often as nodes show it."""
    per_mesh = [sum(_drawn(document, p) for p in mesh["primitives"]) for mesh in document.get("meshes", ())]
    shown = [node["mesh"] for node in document.get("nodes", ()) if "mesh" in node]
    if not shown or not sum(per_mesh):
        raise GlbError("holds no triangles", "export the model with its meshes")
    return sum(per_mesh[mesh] for mesh in shown)


def _drawn(document: dict[str, Any], primitive: dict[str, Any]) -> int:
    index = primitive.get("indices", primitive["attributes"]["POSITION"])
    count = document["accessors"][index]["count"]
    mode = primitive.get("mode", TRIANGLES)
    return count // 3 if mode == TRIANGLES else max(0, count - 2) if mode in (STRIP, FAN) else 0


def _bounds(document: dict[str, Any]) -> tuple[Corner, Corner]:
    """Box round all shown meshes: the corners of each accessor's box, moved by the nodes above it."""
    nodes = document["nodes"]
    scene = document.get("scenes", [{}])[document.get("scene", 0)]
    children = {child for node in nodes for child in node.get("children", ())}
    roots = scene.get("nodes", [index for index in range(len(nodes)) if index not in children])
    corners: list[np.ndarray] = []
    todo = [(index, np.eye(4)) for index in roots]
    for _ in range(len(nodes)):  # a node has one parent: more turns would be a loop in the file
        if not todo:
            break
        index, above = todo.pop()
        matrix = above @ _matrix(nodes[index])
        todo += [(child, matrix) for child in nodes[index].get("children", ())]
        if "mesh" in nodes[index]:
            for primitive in document["meshes"][nodes[index]["mesh"]]["primitives"]:
                accessor = document["accessors"][primitive["attributes"]["POSITION"]]
                box = np.array(np.meshgrid(*zip(accessor["min"], accessor["max"], strict=True)))
                corners.append(box.reshape(3, -1).T @ matrix[:3, :3].T + matrix[:3, 3])
    points = np.concatenate(corners)
    low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _matrix(node: dict[str, Any]) -> np.ndarray:
    """A node's own transform (4, 4): its matrix, or translation, rotation [x, y, z, w] and scale."""
    if "matrix" in node:
        return np.array(node["matrix"], dtype=float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    turn = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(turn) * np.array(node.get("scale", (1.0, 1.0, 1.0)))
    matrix[:3, 3] = node.get("translation", (0.0, 0.0, 0.0))
    return matrix


def _textures(document: dict[str, Any], binary: bytes) -> tuple[tuple[int, int], ...]:
    from PIL import Image

    sizes = []
    for image in document.get("images", ()):
        if "bufferView" not in image:
            continue
        view = document["bufferViews"][image["bufferView"]]
        start = view.get("byteOffset", 0)
        try:
            with Image.open(io.BytesIO(binary[start : start + view["byteLength"]])) as picture:
                sizes.append(picture.size)
        except OSError as error:
            raise GlbError("one of its textures cannot be read", "embed textures as PNG or JPEG") from error
    return tuple(sizes)
