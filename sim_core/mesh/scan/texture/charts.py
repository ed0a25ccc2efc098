"""A mesh laid out flat: charts of faces that look much the same way, each seen from its own side, in a square."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

__all__ = ["Layout", "laid_out"]

CONE = 0.5  # cosine between a face and its chart's direction, while the chart grows
FOLDED = 0.1  # the same once the direction is known; what is less begins a chart of its own
GUTTER = 2  # [pixels] round each chart, and between it and the next
FEWEST = 40  # charts: pieces of no odd shape, which leave less of the square empty
FILL = 0.7  # of the square, hoped for; less where boxes do not fit
ROUNDS = 6  # after which what still lies over something else is laid out face by face


@dataclass(frozen=True)
class Layout:
    """place: (F, 3, 2) of each face's corners in the square [pixels]; chart: (F,) int32; size [pixels] of the square;
    owner: (size, size) int32 the face that each pixel's middle lies in, -1 where there is none."""

    place: np.ndarray
    chart: np.ndarray
    size: int
    owner: np.ndarray


def laid_out(vertices: np.ndarray, faces: np.ndarray, size: int) -> Layout:
    """Every face of a mesh, vertices (V, 3) [m] and faces (F, 3), in a square of `size` pixels, none over another."""
    normal, area = _normals(vertices, faces)
    beside = _neighbours(faces)
    chart = np.full(len(faces), -1, np.int32)
    charts = 0
    for turn in range(ROUNDS + 1):
        if turn < ROUNDS:
            while (chart < 0).any():
                charts = grown(normal, area, beside, chart, charts, area.sum() / FEWEST)
        else:
            alone = np.flatnonzero(chart < 0)
            chart[alone] = charts + np.arange(len(alone))
            charts += len(alone)
        place = _packed(_flat(vertices, faces, normal * area[:, None], chart, charts), chart, charts, size)
        owner = np.full((size, size), -1, np.int32)
        over = np.zeros(len(faces), np.bool_)
        drawn(place, owner, over)
        if not over.any() or turn == ROUNDS:
            return Layout(place, chart, size, owner)
        chart[over] = -1
    raise AssertionError("the last round returns")


def _normals(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    double = np.linalg.norm(across, axis=1)
    return across / np.maximum(double, 1e-300)[:, None], double / 2


def _neighbours(faces: np.ndarray) -> np.ndarray:
    """(F, 3) the face across each edge, -1 at open ones and where more than two meet."""
    count = int(faces.max()) + 1
    ends = np.sort(np.stack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]], axis=1), axis=2)
    key = (ends[..., 0].astype(np.int64) * count + ends[..., 1]).ravel()
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    start = np.flatnonzero(np.r_[True, ordered[1:] != ordered[:-1]])
    two = start[np.diff(np.r_[start, len(ordered)]) == 2]
    beside = np.full(len(key), -1, np.int64)
    first, second = order[two], order[two + 1]
    beside[first], beside[second] = second // 3, first // 3
    return beside.reshape(-1, 3)


@njit(cache=True, error_model="numpy")
def grown(normal, area, beside, chart, charts, most):
    """Gives every face whose chart is -1 one: it grows over neighbours while they look its way, up to an area of `most`
    [m2]. How many charts there are."""
    waits = np.zeros(len(chart), np.int64)
    for seed in range(len(chart)):
        if chart[seed] >= 0:
            continue
        chart[seed] = charts
        x, y, z = normal[seed, 0] * area[seed], normal[seed, 1] * area[seed], normal[seed, 2] * area[seed]
        waits[0], first, last = seed, 0, 1
        while first < last and x * x + y * y + z * z < most * most:
            f = waits[first]
            first += 1
            for k in range(3):
                g = beside[f, k]
                if g < 0 or chart[g] >= 0:
                    continue
                size = np.sqrt(x * x + y * y + z * z)
                if normal[g, 0] * x + normal[g, 1] * y + normal[g, 2] * z < CONE * size:
                    continue
                chart[g] = charts
                x, y, z = x + normal[g, 0] * area[g], y + normal[g, 1] * area[g], z + normal[g, 2] * area[g]
                waits[last] = g
                last += 1
        size = np.sqrt(x * x + y * y + z * z)
        for n in range(1, last):
            f = waits[n]
            if normal[f, 0] * x + normal[f, 1] * y + normal[f, 2] * z < FOLDED * size:
                chart[f] = -1  # the next turn takes it
        charts += 1
    return charts


