"""A small room as the hall's bake writes it: unlit meshes "hall_*" and a light map on a hidden triangle."""

import io
import json
import struct

import numpy as np
from PIL import Image

UNLIT = "KHR_materials_unlit"
WIDTH, DEPTH, HEIGHT = 16.0, 12.0, 3.0  # [m]


def lit_room(*, light: bool = True, lit: bool = False) -> bytes:
    """The GLB. `light`: with its map; `lit`: materials for real lights in place of unlit ones.

    The map's left half is full light, its right half a fifth of it: a picture of the room tells whether it is on.
    """
    shades = np.full((16, 32, 3), _srgb(0.5))
    shades[:, 16:] = _srgb(0.1)
    tiles = np.full((64, 64, 3), 150)
    tiles[:32, :32] = tiles[32:, 32:] = 190
    quads = {
        "hall_floor": _quad((-8, 0, 6), (WIDTH, 0, 0), (0, 0, -DEPTH)),
        "hall_far": _quad((-8, 0, -6), (WIDTH, 0, 0), (0, HEIGHT, 0)),
        "hall_near": _quad((8, 0, 6), (-WIDTH, 0, 0), (0, HEIGHT, 0), flip=True),
    }
    glb = _Glb(lit)
    tile = glb.material("hall_stone", tiles)
    for name, corners in quads.items():
        glb.mesh(name, corners, tile)
    if light:
        glb.mesh("lightmap", _quad((0, -50, 0), (1e-3, 0, 0), (0, 0, 1e-3)), glb.material("lightmap", shades))
    return glb.bytes()


def environment(colour: tuple[int, int, int] = (210, 190, 160)) -> bytes:
    """An equirectangular JPEG: a bright ceiling over a dim floor."""
    picture = np.zeros((64, 128, 3), np.uint8)
    picture[:32] = colour
    picture[32:] = np.asarray(colour) // 3
    stream = io.BytesIO()
    Image.fromarray(picture).save(stream, "JPEG", quality=90)
    return stream.getvalue()


def _srgb(linear: float) -> int:
    return round(255 * (1.055 * linear ** (1 / 2.4) - 0.055))


def _quad(at, right, up, *, flip: bool = False):
    """Corners (4, 3) [m], tiles' and light map's coordinates (4, 2) each."""
    at, right, up = (np.asarray(value, float) for value in (at, right, up))
    corners = np.array([at, at + right, at + right + up, at + up])
    unit = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], float)
    size = np.array([np.linalg.norm(right), np.linalg.norm(up)])
    return corners, unit * size, np.column_stack([1 - unit[:, 0], unit[:, 1]]) if flip else unit


class _Glb:
    def __init__(self, lit: bool) -> None:
        self.lit, self.blob = lit, bytearray()
        self.views, self.accessors, self.images, self.materials, self.meshes = [], [], [], [], []

    def _view(self, data: bytes) -> int:
        self.blob.extend(b"\0" * (-len(self.blob) % 4))
        self.views.append({"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data)})
        self.blob.extend(data)
        return len(self.views) - 1

    def _floats(self, array: np.ndarray) -> int:
        entry = {"bufferView": self._view(array.astype("<f4").tobytes()), "componentType": 5126}
        entry |= {"count": len(array), "type": f"VEC{array.shape[1]}"}
        self.accessors.append(entry | {"min": array.min(0).tolist(), "max": array.max(0).tolist()})
        return len(self.accessors) - 1

    def material(self, name: str, picture: np.ndarray) -> int:
        stream = io.BytesIO()
        Image.fromarray(picture.astype(np.uint8)).save(stream, "PNG")
        self.images.append({"bufferView": self._view(stream.getvalue()), "mimeType": "image/png"})
        look = {
            "baseColorTexture": {"index": len(self.images) - 1},
            "metallicFactor": 0,
            "roughnessFactor": 0.9,
        }
        unlit = {} if self.lit else {"extensions": {UNLIT: {}}}
        self.materials.append({"name": name, "pbrMetallicRoughness": look, **unlit})
        return len(self.materials) - 1

    def mesh(self, name: str, corners, material: int) -> None:
        places, tiles, light = corners
        attributes = {"POSITION": self._floats(places), "TEXCOORD_0": self._floats(tiles)}
        if name != "lightmap":
            attributes["TEXCOORD_1"] = self._floats(light)
        faces = np.array([0, 1, 2, 0, 2, 3], "<u2")
        self.accessors.append(
            {"bufferView": self._view(faces.tobytes()), "componentType": 5123, "count": 6, "type": "SCALAR"}
        )
        primitive = {"attributes": attributes, "indices": len(self.accessors) - 1, "material": material}
        self.meshes.append({"name": name, "primitives": [primitive]})

    def bytes(self) -> bytes:
        self.blob.extend(b"\0" * (-len(self.blob) % 4))
        document = {
            "asset": {"version": "2.0"},
            "extensionsUsed": [] if self.lit else [UNLIT],
            "scene": 0,
            "scenes": [{"nodes": list(range(len(self.meshes)))}],
            "nodes": [{"name": mesh["name"], "mesh": k} for k, mesh in enumerate(self.meshes)],
            "meshes": self.meshes,
            "materials": self.materials,
            "images": self.images,
            "samplers": [{"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497}],
            "textures": [{"source": k, "sampler": 0} for k in range(len(self.images))],
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(self.blob)}],
        }
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        size = 12 + 8 + len(text) + 8 + len(self.blob)
        head = struct.pack("<4sII", b"glTF", 2, size) + struct.pack("<I4s", len(text), b"JSON")
        return head + text + struct.pack("<I4s", len(self.blob), b"BIN\0") + bytes(self.blob)
