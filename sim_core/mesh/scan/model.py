"""A level of a scan as a GLB: one mesh, one picture, lit as cloth without gleam."""

from __future__ import annotations

import io

import numpy as np

from sim_core.gltf import GlbFile
from sim_core.mesh.scan.levels import Level
from sim_core.mesh.scan.texture import Layout

__all__ = ["scan_glb"]

ROUGHNESS = 0.9
QUALITY = 88  # JPEG


def scan_glb(level: Level, layout: Layout, picture: np.ndarray, name: str) -> bytes:
    """The file's bytes. Corners where charts part are vertices of one place and one normal: no light shows where.

    The hall's real lights need normals and a base colour, which is the picture (size, size, 3) uint8 sRGB; vertex
    colours would be taken for baked light.
    """
    from PIL import Image

    key = level.faces.astype(np.int64) * (int(layout.chart.max()) + 1) + layout.chart[:, None]
    _, first, index = np.unique(key, return_index=True, return_inverse=True)
    own = level.faces.reshape(-1)[first]
    uv = layout.place.reshape(-1, 2)[first] / layout.size
    stream = io.BytesIO()
    Image.fromarray(picture).save(stream, "JPEG", quality=QUALITY, optimize=True)
    glb = GlbFile()
    look = {"baseColorTexture": glb.picture(stream.getvalue(), "image/jpeg")}
    material = glb.material(
        {
            "name": "scan",
            "doubleSided": True,
            "pbrMetallicRoughness": {**look, "metallicFactor": 0.0, "roughnessFactor": ROUGHNESS},
        }
    )
    faces = index.reshape(-1, 3).astype(np.int32)
    glb.mesh(name, level.vertices[own], faces, material, uv=uv, shading=level.normals[own])
    return glb.bytes(name, [], "sim_core.mesh.scan")
