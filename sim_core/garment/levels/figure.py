"""What of a dressed figure is shown: the faces no robe hides, and for the hall a coarser mesh of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim_core.body.mannequin import Piece
from sim_core.garment.glb import Part, Shown
from sim_core.garment.levels.thinning import Thinning
from sim_core.picture import fan, normals
from sim_core.picture.raster import seen_from

__all__ = ["shown_figure", "seen"]

DIRECTIONS, PIXELS = 96, 700
HIGHEST, LOWEST = 0.85, -0.2  # sines of the elevations from which a visitor may look
BIAS = 0.003  # [m] less than the cloth's distance from the skin
BASE = (0.21, 0.025)  # [m] radius and height of the disc it stands on


def seen(vertices: np.ndarray, cloth: np.ndarray, cloth_faces: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Which vertices (V,) of a figure are seen past the cloth (C, 3) from any of the directions a visitor may look."""
    points = np.concatenate([vertices, cloth])
    everything = np.concatenate([faces, np.asarray(cloth_faces) + len(vertices)]).astype(np.int32)
    return seen_from(points, len(vertices), everything, fan(DIRECTIONS, HIGHEST, LOWEST), PIXELS, BIAS)


def shown_figure(
    vertices: np.ndarray,
    faces: np.ndarray,
    cloth: np.ndarray,
    cloth_faces: np.ndarray,
    *,
    triangles: int | None = None,
    rings: int = 2,
    moments: Sequence[tuple[np.ndarray, np.ndarray]] = (),
    worn: Sequence[Piece] = (),
) -> Shown:
    """The visible part of a figure with `rings` of faces around it.

    triangles: thinned to that many (None: all are kept). Normals are the fine figure's. moments: where figure and cloth
    are at other times, vertices (V, 3) and (C, 3) [m] each: what is seen then is shown, too. worn: what the figure
    wears by itself.
    """
    visible = seen(vertices, cloth, cloth_faces, faces)
    for figure, dress in moments:
        visible |= seen(figure, dress, cloth_faces, faces)
    for _ in range(rings):
        visible[faces[visible[faces].any(1)]] = True
    kept = faces[visible[faces].all(1)]
    shading = normals(vertices, faces)
    piece = np.zeros(len(kept), int)
    for number, one in enumerate(worn, 1):
        piece[one.faces(kept)] = number
    if triangles is not None:
        # Edges of what it wears keep their lines, as seams do: there each side has a twin of its own.
        twins, corners = np.unique(
            np.column_stack([kept.ravel(), np.repeat(piece, 3)]), axis=0, return_inverse=True
        )
        mesh = Thinning(vertices, corners.reshape(-1, 3), twins[:, 0])
        mesh.to(triangles)
        kept, piece = twins[mesh.faces(), 0], piece[mesh.numbers()]
    used, index = np.unique(kept, return_inverse=True)
    parts = tuple(Part(one.name, one.dye, piece == number) for number, one in enumerate(worn, 1))
    return Shown(vertices[used], index.reshape(-1, 3).astype(np.int32), shading[used], BASE, parts)
