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
from hall_app.light.rays.embree import Tree, cast
from hall_app.light.rays.sampling import A1, A2, B1, B2, B3, PI, SCALE, SHIFT, frame, in_threads, seeds_of
from hall_app.light.rays.sights import room_for_sights, see

__all__ = ["Scene", "gather"]


class Scene(NamedTuple):
    """What rays meet: per face albedo (F, 3), emission (F, 3), and where its light is kept.

    place: (F, 3, 2) [texel] in a picture `width` wide, low, high: (F, 2) first and last texel of its chart;
    bare: (F,) slot of a face without chart, −1: it has one; sheet: (F,) seen from both sides.
    """

    albedo: NDArray[np.float32]
    emission: NDArray[np.float32]
    place: NDArray[np.float32]
    low: NDArray[np.int32]
    high: NDArray[np.int32]
    bare: NDArray[np.int32]
    sheet: NDArray[np.bool_]
    width: int


class _Rays(NamedTuple):
    """Room for R rays: origin (R, 3) [m], unit way (R, 3), the point (R,) they start at; row (R,): 2 · place + half,
    the place counted from the first of the chunk; odds (R,): how likely that way is drawn there [1/sr]."""

    origin: NDArray[np.float32]
    way: NDArray[np.float32]
    point: NDArray[np.int32]
    row: NDArray[np.int32]
    odds: NDArray[np.float32]


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
def _aim(lamps, emission, p, n, g, both, chance, r, count, drawn, sights, a):
    """Line `a` to one point on a lamp, with the light it brings; False: none, the point shines elsewhere.

    r: random numbers; count, drawn: rays and lamp points of the place.
    """
    pick, k = r[0], 0
    while k < len(chance) - 1 and pick >= chance[k]:
        pick -= chance[k]
        k += 1
    if chance[k] <= 0:
        return False
    pick = min(pick / chance[k], np.float32(0.999999))
    b, e = lamps.first[k], lamps.first[k + 1] - 1
    while b < e:
        middle = (b + e) // 2
        if lamps.share[middle] > pick:
            e = middle
        else:
            b = middle + 1
    face = lamps.face[b]
    root = np.sqrt(r[1])
    u, v = root * (np.float32(1.0) - r[2]), root * r[2]
    w = np.float32(1.0) - root
    q = lamps.corners[b]
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
        return False
    lift = np.float32(0.0)
    if both:
        here *= np.float32(0.5) if here > 0 else np.float32(-0.5)
        lift = np.float32(0.0) if true > 0 else np.float32(-4e-4)
    elif true <= 0:
        return False
    if here <= 0:
        return False
    toward = here / PI
    chosen = chance[k] / lamps.area[k] * square / there
    weight = toward / (count * toward + drawn * chosen)
    sights.limit[a] = far - max(np.float32(1e-3), np.float32(1e-4) * far)
    sights.way[a, 0], sights.way[a, 1], sights.way[a, 2] = x, y, z
    for c in range(3):
        sights.origin[a, c] = p[c] + lift * g[c]
        sights.light[a, c] = emission[face, c] * weight
    return True


@njit(cache=True, error_model="numpy", nogil=True)
def _send(
    lamps, emission, first, both, point, normal, plane, start, stop, count, drawn, seed,
    chance, many, rays, sights,
):  # fmt: skip
    """Rays and lines to lamps of the places start … stop; returns how many of each.

    chance (P, K), many (P,): how likely each lamp is drawn at a place, and how often one is.
    """
    r = np.zeros(3, np.float32)
    a, b = 0, 0
    for i in range(start, stop):
        points = first[i + 1] - first[i]
        if points == 0:
            continue
        sheet, odds = both[i], chance[i - start]
        middle = first[i] + points // 2
        if drawn > 0 and _chances(lamps, point[middle], normal[middle], sheet, odds):
            many[i - start] = drawn
        for k in range(count):
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
            rays.way[a, 0], rays.way[a, 1], rays.way[a, 2] = dx, dy, dz
            for c in range(3):
                rays.origin[a, c] = p[c] + lift * g[c]
            rays.point[a], rays.row[a] = s, 2 * (i - start) + (0 if 2 * k < count else 1)
            rays.odds[a] = abs(z) / PI * (np.float32(0.5) if sheet else np.float32(1.0))
            a += 1
        for k in range(many[i - start]):
            s = first[i] + k % points
            index = np.uint64(i) * np.uint64(drawn) + np.uint64(k)
            r[0] = np.float32((seed[2] + index * B1) >> SHIFT) * SCALE
            r[1] = np.float32((seed[3] + index * B2) >> SHIFT) * SCALE
            r[2] = np.float32((seed[4] + index * B3) >> SHIFT) * SCALE
            if _aim(
                lamps, emission, point[s], normal[s], plane[s], sheet, odds, r, count, drawn, sights, b
            ):  # fmt: skip
                sights.row[b] = 2 * (i - start) + (0 if 2 * k < drawn else 1)
                b += 1
    return a, b


