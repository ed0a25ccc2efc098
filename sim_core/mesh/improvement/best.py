"""`--quality best`: a row along the outline, lattice inside, and smoothing between growths until no angle is small."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from sim_core.mesh.improvement.angles import small_angles
from sim_core.mesh.improvement.refinement import refined
from sim_core.mesh.improvement.repair import SPOTS, repaired
from sim_core.mesh.improvement.smoothing import centre, open_angles, sharp_angles, sharpest_angle
from sim_core.mesh.measures.triangles import stars
from sim_core.mesh.outline.samples import Rim
from sim_core.mesh.outline.size_field import SizeField
from sim_core.mesh.points.graded import graded_points
from sim_core.mesh.points.lattice import staggered_points
from sim_core.mesh.points.layer import apart, layer_points
from sim_core.mesh.points.raycast import distance_below, inside, keep_points
from sim_core.mesh.triangulation.growth import CLOSED, Growth, grow_points

__all__ = ["BestFill", "best_fill"]

UPRIGHT = np.array([1.0, -1.0])
LAYER_OFF_OUTLINE = 0.6  # of the edge: points of the row nearer to the outline or to each other are dropped
LAYER_APART = 0.7
LATTICE_OFF_OUTLINE = 1.2
LATTICE_OFF_LAYER = 0.65
BAND = 5.0  # of the edge: what lies deeper is lattice already and stays
PASSES = 1  # of smoothing, each of SWEEPS rounds over the band, and growth again
SWEEPS = 5
ADDED, ADDED_AT_LEAST = (
    32,
    100_000,
)  # points put in where angles are small: by the point there is, and in any case
GRADED_PASSES = 4
POLISHES = 4  # times that small angles are opened
GRADED_POLISHES = 16  # the same where points were put in
ENOUGH = np.cos(np.radians(42.0))  # angles are opened up to this
GRADED_ENOUGH = np.cos(np.radians(34.0))  # the same where points were put in: edges that grow leave no more
SMALL = np.cos(np.radians(30.0))
LEAST = np.cos(np.radians(38.0))  # below this points are added and removed


class BestFill(NamedTuple):
    """vertices: (V, 2) [m], y down, the samples first.  faces: (F, 3) int32.  status, where: of the last growth.
    rim: as given, or with its steps divided; the points that divide them are among the last vertices."""

    vertices: np.ndarray
    faces: np.ndarray
    status: int
    where: int
    rim: Rim


def best_fill(rim: Rim, edge: float, sizes: SizeField | None = None, *, refine: bool = True) -> BestFill:
    """Fill a sampled rim with nearly equilateral triangles of `edge` [m], or of the lengths a size field wants.

    refine: put points in, and divide steps of the rim, where angles below 30 degrees are left (`refinement.py`).
    """
    fixed = len(rim.points)
    if sizes is None:
        places = np.concatenate([rim.points, _points(rim, edge)])
        free = fixed + np.flatnonzero(distance_below(places[fixed:], rim.segments, BAND * edge))
        filled = _relaxed(places * UPRIGHT, rim.steps, free, np.ones(len(places)), PASSES)
    else:
        places = np.concatenate([rim.points, graded_points(rim, edge, sizes)])
        # density per area that gives edges in proportion to the sizes
        weights = (edge / sizes.at(places, edge)) ** 4
        filled = _relaxed(places * UPRIGHT, rim.steps, np.arange(fixed, len(places)), weights, GRADED_PASSES)
    places, grown = filled
    if grown.status == CLOSED:
        rim, places, grown = _without_strays(rim, *filled)
        if refine:
            rim, places, grown = _without_strays(*_refined(rim, places, grown, edge))
    return BestFill(places * UPRIGHT, grown.faces, grown.status, grown.where, rim)


def _refined(rim: Rim, places: np.ndarray, grown: Growth, edge: float) -> tuple[Rim, np.ndarray, Growth]:
    """Points put in where angles are small, then moved to open them further."""
    if sharpest_angle(places, grown.faces) <= SMALL:
        return rim, places, grown
    if not small_angles(places, grown.faces, rim.steps).any():
        return rim, places, grown
    made = refined(places, rim.steps, rim.kept, edge, ADDED * len(places) + ADDED_AT_LEAST)
    if made is None:
        return rim, places, grown
    divided = rim.divided(made.divided)
    steps = divided.steps
    regrown = grow_points(made.places, steps)
    free = np.ones(len(made.places), dtype=bool)
    free[steps.ravel()] = False
    # angles that nothing can open, of narrow corners, are no reason to leave the others as they are
    judged = partial(sharp_angles, free=free, cosine=SMALL)
    aim = _Aim(GRADED_ENOUGH, GRADED_POLISHES, judged)
    _, moved, regrown = _opened(made.places, regrown, steps, np.flatnonzero(free), aim)
    return (divided, moved, regrown) if regrown.status == CLOSED else (rim, places, grown)


def _points(rim: Rim, edge: float) -> np.ndarray:
    """The row along the rim, then the lattice where neither is near. (n, 2) [m]"""
    contours, segments = rim.contours, rim.segments
    row = layer_points(rim.points, rim.steps)
    row = row[inside(row, contours)]
    row = row[~distance_below(row, segments, LAYER_OFF_OUTLINE * edge)]
    lattice = staggered_points(contours[0].min(axis=0), contours[0].max(axis=0), edge)
    lattice = keep_points(lattice, contours, edge=edge, threshold=LATTICE_OFF_OUTLINE, segments=segments)
    inner = np.concatenate([row, lattice])
    if len(inner) == 0:
        return inner
    reach = np.full(len(inner), LATTICE_OFF_LAYER * edge)
    reach[: len(row)] = LAYER_APART * edge
    return inner[apart(inner, reach, 0)]


def _relaxed(places, steps, free, weights, passes: int) -> tuple[np.ndarray, Growth]:
    """Grow, smooth and grow again; then open the smallest angles, and treat the spots where that is not enough."""
    grown = grow_points(places, steps)
    for _ in range(passes):
        if grown.status != CLOSED:
            break
        start, items = stars(grown.faces, len(places))
        centre(places, grown.faces, start, items, free, weights, SWEEPS)
        grown = grow_points(places, steps)
    (angle,), places, grown = _opened(places, grown, steps, free)
    few = angle <= SMALL or (
        grown.status == CLOSED and small_angles(places, grown.faces, steps).sum() <= SPOTS
    )
    if (
        grown.status == CLOSED and few and angle > LEAST
    ):  # where many are small, whole places are missing (`refinement.py`)
        again, weights, free = repaired(places, grown.faces, free, weights)
        regrown = grow_points(again, steps)
        if regrown.status == CLOSED:
            (again_angle,), again, regrown = _opened(again, regrown, steps, free)
            if again_angle < angle:
                places, grown = again, regrown
    return places, grown


def _without_strays(rim: Rim, places: np.ndarray, grown: Growth) -> tuple[Rim, np.ndarray, Growth]:
    """Drop points, but none of the rim's, that smoothing moved out of the cloth: no triangle has them."""
    kept = np.arange(len(places)) < len(rim.points)
    kept[grown.faces.ravel()] = True
    if kept.all():
        return rim, places, grown
    number = (np.cumsum(kept) - 1).astype(np.int32)
    loops, lines = (tuple(number[chain] for chain in chains) for chains in (rim.loops, rim.lines))
    return replace(rim, loops=loops, lines=lines), places[kept], grown._replace(faces=number[grown.faces])


