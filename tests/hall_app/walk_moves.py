"""Shared by tests and bench: floors full of obstacles, an exact test without FCL, and random walks."""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np
import shapely
from shapely import affinity

from hall_app.walk import BODY, Floor, Keys, Pose, Prism, Round, bake, step, wall

CHUNK = 20_000  # poses per exact test
KEYS = [Keys(f, r) for f in (-1, 0, 1) for r in (-1, 0, 1) if f or r]

# Everything the page must manage on one small floor: a thin wall, convex corners, a round stand, a concave L.
FLOOR = Floor(
    ((0, 0), (12, 0), (12, 8), (0, 8)),
    (
        wall((2, 1), (2, 4), 0.05),
        Prism(((5, 2), (7, 2.5), (6.6, 4.1), (4.6, 3.6))),
        Round(9.5, 3, 0.45),
        Prism(((1, 6), (4, 6), (4, 6.4), (1.4, 6.4), (1.4, 7.2), (1, 7.2))),
    ),
)


def dense_floor(rng: np.random.Generator, *, solids: int = 120) -> Floor:
    """24 x 16 m with a notch, full of turned boxes, 5 cm walls, rounds, Ls, slivers and gaps just too narrow."""
    outline = ((0, 0), (24, 0), (24, 16), (14, 16), (14, 14.5), (11, 14.5), (11, 16), (0, 16))
    made: list[Any] = []
    # Gaps of 0.58 to 0.66 m between thin walls: some too narrow for the body, some just passable.
    for k, gap in enumerate((0.58, 0.60, 0.61, 0.62, 0.63, 0.66)):
        made += [
            wall((2 + 3 * k, 1), (2 + 3 * k, 3), 0.05),
            wall((2 + 3 * k, 3 + gap), (2 + 3 * k, 5.5), 0.05),
        ]
    shape_l = shapely.Polygon([(0, 0), (1.5, 0), (1.5, 0.3), (0.3, 0.3), (0.3, 1.2), (0, 1.2)])
    sliver = shapely.Polygon([(0, 0), (2.5, 0.1), (0.2, 0.6)])
    while len(made) < solids:
        x, z, turn = rng.uniform(0.5, 23.5), rng.uniform(6, 15.5), rng.uniform(0, 360)
        kind = rng.integers(5)
        if kind == 0:
            made.append(Round(x, z, float(rng.uniform(0.05, 0.6))))
        elif kind == 1:
            end = (x + 2 * math.cos(turn), z + 2 * math.sin(turn))
            made.append(wall((x, z), end, 0.05))
        else:
            size = rng.uniform(0.1, 1.2, 2)
            base = (shapely.box(0, 0, *size), shape_l, sliver)[kind - 2]
            placed = affinity.translate(affinity.rotate(base, turn, origin=(0, 0)), x, z)
            made.append(Prism(tuple(placed.exterior.coords)))
    return Floor(outline, tuple(made))


def room(places: np.ndarray, floor: Floor) -> np.ndarray:
    """(N,) [m] distance of the body's circle to the nearest solid or outline, < 0 inside; without FCL, float64."""
    places = np.asarray(places, dtype=float).reshape(-1, 2)
    points = shapely.points(places)
    edge = shapely.distance(floor.shape.exterior, points)
    least = np.where(shapely.contains(floor.shape, points), edge, -edge)
    for solid in floor.solids:
        if isinstance(solid, Round):
            apart = np.hypot(places[:, 0] - solid.x, places[:, 1] - solid.z) - solid.radius
        else:
            apart = shapely.distance(solid.shape, points)
        least = np.minimum(least, apart)
    return least - BODY.radius


def random_walk(job: tuple[Floor, int, int]) -> dict[str, float]:
    """`moves` random moves on a floor: counts, CPU seconds, least exact room [m]."""
    floor, moves, seed = job
    rng = np.random.default_rng(seed)
    grid = bake(floor, cell=0.1)
    spots = np.argwhere(grid.free)
    seconds, least, penetrations, blocked, metres = 0.0, math.inf, 0, 0, 0.0
    pose = Pose(0.0, 0.0)
    for begin in range(0, moves, CHUNK):
        count = min(CHUNK, moves - begin)
        dts = rng.choice([1 / 60, 1 / 30, 0.1, 0.5, 5.0], count, p=[0.45, 0.3, 0.2, 0.04, 0.01])
        dts = dts * rng.uniform(0.2, 1.0, count)
        # A heading is kept for a while: that is how visitors press into corners.
        yaws = np.repeat(rng.uniform(-math.pi, math.pi, count // 25 + 1), 25)[:count]
        keys = np.repeat(rng.integers(0, 8, count // 25 + 1), 25)[:count]
        places = np.zeros((count, 2))
        for i in range(count):
            if i % 200 == 0:
                iz, ix = spots[rng.integers(len(spots))]
                pose = Pose(float(grid.x0 + ix * grid.cell), float(grid.z0 + iz * grid.cell))
            pose = Pose(pose.x, pose.z, float(yaws[i]))
            began = time.process_time()
            after = step(pose, KEYS[keys[i]], float(dts[i]), floor)
            seconds += time.process_time() - began
            walked = math.hypot(after.x - pose.x, after.z - pose.z)
            blocked += walked < 0.99 * 1.6 * dts[i]
            metres += walked
            pose, places[i] = after, (after.x, after.z)
        rooms = room(places, floor)
        least, penetrations = min(least, float(rooms.min())), penetrations + int((rooms < 0).sum())
    return {
        "moves": moves,
        "seconds": seconds,
        "least": least,
        "penetrations": penetrations,
        "blocked": blocked,
        "metres": metres,
    }
