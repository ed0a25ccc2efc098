"""Direct light of spots: rays to points on each spot's small disc."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hall_app.light.atlas.texels import Places
from hall_app.light.lamps import SpotRows
from hall_app.light.rays.embree import Tree
from hall_app.light.rays.sampling import A1, A2, PI, SCALE, SHIFT, frame, in_threads, seeds_of
from hall_app.light.rays.sights import room_for_sights, see

__all__ = ["gather_spots"]

_FEWEST = 4  # rays to a spot from a place of fewer points


@njit(cache=True, error_model="numpy", nogil=True)
def _aim(spots, first, both, point, normal, plane, start, stop, seed, sights):
    """Lines from places start … stop to the spots that shine on them, rows counted from `start`; returns how many."""
    a = 0
    for i in range(start, stop):
        points = first[i + 1] - first[i]
        for k in range(len(spots.inner)):
            drawn = max(points, _FEWEST) if points else 0
            for j in range(drawn):
                s = first[i] + j % points
                index = (np.uint64(i) * np.uint64(16) + np.uint64(j)) * np.uint64(64) + np.uint64(k)
                u1 = np.float32((seed[0] + index * A1) >> SHIFT) * SCALE
                u2 = np.float32((seed[1] + index * A2) >> SHIFT) * SCALE
                radius, angle = spots.radius[k] * np.sqrt(u1), np.float32(2.0) * PI * u2
                e, f = radius * np.cos(angle), radius * np.sin(angle)
                ax, ay, az, bx, by, bz = frame(spots.axis[k])
                x = spots.place[k, 0] + e * ax + f * bx - point[s, 0]
                y = spots.place[k, 1] + e * ay + f * by - point[s, 1]
                z = spots.place[k, 2] + e * az + f * bz - point[s, 2]
                square = max(x * x + y * y + z * z, np.float32(1e-8))
                far = np.sqrt(square)
                x, y, z = x / far, y / far, z / far
                cosine = -(x * spots.axis[k, 0] + y * spots.axis[k, 1] + z * spots.axis[k, 2])
                if cosine <= spots.outer[k]:
                    continue
                fade = min(np.float32(1.0), (cosine - spots.outer[k]) / (spots.inner[k] - spots.outer[k]))
                fade = fade * fade * (np.float32(3.0) - np.float32(2.0) * fade)
                here = normal[s, 0] * x + normal[s, 1] * y + normal[s, 2] * z
                true = plane[s, 0] * x + plane[s, 1] * y + plane[s, 2] * z
                lift = np.float32(0.0)
                if both[i]:
                    lift = np.float32(0.0) if true > 0 else np.float32(-4e-4)
                    here = abs(here) * np.float32(0.5)
                elif true <= 0:
                    continue
                if here <= 0:
                    continue
                sights.limit[a], sights.row[a] = far, i - start
                sights.way[a, 0], sights.way[a, 1], sights.way[a, 2] = x, y, z
                for c in range(3):
                    sights.origin[a, c] = point[s, c] + lift * plane[s, c]
                    sights.light[a, c] = spots.light[k, c] * fade * here / (square * drawn)
                a += 1
    return a


def gather_spots(tree: Tree, spots: SpotRows, places: Places, *, seed: int) -> NDArray[np.float32]:
    """Direct light of the spots (N, 3): one ray for every point of a place, four at least."""
    out = np.zeros((len(places.slot), 3), np.float32)
    seeds = seeds_of(seed, 1_000_003)
    if not len(spots.inner) or not len(out):
        return out
    rays = len(spots.inner) * int(np.maximum(np.diff(places.first), _FEWEST).max())

    def work(start: int, stop: int) -> None:
        sights = room_for_sights((stop - start) * rays)
        count = _aim(
            spots, places.first, places.both, places.point, places.normal, places.plane, start, stop, seeds, sights
        )  # fmt: skip
        see(tree, sights, count, out[start:stop])

    in_threads(len(out), rays, work)
    return out