def _sharpest(places: np.ndarray, faces: np.ndarray) -> tuple[float]:
    return (sharpest_angle(places, faces),)


class _Aim(NamedTuple):
    """Angles below arccos(`enough`) are opened, and points grown again, so many times at most while what is judged of
    places and faces, a tuple with the cosine of the smallest angle at its end, gets less."""

    enough: float = ENOUGH
    times: int = POLISHES
    judged: Callable[[np.ndarray, np.ndarray], tuple] = _sharpest


ORDINARY = _Aim()


def _opened(places: np.ndarray, grown: Growth, steps: np.ndarray, free: np.ndarray, aim: _Aim = ORDINARY):
    """Open small angles and grow again as long as that helps: (what is judged, places, growth)."""
    if grown.status != CLOSED:
        return (2.0,), places, grown
    best = aim.judged(places, grown.faces), places, grown
    for _ in range(aim.times):
        if best[0][-1] <= aim.enough:
            break
        start, items = stars(best[2].faces, len(places))
        places = best[1].copy()
        if open_angles(places, best[2].faces, start, items, free, aim.enough, 6) == 0:
            break
        grown = grow_points(places, steps)
        if grown.status != CLOSED:
            break
        found = aim.judged(places, grown.faces)
        if found >= best[0]:
            break
        best = found, places, grown
    return best
