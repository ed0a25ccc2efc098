"""A picture of a panel mesh: faces coloured by quality, edges, outline."""

import numpy as np

from sim_core.mesh.measures.triangles import quality
from sim_core.mesh.model import PanelMesh

__all__ = ["mesh_picture"]

POOR, GOOD = np.array([206, 92, 60]), np.array([236, 238, 232])
MARGIN = 24
OVERSAMPLE = 2


def mesh_picture(mesh: PanelMesh, *, size: int = 1200) -> np.ndarray:
    """Draw a mesh as (n, m, 3) uint8, its longer side `size` pixels; faces from red (30 degrees) to pale (60)."""
    from PIL import Image, ImageDraw

    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    scale = (size - 2 * MARGIN) * OVERSAMPLE / float((high - low).max())
    width, height = (int(v) for v in np.ceil((high - low) * scale) + 2 * MARGIN * OVERSAMPLE)
    image = Image.new("RGB", (width, height), "white")
    draw = ImageDraw.Draw(image)
    places = (mesh.vertices - low) * scale + MARGIN * OVERSAMPLE
    share = np.clip((quality(mesh.vertices, mesh.faces).min_angle - 30) / 30, 0, 1)[:, None]
    colours = np.rint(POOR + (GOOD - POOR) * share).astype(int)
    for face, colour in zip(mesh.faces, colours, strict=True):
        corners = [tuple(p) for p in places[face]]
        draw.polygon(corners, fill=tuple(colour.tolist()))
        draw.line([*corners, corners[0]], fill=(70, 84, 92), width=1)
    for loop in mesh.boundary:
        draw.line([tuple(p) for p in places[[*loop, loop[0]]]], fill=(20, 30, 40), width=2 * OVERSAMPLE)
    return np.asarray(image.resize((width // OVERSAMPLE, height // OVERSAMPLE), Image.Resampling.LANCZOS))
