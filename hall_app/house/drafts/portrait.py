"""A model drawn, so that a curator sees what he brought before anybody sees it in the hall."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hall_app.house.drafts.shape import few, mesh_of

if TYPE_CHECKING:
    from sim_core.picture import Surface

__all__ = ["portrait"]

_SIZE = (480, 600)  # [pixels]
_FROM = np.array([0.34, 0.2, 0.92])  # from slightly beside its front
_FOV = 28.0  # [degrees]


def portrait(path: Path, ending: str) -> bytes:
    """A picture as JPEG: the form, each part of a GLB in its mean colour. ending: of what the file holds.

    Raises what foreign files bring about.
    """
    from PIL import Image

    from sim_core.picture import Camera, render

    surfaces = _parts(path) if ending == ".glb" else [_whole(path, ending)]
    points = np.concatenate([one.vertices for one in surfaces])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    radius = float(np.linalg.norm(points - middle, axis=1).max())
    eye = middle + _FROM / np.linalg.norm(_FROM) * radius / np.sin(np.radians(_FOV / 2))
    camera = Camera(tuple(eye), tuple(middle), _FOV)
    drawn = io.BytesIO()
    Image.fromarray(render(surfaces, camera, _SIZE)).save(drawn, "JPEG", quality=85)
    return drawn.getvalue()


def _parts(path: Path) -> list[Surface]:
    import trimesh

    from sim_core.picture import Surface

    surfaces = []
    meshes: Any = trimesh.load_scene(path, file_type="glb").dump()
    for mesh in meshes:
        faces = np.asarray(getattr(mesh, "faces", ()), np.int32)
        if len(faces):
            surfaces.append(Surface(np.asarray(mesh.vertices, float), faces, _colour(mesh.visual)))
    return surfaces


def _whole(path: Path, ending: str) -> Surface:
    """A scan, made coarse, in its mean colour."""
    from sim_core.picture import Surface

    vertices, faces, colours = few(mesh_of(path, ending))
    red, green, blue = (float(one) / 255 for one in colours.mean(axis=0))
    return Surface(vertices, faces.astype(np.int32), (red, green, blue))


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
