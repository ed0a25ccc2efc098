"""What shines, grouped for sampling: every emitting chart is one lamp, its triangles picked by area."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hall_app.light.atlas.texels import face_normals
from hall_app.light.model import Spot, Surfaces

__all__ = ["Lamps", "SpotRows", "lamps_of", "spot_rows"]

Singles = NDArray[np.float32]


class Lamps(NamedTuple):
    """K lamps of T triangles.

    lamp: (F,) int32 of each face, −1: dark; first: (K + 1,) int32 triangles of a lamp; share: (T,) float32 rising to 1
    within a lamp; face: (T,) int32; corners: (T, 3, 3) [m]; area: (K,) [m²]; power: (K,) area × mean radiosity;
    middle: (K, 3) [m]; radius: (K,) [m]; facing: (K, 3) mean normal, short where a lamp shines all round;
    normal: (F, 3).
    """

    lamp: NDArray[np.int32]
    first: NDArray[np.int32]
    share: Singles
    face: NDArray[np.int32]
    corners: Singles
    area: Singles
    power: Singles
    middle: Singles
    radius: Singles
    facing: Singles
    normal: Singles


class SpotRows(NamedTuple):
    """Spots as rows: place, unit axis, light at 1 m (S, 3); inner and outer cosine, radius (S,)."""

    place: Singles
    axis: Singles
    light: Singles
    inner: Singles
    outer: Singles
    radius: Singles


def lamps_of(surfaces: Surfaces) -> Lamps:
    """The emitting faces, grouped by chart (those without one stand alone), largest radiosity kept as given."""
    normals = face_normals(surfaces)
    corners = surfaces.vertices[surfaces.faces]
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(doubled, axis=1) / 2
    glowing = np.flatnonzero((surfaces.emission.max(1) > 0) & (area > 0))
    group = np.where(surfaces.chart >= 0, surfaces.chart, len(surfaces.density) + np.arange(len(area)))
    names, number = np.unique(group[glowing], return_inverse=True)
    lamp = np.full(len(area), -1, np.int32)
    lamp[glowing] = number
    order = glowing[np.argsort(number, kind="stable")]
    count = len(names)
    first = np.searchsorted(np.sort(number), np.arange(count + 1)).astype(np.int32)
    share = np.zeros(len(order))
    rows = np.zeros((3, count, 3))
    for k in range(count):
        faces = order[first[k] : first[k + 1]]
        rising = np.cumsum(area[faces])
        share[first[k] : first[k + 1]] = rising / rising[-1]
        points = corners[faces].reshape(-1, 3)
        middle = (points.min(0) + points.max(0)) / 2
        glow = (surfaces.emission[faces].mean(1) * area[faces]).sum()
        radius = np.linalg.norm(points - middle, axis=1).max()
        rows[:, k] = middle, doubled[faces].sum(0) / 2 / rising[-1], [rising[-1], glow, radius]
    single = np.float32
    return Lamps(
        lamp,
        first,
        share.astype(single),
        order.astype(np.int32),
        corners[order].astype(single),
        rows[2, :, 0].astype(single),
        rows[2, :, 1].astype(single),
        rows[0].astype(single),
        rows[2, :, 2].astype(single),
        rows[1].astype(single),
        normals.astype(single),
    )


def spot_rows(spots: Sequence[Spot]) -> SpotRows:
    """Spots as the kernels read them."""
    place = np.array([spot.position for spot in spots]).reshape(-1, 3)
    axis = np.array([spot.towards for spot in spots]).reshape(-1, 3) - place
    axis /= np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-12)
    light = np.array([spot.power * spot.colour for spot in spots]).reshape(-1, 3)
    cone = np.array([[spot.cone, spot.cone + spot.soft + 1e-3] for spot in spots]).reshape(-1, 2)
    inner, outer = np.cos(np.radians(cone)).T
    radius = np.array([spot.radius for spot in spots])
    return SpotRows(
        *(np.ascontiguousarray(a, np.float32) for a in (place, axis, light, inner, outer, radius))
    )
