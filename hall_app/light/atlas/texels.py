"""Texels as places in the room: up to nine points each, spread over what the texel covers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hall_app.light.atlas.packing import Atlas
from hall_app.light.model import Surfaces

__all__ = ["FINE", "Places", "face_normals", "places_of"]

FINE = 3  # points along a texel's side
_CREASE = np.cos(np.radians(46.0))  # neighbours in a chart within this angle are shaded as one round surface
_LIFT = 2e-4  # [m] points float above their face, clear of rounding

Singles = NDArray[np.float32]
Ints = NDArray[np.int32]


@dataclass(frozen=True)
class Places:
    """N things that gather light (texels, then both sides of every face without a chart), M points on them.

    slot: (N,) int32 where the light is kept: row × width + column, or H·W + 2 × face's number + side;
    first: (N + 1,) int32 each thing's points; both: (N,) bool, gathers on both sides;
    point, normal, plane: (M, 3) float32 place [m], shading normal, true normal.
    """

    slot: Ints
    first: Ints
    both: NDArray[np.bool_]
    point: Singles
    normal: Singles
    plane: Singles

    def without(self, dropped: NDArray[np.bool_]) -> Places:
        """The places without the points (M,) that are dropped; things keep their slots, maybe without points."""
        kept = ~dropped
        first = np.r_[0, np.cumsum(kept)][self.first].astype(np.int32)
        return Places(self.slot, first, self.both, self.point[kept], self.normal[kept], self.plane[kept])


def face_normals(surfaces: Surfaces) -> NDArray[np.float64]:
    """(F, 3) unit normals, zero for triangles without area."""
    corners = surfaces.vertices[surfaces.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)


@njit(cache=True, error_model="numpy")
def _smooth(order, start, normals, weight, out):
    """Per corner (sorted in groups that share chart and place) the weighted normal of faces within the crease angle."""
    for g in range(len(start) - 1):
        for i in range(start[g], start[g + 1]):
            f = order[i] // 3
            x, y, z = 0.0, 0.0, 0.0
            for j in range(start[g], start[g + 1]):
                h = order[j] // 3
                a, b = normals[f], normals[h]
                if a[0] * b[0] + a[1] * b[1] + a[2] * b[2] >= _CREASE:
                    x += weight[h] * b[0]
                    y += weight[h] * b[1]
                    z += weight[h] * b[2]
            length = np.sqrt(x * x + y * y + z * z)
            if length > 0:
                out[f, order[i] % 3, 0] = x / length
                out[f, order[i] % 3, 1] = y / length
                out[f, order[i] % 3, 2] = z / length


def _corner_normals(surfaces: Surfaces, normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F, 3, 3): round bodies of flat triangles are shaded round, edges stay sharp."""
    corners = surfaces.vertices[surfaces.faces]
    key = np.column_stack(
        [np.repeat(surfaces.chart, 3), np.round(corners.reshape(-1, 3) * 1e5).astype(np.int64)]
    )
    group = np.unique(key, axis=0, return_inverse=True)[1].reshape(-1)
    order = np.argsort(group, kind="stable")
    start = np.r_[0, np.cumsum(np.bincount(group))]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    out = np.repeat(normals[:, None], 3, axis=1)
    _smooth(order, start, normals, np.sqrt(area), out)
    return out


@njit(cache=True, error_model="numpy")
def _paint(place, chart, corner, size, grid):
    """The face at the middle of every fine cell, grid (H·FINE, W·FINE); the first of overlapping faces stays."""
    for f in range(len(place)):
        c = chart[f]
        if c < 0:
            continue
        a, b, d = place[f, 0] * FINE, place[f, 1] * FINE, place[f, 2] * FINE
        area = (b[0] - a[0]) * (d[1] - a[1]) - (b[1] - a[1]) * (d[0] - a[0])
        if abs(area) < 1e-12:
            continue
        x0 = max(int(np.floor(min(a[0], b[0], d[0]) - 0.5)), corner[c, 0] * FINE)
        x1 = min(int(np.ceil(max(a[0], b[0], d[0]))), (corner[c, 0] + size[c, 0]) * FINE - 1)
        y0 = max(int(np.floor(min(a[1], b[1], d[1]) - 0.5)), corner[c, 1] * FINE)
        y1 = min(int(np.ceil(max(a[1], b[1], d[1]))), (corner[c, 1] + size[c, 1]) * FINE - 1)
        for y in range(y0, y1 + 1):
            for x in range(x0, x1 + 1):
                px, py = x + 0.5, y + 0.5
                u = ((b[0] - px) * (d[1] - py) - (b[1] - py) * (d[0] - px)) / area
                v = ((d[0] - px) * (a[1] - py) - (d[1] - py) * (a[0] - px)) / area
                if u >= -1e-9 and v >= -1e-9 and u + v <= 1 + 1e-9 and grid[y, x] < 0:
                    grid[y, x] = f


