"""Coloured triangles as a GLB that is drawn without lights (KHR_materials_unlit)."""

from __future__ import annotations

import json
import struct

import numpy as np

from .room import Part

__all__ = ["unlit_glb"]

_ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER = 34962, 34963
_FLOAT, _UNSIGNED_SHORT, _UNSIGNED_INT = 5126, 5123, 5125


def unlit_glb(parts: dict[str, Part], *, double_sided: bool = False) -> bytes:
    """One mesh node a part; colours are linear 0..1, kept as 16-bit fractions. Empty parts are left out."""
    binary = bytearray()
    views: list[dict] = []
    accessors: list[dict] = []

    def add(array: np.ndarray, kind: str, component: int, target: int, **extra: object) -> int:
        data = array.tobytes()
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data), "target": target})
        binary.extend(data + b"\0" * (-len(data) % 4))
        accessors.append(
            {
                "bufferView": len(views) - 1,
                "componentType": component,
                "count": len(array),
                "type": kind,
                **extra,
            }
        )
        return len(accessors) - 1

    names = [name for name, part in parts.items() if len(part.faces)]
    meshes = []
    for name in names:
        part = parts[name]
        position = part.vertices.astype("<f4")
        low, high = position.min(axis=0).tolist(), position.max(axis=0).tolist()
        colour = np.ones((len(position), 4))
        colour[:, :3] = np.clip(part.colours, 0, 1)
        attributes = {
            "POSITION": add(position, "VEC3", _FLOAT, _ARRAY_BUFFER, min=low, max=high),
            "COLOR_0": add(
                np.round(colour * 65535).astype("<u2"),
                "VEC4",
                _UNSIGNED_SHORT,
                _ARRAY_BUFFER,
                normalized=True,
            ),
        }
        indices = add(part.faces.astype("<u4").reshape(-1), "SCALAR", _UNSIGNED_INT, _ELEMENT_ARRAY_BUFFER)
        meshes.append(
            {"name": name, "primitives": [{"attributes": attributes, "indices": indices, "material": 0}]}
        )
    document = {
        "asset": {"version": "2.0", "generator": "hall_app.scene"},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{"nodes": list(range(len(names)))}],
        "nodes": [{"name": name, "mesh": index} for index, name in enumerate(names)],
        "meshes": meshes,
        "materials": [{"doubleSided": double_sided, "extensions": {"KHR_materials_unlit": {}}}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    total = 12 + 8 + len(text) + 8 + len(binary)
    return b"".join(
        (
            struct.pack("<4sII", b"glTF", 2, total),
            struct.pack("<I4s", len(text), b"JSON"),
            text,
            struct.pack("<I4s", len(binary), b"BIN\0"),
            bytes(binary),
        )
    )
