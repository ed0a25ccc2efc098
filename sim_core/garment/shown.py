"""What of a dressed figure is shown: the faces no robe hides, and for the hall a coarser mesh of them."""

from __future__ import annotations

import numpy as np

from sim_core.garment.glb import Shown
from sim_core.picture import normals
from sim_core.raster import depth_map, lit

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
    cell: float | None = None,
    rings: int = 3,
) -> Shown:
    """The visible part of a figure with `rings` of faces around it.

    cell [m]: vertices in one cube of that size become one (None: all are kept). Normals are the fine figure's.
    """
    visible = seen(vertices, cloth, cloth_faces, faces)
    for _ in range(rings):
        visible[faces[visible[faces].any(1)]] = True
    kept = faces[visible[faces].all(1)]
    shading = normals(vertices, faces)
    if cell is not None:
        vertices, shading, kept = _clustered(vertices, shading, kept, cell)
    used, index = np.unique(kept, return_inverse=True)
    return Shown(vertices[used], index.reshape(-1, 3).astype(np.int32), shading[used], BASE)


def _clustered(
    vertices: np.ndarray, shading: np.ndarray, faces: np.ndarray, cell: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """One vertex per cube and side of the surface: its mean place, moved out to keep the curve, and mean normal."""
    used = np.unique(faces)
    turned = np.abs(shading[used]).argmax(1) * 2 + (
        np.take_along_axis(shading[used], np.abs(shading[used]).argmax(1)[:, None], 1)[:, 0] > 0
    )
    keys = np.column_stack([np.floor(vertices[used] / cell).astype(int), turned])
    _, label = np.unique(keys, axis=0, return_inverse=True)
    label = label.reshape(-1)
    count = np.bincount(label)
    place = np.stack([np.bincount(label, vertices[used, c]) / count for c in range(3)], axis=1)
    normal = np.stack([np.bincount(label, shading[used, c]) / count for c in range(3)], axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    number = np.zeros(len(vertices), int)
    number[used] = label
    new = number[faces]
    solid = (new[:, 0] != new[:, 1]) & (new[:, 1] != new[:, 2]) & (new[:, 2] != new[:, 0])
    _, first = np.unique(np.sort(new[solid], axis=1), axis=0, return_index=True)
    return place, normal, new[solid][np.sort(first)]