@njit(cache=True, error_model="numpy", nogil=True)
def _shade(
    scene, lamps, light, way, point, row, odds, face, distance, u, v, chance, many, count,
    bounced, valid, lit, backs, tally,
):  # fmt: skip
    """What rays bring to the rows of bounced (2 P, 3), of lit (2 P, 3) where they end on a lamp, and valid (2 P,)."""
    for a in range(len(face)):
        k, f = row[a], face[a]
        tally[0] += 1
        if f < 0:
            tally[1] += 1
            valid[k] += 1
            continue
        m = lamps.normal[f]
        cosine = -(m[0] * way[a, 0] + m[1] * way[a, 1] + m[2] * way[a, 2])
        if cosine <= 0 and not scene.sheet[f]:
            backs[point[a]] += 1
            tally[2] += 1
            continue
        valid[k] += 1
        kept = _slot(scene, f, u[a], v[a], cosine > 0)
        for c in range(3):
            bounced[k, c] += scene.albedo[f, c] * light[kept, c]
        lamp = lamps.lamp[f]
        if lamp >= 0 and cosine > 0:
            weight = np.float32(1.0) / count
            drawn = many[k // 2]
            if drawn:
                chosen = chance[k // 2, lamp] / lamps.area[lamp] * distance[a] * distance[a]
                chosen /= max(cosine, np.float32(1e-5))
                weight = odds[a] / (count * odds[a] + drawn * chosen)
            for c in range(3):
                lit[k, c] += scene.emission[f, c] * weight


def gather(
    tree: Tree,
    scene: Scene,
    lamps: Lamps,
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
        size = stop - start
        sent, sights = _room_for_rays(size * rays), room_for_sights(size * drawn)
        chance, many = np.zeros((size, len(lamps.area)), np.float32), np.zeros(size, np.int32)
        rays_sent, lines = _send(
            lamps, scene.emission, places.first, places.both, places.point, places.normal,
            places.plane, start, stop, rays, drawn, seeds, chance, many, sent, sights,
        )  # fmt: skip
        sent = _Rays._make(array[:rays_sent] for array in sent)
        bounced, lit = np.zeros((2 * size, 3), np.float32), np.zeros((2 * size, 3), np.float32)
        valid, tally = np.zeros(2 * size, np.float32), np.zeros(4, np.int64)
        face, distance, u, v = cast(tree, sent.origin, sent.way)
        _shade(
            scene, lamps, light, sent.way, sent.point, sent.row, sent.odds, face, distance, u, v, chance, many,
            rays, bounced, valid, lit, backs, tally,
        )  # fmt: skip
        see(tree, sights, lines, lit)
        tally[3] = many.sum()
        out[start:stop] = _halves(bounced, valid, lit)
        tallies.append(tally)

    in_threads(count, rays + drawn, work, told)
    return out, backs, np.sum(tallies, axis=0) if tallies else np.zeros(4, np.int64)


def _room_for_rays(count: int) -> _Rays:
    origin, way = (np.zeros((count, 3), np.float32) for _ in range(2))
    point, row = (np.zeros(count, np.int32) for _ in range(2))
    return _Rays(origin, way, point, row, np.zeros(count, np.float32))


def _halves(
    bounced: NDArray[np.float32], valid: NDArray[np.float32], lit: NDArray[np.float32]
) -> NDArray[np.float32]:
    """(P, 2, 3) light of both halves of the rays; where one half has none that count, it takes the other's."""
    found = (2 * lit + bounced / np.maximum(valid, 1)[:, None]).astype(np.float32).reshape(-1, 2, 3)
    first, second = valid.reshape(-1, 2).T > 0
    found[~first, 0] = found[~first, 1]
    found[first & ~second, 1] = found[first & ~second, 0]
    return found