def _rescue(surfaces: Surfaces, atlas: Atlas, grid: Ints) -> None:
    """Charts so thin that no fine cell's middle lies in them get one point of their largest face."""
    seen = np.zeros(len(surfaces.density), bool)
    seen[surfaces.chart[grid[grid >= 0]]] = True
    if seen.all():
        return
    corners = surfaces.vertices[surfaces.faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    for f in np.argsort(area):  # the largest last: it is the one that stays
        chart = surfaces.chart[f]
        if chart >= 0 and not seen[chart] and area[f] > 0:
            x, y = (atlas.place[f].mean(0) * FINE).astype(int)
            grid[y, x] = f


def _z_order(x: NDArray[np.int64], y: NDArray[np.int64]) -> NDArray[np.int64]:
    """Bits of x and y interleaved."""
    value = np.zeros_like(x)
    for bit in range(13):
        value |= ((x >> bit) & 1) << (2 * bit) | ((y >> bit) & 1) << (2 * bit + 1)
    return value


def _flat_map(
    place: NDArray[np.float64], values: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Per face the corner values (F, 3, K) as a linear function of the place: base (F, K), slopes (F, 2, K)."""
    edge = place[:, 1:] - place[:, :1]
    det = edge[:, 0, 0] * edge[:, 1, 1] - edge[:, 0, 1] * edge[:, 1, 0]
    safe = np.where(np.abs(det) < 1e-12, np.inf, det)
    inverse = np.stack([edge[:, 1, 1], -edge[:, 0, 1], -edge[:, 1, 0], edge[:, 0, 0]], -1) / safe[:, None]
    slopes = inverse.reshape(-1, 2, 2) @ (values[:, 1:] - values[:, :1])
    return values[:, 0] - (place[:, 0, None] @ slopes)[:, 0], slopes


def places_of(surfaces: Surfaces, atlas: Atlas) -> Places:
    """Where light is gathered: texels in order of charts, within a chart along a Z-curve; then bare faces' sides."""
    grid = np.full((atlas.height * FINE, atlas.width * FINE), -1, np.int32)
    _paint(atlas.place, surfaces.chart, atlas.corner, atlas.size, grid)
    _rescue(surfaces, atlas, grid)
    normals = face_normals(surfaces)
    shaded = _corner_normals(surfaces, normals)
    y, x = np.nonzero(grid >= 0)
    face = grid[y, x]
    row, column = y // FINE, x // FINE
    chart = surfaces.chart[face]
    local = _z_order(column - atlas.corner[chart, 0], row - atlas.corner[chart, 1])
    order = np.lexsort((x, y, local, chart))
    y, x, face, chart = y[order], x[order], face[order], chart[order]
    slot = (y // FINE) * atlas.width + x // FINE
    spot = (np.column_stack([x, y]) + 0.5) / FINE
    values = np.concatenate([surfaces.vertices[surfaces.faces], shaded], axis=2)
    base, slopes = _flat_map(atlas.place, values)
    found = base[face] + spot[:, :1] * slopes[face, 0] + spot[:, 1:] * slopes[face, 1]
    new = np.diff(slot, prepend=-1) != 0
    first = np.flatnonzero(new)
    bare = _bare(surfaces, normals)
    normal = found[:, 3:] / np.maximum(np.linalg.norm(found[:, 3:], axis=1, keepdims=True), 1e-12)
    start = np.r_[first, len(face) + np.arange(0, len(bare[0]) + 1, FINE * FINE)].astype(np.int64)
    count = (len(start) - 1) - len(first)
    single = np.float32
    return Places(
        slot=np.r_[slot[first], atlas.width * atlas.height + np.arange(count)].astype(np.int32),
        first=start.astype(np.int32),
        both=np.r_[surfaces.two_sided[chart[first]], np.zeros(count, bool)],
        point=np.r_[found[:, :3] + _LIFT * normals[face], bare[0]].astype(single),
        normal=np.r_[normal, bare[1]].astype(single),
        plane=np.r_[normals[face], bare[1]].astype(single),
    )


def _bare(
    surfaces: Surfaces, normals: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points and normals on faces without chart: nine on the front, nine on the back, face by face."""
    faces = np.flatnonzero(surfaces.chart < 0)
    step = (np.arange(FINE) + 0.5) / FINE
    root = np.sqrt(np.repeat(step, FINE))
    other = np.tile(step, FINE)
    weight = np.column_stack([1 - root, root * (1 - other), root * other])
    points = np.einsum("kc,fcd->fkd", weight, surfaces.vertices[surfaces.faces[faces]])
    shape = (len(faces), 2, FINE * FINE, 3)
    out = np.broadcast_to(normals[faces][:, None, None], shape) * np.array([1.0, -1.0])[:, None, None]
    lifted = np.broadcast_to(points[:, None], shape) + _LIFT * out
    return lifted.reshape(-1, 3), out.reshape(-1, 3)
