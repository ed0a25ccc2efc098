"""Light gathered at places: cosine-distributed rays and points on lamps, weighed against each other.

A place's rays are a stretch of one low-discrepancy lattice (Kronecker sequence with the generalised golden ratio,
after M. Roberts 2018), and places follow each other along a Z-curve through each chart (A. Ahmed, P. Wonka 2020), so
that neighbours complement each other and what noise is left is fine-grained. Rays and lamp points are combined by
the balance heuristic (E. Veach, L. Guibas 1995).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hall_app.light.atlas.texels import Places
from hall_app.light.lamps import Lamps
from hall_app.light.model import Sampling
from hall_app.light.rays.bvh import Tree
from hall_app.light.rays.sampling import A1, A2, B1, B2, B3, PI, SCALE, SHIFT, frame, in_threads, seeds_of
from hall_app.light.rays.tracing import FAR, lanes, nearest, occluded, stack

__all__ = ["Scene", "gather"]


class Scene(NamedTuple):
    """What rays meet: the tree; per face albedo (F, 3), emission (F, 3), and where its light is kept.

    place: (F, 3, 2) [texel] in a picture `width` wide, low, high: (F, 2) first and last texel of its chart;
    bare: (F,) slot of a face without chart, −1: it has one; sheet: (F,) seen from both sides.
    """

    tree: Tree
    albedo: NDArray[np.float32]
    emission: NDArray[np.float32]
    place: NDArray[np.float32]
    low: NDArray[np.int32]
    high: NDArray[np.int32]
    bare: NDArray[np.int32]
    sheet: NDArray[np.bool_]
    width: int


@njit(cache=True, error_model="numpy", nogil=True)
def _slot(scene, face, u, v, front):
    """Where the light at a point of a face is kept."""
    if scene.bare[face] >= 0:
        return scene.bare[face] + (0 if front else 1)
    p = scene.place[face]
    w = np.float32(1.0) - u - v
    x = int(w * p[0, 0] + u * p[1, 0] + v * p[2, 0])
    y = int(w * p[0, 1] + u * p[1, 1] + v * p[2, 1])
    x = min(max(x, scene.low[face, 0]), scene.high[face, 0])
    y = min(max(y, scene.low[face, 1]), scene.high[face, 1])
    return y * scene.width + x


@njit(cache=True, error_model="numpy", nogil=True)
def _chances(lamps, p, n, both, chance):
    """How likely each lamp is drawn at p: its power by distance and angle, as far as spheres around lamps tell."""
    total = np.float32(0.0)
    for k in range(len(lamps.area)):
        x, y, z = lamps.middle[k, 0] - p[0], lamps.middle[k, 1] - p[1], lamps.middle[k, 2] - p[2]
        r = lamps.radius[k]
        square = x * x + y * y + z * z
        far = np.sqrt(max(square, np.float32(1e-8)))
        seen = np.float32(1.0)
        if not both:
            seen = min(np.float32(1.0), max(np.float32(0.0), (n[0] * x + n[1] * y + n[2] * z + r) / far))
        m = lamps.facing[k]
        if m[0] * m[0] + m[1] * m[1] + m[2] * m[2] > np.float32(0.5):
            seen *= min(np.float32(1.0), max(np.float32(0.0), (r - m[0] * x - m[1] * y - m[2] * z) / far))
        chance[k] = lamps.power[k] * seen / max(square, r * r)
        total += chance[k]
    for k in range(len(lamps.area)):
        chance[k] = chance[k] / total if total > 0 else np.float32(0.0)
    return total > 0


@njit(cache=True, error_model="numpy", nogil=True)
def _shine(tree, lamps, scene, corners, p, n, g, both, chance, r, count, drawn, opened, room, out):
    """Adds the light of one point on a lamp to out (3,); r: random numbers; count, drawn: rays, lamp points."""
    pick, k = r[0], 0
    while k < len(chance) - 1 and pick >= chance[k]:
        pick -= chance[k]
        k += 1
    if chance[k] <= 0:
        return
    pick = min(pick / chance[k], np.float32(0.999999))
    a, b = lamps.first[k], lamps.first[k + 1] - 1
    while a < b:
        middle = (a + b) // 2
        if lamps.share[middle] > pick:
            b = middle
        else:
            a = middle + 1
    face = lamps.face[a]
    root = np.sqrt(r[1])
    u, v = root * (np.float32(1.0) - r[2]), root * r[2]
    w = np.float32(1.0) - root
    q = corners[a]
    x = w * q[0, 0] + u * q[1, 0] + v * q[2, 0] - p[0]
    y = w * q[0, 1] + u * q[1, 1] + v * q[2, 1] - p[1]
    z = w * q[0, 2] + u * q[1, 2] + v * q[2, 2] - p[2]
    square = max(x * x + y * y + z * z, np.float32(1e-8))
    far = np.sqrt(square)
    x, y, z = x / far, y / far, z / far
    m = lamps.normal[face]
    there = -(m[0] * x + m[1] * y + m[2] * z)
    here = n[0] * x + n[1] * y + n[2] * z
    true = g[0] * x + g[1] * y + g[2] * z
    if there <= np.float32(1e-5):
        return
    if both:
        here *= np.float32(0.5) if here > 0 else np.float32(-0.5)
        lift = np.float32(0.0) if true > 0 else np.float32(-4e-4)
    else:
        lift = np.float32(0.0)
        if true <= 0:
            return
    if here <= 0:
        return
    toward = here / PI
    if occluded(
        tree, p[0] + lift * g[0], p[1] + lift * g[1], p[2] + lift * g[2], x, y, z,
        far - max(np.float32(1e-3), np.float32(1e-4) * far), opened, room,
    ):  # fmt: skip
        return
    chosen = chance[k] / lamps.area[k] * square / there
    weight = toward / (count * toward + drawn * chosen)
    for c in range(3):
        out[c] += scene.emission[face, c] * weight


@njit(cache=True, error_model="numpy", nogil=True)
def _gather(
    scene, lamps, corners, slot, first, both, point, normal, plane, start, stop, light, count, drawn, seed,
    opened, room, chance, out, backs, tally,
):  # fmt: skip
    """Places start … stop; see `gather`."""
    tree = scene.tree
    hit, r = np.zeros(3, np.float32), np.zeros(3, np.float32)
    lamp_light = np.zeros((2, 3), np.float32)
    bounced = np.zeros((2, 3), np.float32)
    valid = np.zeros(2, np.float32)
    for i in range(start, stop):
        points = first[i + 1] - first[i]
        if points == 0:
            continue
        lamp_light[:], bounced[:], valid[:] = 0.0, 0.0, 0.0
        sheet = both[i]
        middle = first[i] + points // 2
        lit = drawn > 0 and _chances(lamps, point[middle], normal[middle], sheet, chance)
        many = drawn if lit else 0
        for k in range(count):
            half = 0 if 2 * k < count else 1
            s = first[i] + ((k // 2) % points if sheet else k % points)
            p, n, g = point[s], normal[s], plane[s]
            index = np.uint64(i) * np.uint64(count) + np.uint64(k)
            u1 = np.float32((seed[0] + index * A1) >> SHIFT) * SCALE
            u2 = np.float32((seed[1] + index * A2) >> SHIFT) * SCALE
            radius, angle = np.sqrt(u1), np.float32(2.0) * PI * u2
            x, y = radius * np.cos(angle), radius * np.sin(angle)
            z = np.sqrt(max(np.float32(0.0), np.float32(1.0) - u1))
            lift = np.float32(0.0)
            if sheet and k % 2 == 1:
                z, lift = -z, np.float32(-4e-4)
            ax, ay, az, bx, by, bz = frame(n)
            dx, dy, dz = x * ax + y * bx + z * n[0], x * ay + y * by + z * n[1], x * az + y * bz + z * n[2]
            true = dx * g[0] + dy * g[1] + dz * g[2]
            if (true <= 0) != (lift < 0):
                continue
            ox, oy, oz = p[0] + lift * g[0], p[1] + lift * g[1], p[2] + lift * g[2]
            face = nearest(tree, ox, oy, oz, dx, dy, dz, FAR, opened, room, hit)
            tally[0] += 1
            if face < 0:
                tally[1] += 1
                valid[half] += 1
                continue
            m = lamps.normal[face]
            cosine = -(m[0] * dx + m[1] * dy + m[2] * dz)
            if cosine <= 0 and not scene.sheet[face]:
                backs[s] += 1
                tally[2] += 1
                continue
            valid[half] += 1
            kept = _slot(scene, face, hit[1], hit[2], cosine > 0)
            for c in range(3):
                bounced[half, c] += scene.albedo[face, c] * light[kept, c]
            lamp = lamps.lamp[face]
            if lamp >= 0 and cosine > 0:
                weight = np.float32(1.0) / count
                if many:
                    toward = abs(z) / PI * (np.float32(0.5) if sheet else np.float32(1.0))
                    chosen = chance[lamp] / lamps.area[lamp] * hit[0] * hit[0] / max(cosine, np.float32(1e-5))
                    weight = toward / (count * toward + many * chosen)
                for c in range(3):
                    lamp_light[half, c] += scene.emission[face, c] * weight
        for k in range(many):
            half = 0 if 2 * k < many else 1
            s = first[i] + k % points
            index = np.uint64(i) * np.uint64(drawn) + np.uint64(k)
            r[0] = np.float32((seed[2] + index * B1) >> SHIFT) * SCALE
            r[1] = np.float32((seed[3] + index * B2) >> SHIFT) * SCALE
            r[2] = np.float32((seed[4] + index * B3) >> SHIFT) * SCALE
            _shine(
                tree, lamps, scene, corners, point[s], normal[s], plane[s], sheet, chance, r, count, many,
                opened, room, lamp_light[half],
            )  # fmt: skip
        tally[3] += many
        for half in range(2):
            for c in range(3):
                mean = bounced[half, c] / valid[half] if valid[half] > 0 else np.float32(0.0)
                out[i, half, c] = np.float32(2.0) * lamp_light[half, c] + mean
        if valid[0] == 0 or valid[1] == 0:
            full = 0 if valid[0] > 0 else 1
            for c in range(3):
                out[i, 1 - full, c] = out[i, full, c]


def gather(
    scene: Scene,
    lamps: Lamps,
    lamp_corners: NDArray[np.float32],
    places: Places,
    light: NDArray[np.float32],
    sampling: Sampling,
    *,
    step: int = 0,
    told: Callable[[float], None] | None = None,
) -> tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.int64]]:
    """Light at every place from lamps, and from `light` (slots, 3) once more reflected where rays end.

    step: number of the pass. Returns light (N, 2, 3) of two independent halves, per point (M,) how many rays met the
    inside of a body, and the tally: rays, missed, inside, lamp points.
    """
    count, rays = len(places.slot), sampling.rays[step]
    drawn = round(sampling.lamp_share * rays) if len(lamps.area) else 0
    out = np.zeros((count, 2, 3), np.float32)
    backs = np.zeros(len(places.point), np.int32)
    tallies: list[NDArray[np.int64]] = []
    seeds = seeds_of(sampling.seed, step)

    def work(start: int, stop: int) -> None:
        tally = np.zeros(4, np.int64)
        chance = np.zeros(len(lamps.area), np.float32)
        _gather(
            scene, lamps, lamp_corners, places.slot, places.first, places.both, places.point, places.normal,
            places.plane, start, stop, light, rays, drawn, seeds, stack(scene.tree), lanes(), chance, out, backs,
            tally,
        )  # fmt: skip
        tallies.append(tally)

    in_threads(count, work, told)
    return out, backs, np.sum(tallies, axis=0) if tallies else np.zeros(4, np.int64)
