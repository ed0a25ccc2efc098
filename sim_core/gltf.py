"""Binary glTF: written (`GlbFile`) and read (`glb_parts`), with numpy and nothing else."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass, field
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["GlbError", "GlbFile", "GlbParts", "glb_parts", "node_matrix", "row_size"]

VERTICES, INDICES = 34962, 34963  # what a buffer view holds
FLOAT, U8, U16, U32 = 5126, 5121, 5123, 5125
COMPONENTS = {5120: "i1", U8: "u1", 5122: "<i2", U16: "<u2", U32: "<u4", FLOAT: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
HEADER = 20  # bytes ahead of the JSON part: the file's header and the part's own
MAGIC, JSON_PART = b"glTF", b"JSON"


class GlbError(ValueError):
    """The file is no readable, plain GLB; `fix` says what to do."""

    def __init__(self, what: str, fix: str) -> None:
        super().__init__(what)
        self.fix = fix


@dataclass(frozen=True)
class GlbParts:
    """A GLB that was read: its bytes, its JSON part, and where in them its binary part begins.

    Its methods raise what an inconsistent document brings about: KeyError, IndexError, TypeError or ValueError.
    """

    data: bytes
    document: dict[str, Any]
    begin: int

    def numbers(self, accessor: int) -> NDArray[np.float64]:
        """(N, width) an accessor's numbers; fractions where they are normalised."""
        entry = self.document["accessors"][accessor]
        view = self.document["bufferViews"][entry["bufferView"]]
        kind, width = np.dtype(COMPONENTS[entry["componentType"]]), WIDTHS[entry["type"]]
        start = self.begin + view.get("byteOffset", 0) + entry.get("byteOffset", 0)
        stride = view.get("byteStride", row_size(entry))
        if stride < row_size(entry):  # a few bytes would be as many rows as it says
            raise ValueError("an accessor's rows overlap")
        rows = np.ndarray((entry["count"], width), kind, self.data, start, (stride, kind.itemsize))
        values = rows.astype(float)
        return values / np.iinfo(kind).max if entry.get("normalized") else values

    def picture_place(self, image: int) -> tuple[int, int]:
        """Begin and end in the file of an image that it holds itself."""
        view = self.document["bufferViews"][self.document["images"][image]["bufferView"]]
        begin = self.begin + view.get("byteOffset", 0)
        return begin, begin + view["byteLength"]

    def picture_places(self) -> list[tuple[int, int]]:
        """Of every image that it holds itself, in their order."""
        images = enumerate(self.document.get("images", ()))
        return [self.picture_place(number) for number, image in images if "bufferView" in image]

    def picture(self, image: int) -> bytes:
        """An image that it holds itself, as it is encoded."""
        begin, end = self.picture_place(image)
        return self.data[begin:end]

    def pictures(self) -> list[bytes]:
        """Every image that it holds itself, as it is encoded."""
        return [self.data[begin:end] for begin, end in self.picture_places()]


def glb_parts(data: bytes) -> GlbParts:
    """The parts of a GLB. Raises GlbError naming why it is none."""
    broken = "the GLB is broken or cut off"
    if len(data) < HEADER or data[:4] != MAGIC:
        raise GlbError("not a GLB file", "export the model as binary glTF 2.0 (.glb)")
    version, length, size, kind = struct.unpack_from("<III4s", data, 4)
    if version != 2 or length > len(data):
        what = f"{broken}: {len(data)} bytes of {length}, version {version}"
        raise GlbError(what, "copy or export it again")
    if kind != JSON_PART or HEADER + size > len(data):
        raise GlbError(f"{broken}: no JSON part", "export the model again")
    try:
        document = json.loads(data[HEADER : HEADER + size])
    except (ValueError, RecursionError) as error:
        raise GlbError(f"{broken}: its JSON part cannot be read", "export the model again") from error
    if not isinstance(document, dict):
        raise GlbError(f"{broken}: its JSON part is no object", "export the model again")
    return GlbParts(data, document, HEADER + size + 8)