def _flat(
    vertices: np.ndarray, faces: np.ndarray, upright: np.ndarray, chart: np.ndarray, charts: int
) -> np.ndarray:
    """(F, 3, 2) [m]: every chart seen from its own side, its longer way along the first axis."""
    axis = np.stack([np.bincount(chart, upright[:, k], charts) for k in range(3)], axis=1)
    axis /= np.maximum(np.linalg.norm(axis, axis=1), 1e-300)[:, None]
    aside = np.where(np.abs(axis[:, [0]]) < 0.8, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    u = np.cross(aside, axis)
    u /= np.maximum(np.linalg.norm(u, axis=1), 1e-300)[:, None]
    v = np.cross(axis, u)
    corners = vertices[faces]
    flat = np.stack(
        [np.einsum("fkd,fd->fk", corners, u[chart]), np.einsum("fkd,fd->fk", corners, v[chart])], axis=-1
    )
    middle = flat.mean(1)
    many = np.maximum(np.bincount(chart, minlength=charts), 1)
    mean = np.stack([np.bincount(chart, middle[:, k], charts) for k in (0, 1)], axis=1) / many[:, None]
    away = middle - mean[chart]
    xx, xy, yy = (np.bincount(chart, away[:, i] * away[:, j], charts) for i, j in ((0, 0), (0, 1), (1, 1)))
    angle = 0.5 * np.arctan2(2 * xy, xx - yy)[chart][:, None]
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack(
        [cosine * flat[..., 0] + sine * flat[..., 1], cosine * flat[..., 1] - sine * flat[..., 0]], axis=-1
    )


def _packed(flat: np.ndarray, chart: np.ndarray, charts: int, size: int) -> np.ndarray:
    """(F, 3, 2) [pixels]: the charts side by side on shelves of falling height, as large as the square allows."""
    low, high = np.full((charts, 2), np.inf), np.full((charts, 2), -np.inf)
    np.minimum.at(low, chart, flat.min(1))
    np.maximum.at(high, chart, flat.max(1))
    used = np.isfinite(low[:, 0])
    low[~used], high[~used] = 0.0, 0.0
    extent = high - low
    density = size * np.sqrt(FILL / max(float(extent.prod(1).sum()), 1e-300))
    while True:
        boxes = np.ceil(extent * density).astype(np.int64) + 2 * GUTTER
        boxes[~used] = 0
        corner, height = _shelves(boxes, size)
        if height <= size and boxes[:, 0].max() <= size:
            break
        density *= 0.97
    return (flat - low[chart][:, None]) * density + (corner[chart] + GUTTER)[:, None]


def _shelves(boxes: np.ndarray, width: int) -> tuple[np.ndarray, int]:
    """Corners (N, 2) of boxes (N, 2) in a strip of that width, and its height."""
    corner = np.zeros((len(boxes), 2), np.int64)
    x = y = shelf = 0
    for number in np.lexsort((-boxes[:, 0], -boxes[:, 1])).tolist():
        wide, high = int(boxes[number, 0]), int(boxes[number, 1])
        if x + wide > width:
            x, y, shelf = 0, y + shelf, 0
        corner[number] = x, y
        x, shelf = x + wide, max(shelf, high)
    return corner, y + shelf


@njit(cache=True, error_model="numpy")
def drawn(place, owner, over):
    """Writes each face into the pixels whose middles lie in it; `over`: faces that meet pixels of others."""
    high, wide = owner.shape
    for f in range(len(place)):
        ax, ay, bx, by, cx, cy = (
            place[f, 0, 0], place[f, 0, 1], place[f, 1, 0], place[f, 1, 1], place[f, 2, 0], place[f, 2, 1],
        )  # fmt: skip
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if area == 0.0:
            continue
        left, right = int(max(min(ax, bx, cx) - 0.5, 0.0)), int(min(max(ax, bx, cx) + 0.5, wide - 1.0))
        top, bottom = int(max(min(ay, by, cy) - 0.5, 0.0)), int(min(max(ay, by, cy) + 0.5, high - 1.0))
        for y in range(top, bottom + 1):
            for x in range(left, right + 1):
                px, py = x + 0.5, y + 0.5
                s = ((px - ax) * (cy - ay) - (cx - ax) * (py - ay)) / area
                t = ((bx - ax) * (py - ay) - (px - ax) * (by - ay)) / area
                if s < 0.0 or t < 0.0 or s + t > 1.0:
                    continue
                if owner[y, x] < 0:
                    owner[y, x] = f
                elif min(s, t, 1.0 - s - t) > 1e-6:
                    over[f] = True
