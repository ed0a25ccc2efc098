"""`--quality best`: a row along the outline, lattice inside, and smoothing between growths until no angle is small."""

from typing import NamedTuple

import numpy as np

from sim_core.mesh.graded import graded_points
from sim_core.mesh.growth import CLOSED, Growth, grow_points
from sim_core.mesh.lattice import staggered_points
from sim_core.mesh.layer import apart, layer_points
from sim_core.mesh.raycast import distance_below, inside, keep_points
from sim_core.mesh.repair import repaired
from sim_core.mesh.sampling import Rim
from sim_core.mesh.sizes import SizeField
from sim_core.mesh.smoothing import centre, open_angles, sharpest_angle, stars

__all__ = ["BestFill", "best_fill"]

UPRIGHT = np.array([1.0, -1.0])
LAYER_OFF_OUTLINE = 0.6  # of the edge: points of the row nearer to the outline or to each other are dropped
LAYER_APART = 0.7
LATTICE_OFF_OUTLINE = 1.2
LATTICE_OFF_LAYER = 0.65
BAND = 5.0  # of the edge: what lies deeper is lattice already and stays
PASSES = 1  # of smoothing, each of SWEEPS rounds over the band, and growth again
SWEEPS = 5
GRADED_PASSES = 4
POLISHES = 4
ENOUGH = np.cos(np.radians(42.0))  # angles are opened up to this
LEAST = np.cos(np.radians(38.0))  # below this points are added and removed


class BestFill(NamedTuple):
    """vertices: (V, 2) [m], y down, the samples first.  faces: (F, 3) int32.  status, where: of the last growth."""

    vertices: np.ndarray
    faces: np.ndarray
    status: int
    where: int


def best_fill(rim: Rim, edge: float, sizes: SizeField | None = None) -> BestFill:
    """Fill a sampled rim with nearly equilateral triangles of `edge` [m], or of the lengths a size field wants."""
    fixed = len(rim.points)
    if sizes is None:
        places = np.concatenate([rim.points, _points(rim, edge)])
        free = fixed + np.flatnonzero(distance_below(places[fixed:], rim.segments, BAND * edge))
        return _relaxed(places * UPRIGHT, rim.steps, free, np.ones(len(places)), PASSES)
    places = np.concatenate([rim.points, graded_points(rim, edge, sizes)])
    weights = (
        edge / sizes.at(places, edge)
    ) ** 4  # density per area that gives edges in proportion to the sizes
    return _relaxed(places * UPRIGHT, rim.steps, np.arange(fixed, len(places)), weights, GRADED_PASSES)


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


def _relaxed(places, steps, free, weights, passes: int) -> BestFill:
    """Grow, smooth and grow again; then open the smallest angles, and treat the spots where that is not enough."""
    grown = grow_points(places, steps)
    for _ in range(passes):
        if grown.status != CLOSED:
            break
        start, items = stars(grown.faces, len(places))
        centre(places, grown.faces, start, items, free, weights, SWEEPS)
        grown = grow_points(places, steps)
    angle, places, grown = _opened(places, grown, steps, free)
    if grown.status == CLOSED and angle > LEAST:
        again, weights, free = repaired(places, grown.faces, free, weights)
        regrown = grow_points(again, steps)
        if regrown.status == CLOSED:
            again_angle, again, regrown = _opened(again, regrown, steps, free)
            if again_angle < angle:
                places, grown = again, regrown
    if grown.status == CLOSED:
        places, grown = _without_strays(places, grown, int(steps.max()) + 1)
    return BestFill(places * UPRIGHT, grown.faces, grown.status, grown.where)


def _without_strays(places: np.ndarray, grown: Growth, fixed: int) -> tuple[np.ndarray, Growth]:
    """Drop points behind the first `fixed`, the rim's, that smoothing moved out of the cloth: no triangle has them."""
    kept = np.arange(len(places)) < fixed
    kept[grown.faces.ravel()] = True
    if kept.all():
        return places, grown
    number = (np.cumsum(kept) - 1).astype(np.int32)
    return places[kept], grown._replace(faces=number[grown.faces])


def _opened(places: np.ndarray, grown: Growth, steps: np.ndarray, free: np.ndarray):
    """Open small angles and grow again as long as that helps: (cosine of the smallest angle, places, growth)."""
    if grown.status != CLOSED:
        return 2.0, places, grown
    best = sharpest_angle(places, grown.faces), places, grown
    for _ in range(POLISHES):
        if best[0] <= ENOUGH:
            break
        start, items = stars(best[2].faces, len(places))
        places = best[1].copy()
        if open_angles(places, best[2].faces, start, items, free, ENOUGH, 6) == 0:
            break
        grown = grow_points(places, steps)
        if grown.status != CLOSED:
            break
        angle = sharpest_angle(places, grown.faces)
        if angle >= best[0]:
            break
        best = angle, places, grown
    return best