@dataclass
class GlbFile:
    """A binary glTF 2.0 file under construction: the JSON part and the binary blob."""

    blob: bytearray = field(default_factory=bytearray)
    views: list[dict[str, Any]] = field(default_factory=list)
    accessors: list[dict[str, Any]] = field(default_factory=list)
    images: list[dict[str, Any]] = field(default_factory=list)
    materials: list[dict[str, Any]] = field(default_factory=list)
    meshes: list[dict[str, Any]] = field(default_factory=list)
    animations: list[dict[str, Any]] = field(default_factory=list)
    copies: list[dict[str, Any]] = field(default_factory=list)
    told: dict[int, dict[str, Any]] = field(default_factory=dict)  # of a mesh's node

    def _view(self, data: bytes, target: int | None = None) -> int:
        self.blob.extend(b"\0" * (-len(self.blob) % 4))
        view = {"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data)}
        self.views.append(view if target is None else {**view, "target": target})
        self.blob.extend(data)
        return len(self.views) - 1

    def _accessor(self, array: np.ndarray, kind: str, component: int, target: int | None = None) -> int:
        accessor = {
            "bufferView": self._view(array.tobytes(), target),
            "componentType": component,
            "count": len(array),
            "type": kind,
        }
        if kind == "VEC4" or (kind == "VEC2" and component == U16):
            accessor["normalized"] = True
        if kind in ("VEC3", "SCALAR"):
            flat = array.reshape(len(array), -1)
            accessor |= {"min": flat.min(0).tolist(), "max": flat.max(0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def texture(
        self, picture: np.ndarray, scale: list[float], *, quality: int | None = None
    ) -> dict[str, Any]:
        """Stores a picture as PNG, or as JPEG of a quality; returns a reference whose transform maps mm to tiles."""
        from PIL import Image

        stream = BytesIO()
        if quality is None:
            Image.fromarray(picture).save(stream, "PNG", optimize=True)
        else:
            Image.fromarray(picture).save(stream, "JPEG", quality=quality, subsampling=0, optimize=True)
        transform = {"KHR_texture_transform": {"scale": scale}}
        kind = "image/png" if quality is None else "image/jpeg"
        return {**self.picture(stream.getvalue(), kind), "extensions": transform}

    def picture(self, data: bytes, mime: str) -> dict[str, Any]:
        """Stores an encoded picture, "image/png", "image/jpeg" or "image/webp"; returns a reference to its texture.

        A file with WebP names EXT_texture_webp among its extensions.
        """
        self.images.append({"bufferView": self._view(data), "mimeType": mime})
        return {"index": len(self.images) - 1, "texCoord": 0}

    def _texture_entry(self, image: int) -> dict[str, Any]:
        if self.images[image]["mimeType"] == "image/webp":
            return {"sampler": 0, "extensions": {"EXT_texture_webp": {"source": image}}}
        return {"sampler": 0, "source": image}

    def material(self, material: dict[str, Any]) -> int:
        """Adds a material."""
        self.materials.append(material)
        return len(self.materials) - 1

    def mesh(
        self,
        name: str,
        vertices: np.ndarray,
        faces: np.ndarray,
        material: int,
        uv: np.ndarray | None = None,
        colours: np.ndarray | None = None,
        *,
        uv1: np.ndarray | None = None,
        shading: np.ndarray | bool = True,
    ) -> None:
        """Adds a node with one mesh: vertices (V, 3) [m], faces (F, 3), uv (V, 2), colours (V, 3) linear 0..1, or as
        uint8 where steps of a 255th do not show.

        uv1: (V, 2) in 0..1, of a light map, kept as 16-bit fractions. Normals are the mesh's own, area-weighted,
        unless `shading` (V, 3) gives them; with False, for what is unlit, and with colours alone it has none.
        """
        from sim_core.picture import normals  # compiled: who only reads needs none of it

        attributes = {"POSITION": self._accessor(vertices.astype("<f4"), "VEC3", FLOAT, VERTICES)}
        if shading is True and colours is None:
            shading = normals(vertices, faces)
        if not isinstance(shading, bool):
            attributes["NORMAL"] = self._accessor(shading.astype("<f4"), "VEC3", FLOAT, VERTICES)
        if colours is not None:
            component, most = (U8, 255) if colours.dtype == np.uint8 else (U16, 65535)
            if component == U16:
                colours = np.round(np.clip(colours, 0, 1) * most)
            opaque = np.c_[colours, np.full(len(colours), most)].astype(COMPONENTS[component])
            attributes["COLOR_0"] = self._accessor(opaque, "VEC4", component, VERTICES)
        if uv is not None:
            attributes["TEXCOORD_0"] = self._accessor(uv.astype("<f4"), "VEC2", FLOAT, VERTICES)
        if uv1 is not None:
            fractions = np.round(np.clip(uv1, 0, 1) * 65535).astype("<u2")
            attributes["TEXCOORD_1"] = self._accessor(fractions, "VEC2", U16, VERTICES)
        kind, component = ("<u2", U16) if len(vertices) < 65535 else ("<u4", U32)
        index = self._accessor(faces.astype(kind).reshape(-1), "SCALAR", component, INDICES)
        primitive = {"attributes": attributes, "indices": index, "material": material}
        self.meshes.append({"name": name, "primitives": [primitive]})

    def copy(self, name: str, mesh: int, shift: np.ndarray) -> None:
        """Adds a node with a mesh that is there already, shifted (3,) [m]."""
        self.copies.append({"name": name, "mesh": mesh, "translation": [float(x) for x in shift]})

    def levels(self, near: range, far: range, distance: float) -> None:
        """Makes these meshes two levels of one model, of which the far one is to be seen beyond a distance [m].

        glTF has no word for that. Nodes tell it by `extras`, {"until": distance} and {"from": distance}, and far ones
        have no size, so that whoever does not read it shows the near level alone.
        """
        self.told |= {mesh: {"extras": {"until": distance}} for mesh in near}
        self.told |= {mesh: {"extras": {"from": distance}, "scale": [0.0, 0.0, 0.0]} for mesh in far}

    def move(self, mesh: int, ways: np.ndarray) -> None:
        """Gives a mesh morph targets: ways (K, V, 3) [m] of its vertices."""
        targets = [{"POSITION": self._accessor(way.astype("<f4"), "VEC3", FLOAT, VERTICES)} for way in ways]
        if targets:
            self.meshes[mesh]["primitives"][0]["targets"] = targets
            self.meshes[mesh]["weights"] = [0.0] * len(targets)

    def animate(self, name: str, times: np.ndarray, weights: np.ndarray) -> None:
        """An animation of all meshes that have morph targets: times (T,) [s], weights (T, K) of the targets then."""
        told = {
            "input": self._accessor(times.astype("<f4"), "SCALAR", FLOAT),
            "output": self._accessor(weights.astype("<f4").reshape(-1), "SCALAR", FLOAT),
            "interpolation": "LINEAR",
        }
        moved = [number for number, mesh in enumerate(self.meshes) if "weights" in mesh]
        channels = [{"sampler": 0, "target": {"node": number, "path": "weights"}} for number in moved]
        self.animations.append({"name": name, "samplers": [told], "channels": channels})

    def bytes(self, name: str, extensions: list[str], generator: str = "sim_core.garment") -> bytes:
        """The finished file; `name` is the scene's, `extensions` are those its materials use."""
        self.blob.extend(b"\0" * (-len(self.blob) % 4))
        own = [
            {"name": mesh["name"], "mesh": k, **self.told.get(k, {})} for k, mesh in enumerate(self.meshes)
        ]
        nodes = own + self.copies
        document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": generator},
            "scene": 0,
            "scenes": [{"name": name, "nodes": list(range(len(nodes)))}],
            "nodes": nodes,
            "meshes": self.meshes,
            "materials": self.materials,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(self.blob)}],
        }
        if extensions:
            document["extensionsUsed"] = extensions
        if self.animations:
            document["animations"] = self.animations
        if self.images:
            document["images"] = self.images
            document["samplers"] = [{"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497}]
            document["textures"] = [self._texture_entry(k) for k in range(len(self.images))]
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        size = 12 + 8 + len(text) + 8 + len(self.blob)
        head = struct.pack("<4sII", MAGIC, 2, size) + struct.pack("<I4s", len(text), JSON_PART)
        return head + text + struct.pack("<I4s", len(self.blob), b"BIN\0") + bytes(self.blob)


def row_size(accessor: dict[str, Any]) -> int:
    """Bytes of one row of an accessor, packed closely."""
    return np.dtype(COMPONENTS[accessor["componentType"]]).itemsize * WIDTHS[accessor["type"]]


def node_matrix(node: dict[str, Any]) -> np.ndarray:
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
