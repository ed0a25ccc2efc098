"""Moving inner points: to the middle of their stars, or to where the smallest angle around them is largest.

Nothing here changes which points are joined; growth does that again after every pass.
"""

import numpy as np
from numba import njit

from sim_core.mesh.measures.triangles import triangle_areas

__all__ = ["centre", "open_angles", "sharp_angles", "sharpest_angle", "smoothed"]

TURNS = np.arange(8) * np.pi / 4
WAYS = np.column_stack([np.cos(TURNS), np.sin(TURNS)])  # directions a point is tried in


def smoothed(vertices: np.ndarray, faces: np.ndarray, fixed: int) -> np.ndarray:
    """New vertices (V, 2) [m]; the first `fixed` ones (the outline samples) stay where they are.

    Inner points move to the area-weighted mean of the centroids around them, all at once. Inside the regular lattice
    the mean is the point itself, so only the irregular band along the outline moves.
    """
    weight = triangle_areas(vertices, faces)
    middle = vertices[faces].mean(axis=1)
    corners = faces.ravel()
    total = np.bincount(corners, np.repeat(weight, 3), len(vertices))
    moved = vertices.copy()
    for axis in range(2):
        summed = np.bincount(corners, np.repeat(weight * middle[:, axis], 3), len(vertices))
        moved[fixed:, axis] = summed[fixed:] / total[fixed:]
    return moved


@njit(cache=True, error_model="numpy")
def centre(places, faces, start, items, free, weights, sweeps):
    """Move each free vertex to the weighted mean of the centroids of its triangles, one vertex after the other.

    places: (V, 2), y up, changed in place.  faces: (F, 3).  start, items: `stars`.  free: (m,) vertices that may move.
    weights: (V,) density per area at each vertex (1 for a mesh of one edge length).
    """
    for _ in range(sweeps):
        for m in range(free.shape[0]):
            v = free[m]
            x, y = places[v, 0], places[v, 1]
            sum_x, sum_y, total = 0.0, 0.0, 0.0
            for k in range(start[v], start[v + 1]):
                f, corner = items[k] // 3, items[k] % 3
                b, c = faces[f, (corner + 1) % 3], faces[f, (corner + 2) % 3]
                ux, uy, wx, wy = places[b, 0] - x, places[b, 1] - y, places[c, 0] - x, places[c, 1] - y
                weight = (ux * wy - uy * wx) * (weights[v] + weights[b] + weights[c])
                sum_x += weight * (ux + wx)
                sum_y += weight * (uy + wy)
                total += weight
            if total > 0.0:
                places[v, 0], places[v, 1] = x + sum_x / (3 * total), y + sum_y / (3 * total)


@njit(cache=True, error_model="numpy")
def _sharpest(places, faces, start, items, v, x, y):
    """Cosine of the smallest angle of the triangles around v if it lay at x, y; 2 where one is turned over."""
    worst = -1.0
    for k in range(start[v], start[v + 1]):
        f, corner = items[k] // 3, items[k] % 3
        b, c = faces[f, (corner + 1) % 3], faces[f, (corner + 2) % 3]
        ux, uy, wx, wy = places[b, 0] - x, places[b, 1] - y, places[c, 0] - x, places[c, 1] - y
        if ux * wy - uy * wx <= 0.0:
            return 2.0
        u, w, t = ux * ux + uy * uy, wx * wx + wy * wy, (wx - ux) ** 2 + (wy - uy) ** 2
        least = min(u, min(w, t))
        # The smallest angle lies opposite the shortest side.
        product = u * w if least == t else (t * w if least == u else t * u)
        worst = max(worst, (u + w + t - 2 * least) / (2 * np.sqrt(product)))
    return worst


@njit(cache=True, error_model="numpy")
def open_angles(places, faces, start, items, free, cosine, sweeps):
    """Move free vertices next to an angle of larger cosine than `cosine` to where their smallest angle is largest.

    A search in eight directions with steps halved from a tenth of the star's width. Arrays as in `centre`. Returns
    how many vertices moved.
    """
    moved = 0
    for _ in range(sweeps):
        before = moved
        for m in range(free.shape[0]):
            v = free[m]
            worst = _sharpest(places, faces, start, items, v, places[v, 0], places[v, 1])
            if worst <= cosine:
                continue
            first = faces[items[start[v]] // 3, (items[start[v]] % 3 + 1) % 3]
            step = 0.1 * np.hypot(places[first, 0] - places[v, 0], places[first, 1] - places[v, 1])
            found = False
            for _try in range(6):
                best_x, best_y, best = places[v, 0], places[v, 1], worst
                for way in range(8):
                    x, y = places[v, 0] + step * WAYS[way, 0], places[v, 1] + step * WAYS[way, 1]
                    trial = _sharpest(places, faces, start, items, v, x, y)
                    if trial < best:
                        best_x, best_y, best = x, y, trial
                if best < worst:
                    places[v, 0], places[v, 1], worst, found = best_x, best_y, best, True
                else:
                    step *= 0.5
            moved += found
        if moved == before:
            break
    return moved


@njit(cache=True, error_model="numpy")
def sharpest_angle(places, faces):
    """Cosine of the smallest angle of a mesh with y up; 2 where a triangle is turned over."""
    worst = -1.0
    for f in range(faces.shape[0]):
        worst = max(worst, _sharpest_of(places, faces, f))
    return worst


@njit(cache=True, error_model="numpy")
def sharp_angles(places, faces, free, cosine):
    """How many triangles with a vertex that may move have an angle of larger cosine than `cosine`, and the cosine of
    their smallest angle: (count, cosine), the latter 2 where a triangle is turned over. free: (V,) bool, may move."""
    worst, count = -1.0, 0
    for f in range(faces.shape[0]):
        angle = _sharpest_of(places, faces, f)
        if angle > 1.0 or free[faces[f, 0]] or free[faces[f, 1]] or free[faces[f, 2]]:
            worst = max(worst, angle)
            count += angle > cosine
    return count, worst


@njit(cache=True, error_model="numpy")
def _sharpest_of(places, faces, f):
    """Cosine of the smallest angle of triangle f; 2 where it is turned over."""
    a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
    ux, uy = places[b, 0] - places[a, 0], places[b, 1] - places[a, 1]
    wx, wy = places[c, 0] - places[a, 0], places[c, 1] - places[a, 1]
    if ux * wy - uy * wx <= 0.0:
        return 2.0
    u, w, t = ux * ux + uy * uy, wx * wx + wy * wy, (wx - ux) ** 2 + (wy - uy) ** 2
    least = min(u, min(w, t))
    product = u * w if least == t else (t * w if least == u else t * u)
    return (u + w + t - 2 * least) / (2 * np.sqrt(product))
