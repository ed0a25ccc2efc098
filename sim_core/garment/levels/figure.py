"""What of a dressed figure is shown: the faces no robe hides, and for the hall a coarser mesh of them."""

from __future__ import annotations

import numpy as np

from sim_core.garment.glb import Shown
from sim_core.garment.levels.thinning import Thinning
from sim_core.picture import normals
from sim_core.picture.raster import depth_map, lit

__all__ = ["shown_figure", "seen"]

DIRECTIONS, PIXELS = 96, 700
HIGHEST, LOWEST = 0.85, -0.2  # sines of the elevations from which a visitor may look
BIAS = 0.003  # [m] less than the cloth's distance from the skin
BASE = (0.21, 0.025)  # [m] radius and height of the disc it stands on


def seen(vertices: np.ndarray, cloth: np.ndarray, cloth_faces: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Which vertices (V,) of a figure are seen past the cloth (C, 3) from any of the directions a visitor may look."""
    everything = np.concatenate([vertices, cloth])
    found = np.zeros(len(vertices), bool)
    golden = np.pi * (3 - np.sqrt(5))
    for k in range(DIRECTIONS):
        y = HIGHEST - (HIGHEST - LOWEST) * (k + 0.5) / DIRECTIONS
        ring = np.sqrt(1 - y * y)
        rows = _axes(np.array([ring * np.cos(golden * k), y, ring * np.sin(golden * k)]))
        flat = everything @ rows.T
        low = flat.min(0)
        scale = (PIXELS - 4) / float(np.ptp(flat[:, :2], axis=0).max())
        flat[:, :2] = 2 + (flat[:, :2] - low[:2]) * scale
        depth = np.full((PIXELS, PIXELS), np.inf)
        depth_map(flat[len(vertices) :], cloth_faces.astype(np.int32), depth)
        depth_map(flat[: len(vertices)], faces.astype(np.int32), depth)
        found |= lit(flat[: len(vertices)], depth, BIAS, 0) > 0.5
    return found


def _axes(direction: np.ndarray) -> np.ndarray:
    """Rows: right, up and away from an eye in `direction`."""
    helper = np.array([0.0, 1.0, 0.0]) if abs(direction[1]) < 0.99 else np.array([0.0, 0.0, -1.0])
    side = np.cross(-direction, helper)
    side /= np.linalg.norm(side)
    return np.stack([side, np.cross(side, -direction), -direction])


def shown_figure(
    vertices: np.ndarray,
    faces: np.ndarray,
    cloth: np.ndarray,
    cloth_faces: np.ndarray,
    *,
    triangles: int | None = None,
    rings: int = 2,
) -> Shown:
    """The visible part of a figure with `rings` of faces around it.

    triangles: thinned to that many (None: all are kept). Normals are the fine figure's.
    """
    visible = seen(vertices, cloth, cloth_faces, faces)
    for _ in range(rings):
        visible[faces[visible[faces].any(1)]] = True
    kept = faces[visible[faces].all(1)]
    shading = normals(vertices, faces)
    if triangles is not None:
        mesh = Thinning(vertices, kept, np.arange(len(vertices)))
        mesh.to(triangles)
        kept = mesh.faces()
    used, index = np.unique(kept, return_inverse=True)
    return Shown(vertices[used], index.reshape(-1, 3).astype(np.int32), shading[used], BASE)
