"""A model drawn, so that a curator sees what he brought before anybody sees it in the hall."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["portrait"]

_SIZE = (480, 600)  # [pixels]
_FROM = np.array([0.34, 0.2, 0.92])  # from slightly beside its front
_FOV = 28.0  # [degrees]


def portrait(path: Path) -> bytes:
    """A picture of the GLB, as JPEG: its shape, each part in its mean colour. Raises what foreign files bring about."""
    import trimesh
    from PIL import Image

    from sim_core.picture import Camera, Surface, render

    surfaces = []
    meshes: Any = trimesh.load_scene(path, file_type="glb").dump()
    for mesh in meshes:
        faces = np.asarray(getattr(mesh, "faces", ()), np.int32)
        if len(faces):
            surfaces.append(Surface(np.asarray(mesh.vertices, float), faces, _colour(mesh.visual)))
    points = np.concatenate([one.vertices for one in surfaces])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    radius = float(np.linalg.norm(points - middle, axis=1).max())
    eye = middle + _FROM / np.linalg.norm(_FROM) * radius / np.sin(np.radians(_FOV / 2))
    camera = Camera(tuple(eye), tuple(middle), _FOV)
    drawn = io.BytesIO()
    Image.fromarray(render(surfaces, camera, _SIZE)).save(drawn, "JPEG", quality=85)
    return drawn.getvalue()


def _colour(visual: Any) -> tuple[float, float, float]:
    """sRGB, 0..1."""
    material = getattr(visual, "material", None)
    if material is None:
        colours = np.asarray(visual.vertex_colors, float).reshape(-1, 4)
    elif (picture := getattr(material, "baseColorTexture", None)) is not None:
        colours = np.asarray(picture.convert("RGB").resize((8, 8)), float).reshape(-1, 3)
    else:
        linear = np.asarray(material.main_color, float).reshape(-1, 4) / 255
        colours = 255 * linear ** (1 / 2.2)
    red, green, blue = (float(one) / 255 for one in colours[:, :3].mean(axis=0))
    return red, green, blue
