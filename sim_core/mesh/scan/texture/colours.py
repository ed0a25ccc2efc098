"""A scan's colours, asked for by face and place, and drawn into the picture of a coarser mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import njit

from sim_core.mesh.scan.levels import Level
from sim_core.mesh.scan.scan import Scan
from sim_core.mesh.scan.texture.charts import Layout
from sim_core.metrics import Surface

__all__ = ["Colours", "painted"]

CHUNK = 200_000  # pixels drawn at a time
SPOTS = np.array([(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)])  # in each pixel
GREY = 128


@dataclass(frozen=True)
class Colours:
    """A scan that is asked for its colours; surface: the same, sorted."""

    scan: Scan
    surface: Surface

    def at(self, face: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """(N, 3) float sRGB 0..255 at places: face (N,), weights (N, 3) of its corners."""
        scan = self.scan
        found = np.full((len(face), 3), float(GREY))
        number = scan.picture[face]
        bare = number < 0
        if scan.colours is not None and bare.any():
            corners = scan.colours[scan.faces[face[bare]]].astype(float)
            found[bare] = np.einsum("nk,nkc->nc", weights[bare], corners)
        for index, picture in enumerate(scan.pictures):
            rows = np.flatnonzero(number == index)
            if not len(rows):
                continue
            if picture.size == 3 or scan.uv is None:
                found[rows] = picture[0, 0]
                continue
            uv = np.einsum("nk,nkc->nc", weights[rows], scan.uv[face[rows]].astype(float))
            found[rows] = between(picture, np.nan_to_num(uv))
        return found


@njit(cache=True, error_model="numpy")
def between(picture, uv):
    """(N, 3) bilinear look-ups of a picture (H, W, 3) uint8 that repeats; uv (N, 2), v downwards."""
    high, wide = picture.shape[0], picture.shape[1]
    out = np.zeros((len(uv), 3))
    for n in range(len(uv)):
        x, y = (uv[n, 0] - np.floor(uv[n, 0])) * wide - 0.5, (uv[n, 1] - np.floor(uv[n, 1])) * high - 0.5
        i, j = int(np.floor(x)), int(np.floor(y))
        s, t = x - i, y - j
        left, right, top, bottom = i % wide, (i + 1) % wide, j % high, (j + 1) % high
        for c in range(3):
            above = (1.0 - s) * picture[top, left, c] + s * picture[top, right, c]
            below = (1.0 - s) * picture[bottom, left, c] + s * picture[bottom, right, c]
            out[n, c] = (1.0 - t) * above + t * below
    return out


def painted(
    level: Level,
    layout: Layout,
    colours: Colours,
    reach: float,
    progress: Callable[[float], None] = lambda share: None,
) -> np.ndarray:
    """(size, size, 3) uint8 sRGB: the picture of a coarse mesh laid out so, each pixel the mean of four places of the
    scan that are nearest to it and look its way, within `reach` [m]; pixels of no face are those next to them."""
    from scipy.ndimage import distance_transform_edt

    picture = np.zeros((layout.size, layout.size, 3), np.uint8)
    rows, columns = np.nonzero(layout.owner >= 0)
    for begin in range(0, len(rows), CHUNK):
        y, x = rows[begin : begin + CHUNK], columns[begin : begin + CHUNK]
        face = layout.owner[y, x]
        corners, normals = level.vertices[level.faces[face]], level.normals[level.faces[face]]
        total = np.zeros((len(face), 3))
        for spot in SPOTS:
            weights = _weights(layout.place[face], np.stack([x, y], axis=1) + spot)
            points = np.einsum("nk,nkd->nd", weights, corners)
            facing = np.einsum("nk,nkd->nd", weights, normals)
            total += colours.at(*colours.surface.places(points, facing, reach))
        picture[y, x] = np.rint(np.clip(total / len(SPOTS), 0, 255))
        progress(min(1.0, (begin + CHUNK) / len(rows)))
    if len(rows):
        near = np.zeros((2, layout.size, layout.size), np.int32)
        distance_transform_edt(layout.owner < 0, return_distances=False, return_indices=True, indices=near)
        picture = picture[near[0], near[1]]
    return picture


def _weights(place: np.ndarray, spot: np.ndarray) -> np.ndarray:
    """(N, 3) weights of corners (N, 3, 2) at spots (N, 2), none below 0."""
    a, b, c = place[:, 0], place[:, 1], place[:, 2]
    u, v, w = b - a, c - a, spot - a
    area = u[:, 0] * v[:, 1] - v[:, 0] * u[:, 1]
    s = (w[:, 0] * v[:, 1] - v[:, 0] * w[:, 1]) / area
    t = (u[:, 0] * w[:, 1] - w[:, 0] * u[:, 1]) / area
    weights = np.clip(np.stack([1 - s - t, s, t], axis=1), 0, 1)
    return weights / weights.sum(1, keepdims=True)
