"""`--quality best`: a row along the outline, lattice inside, and smoothing between growths until no angle is small."""

from typing import NamedTuple

import numpy as np

from sim_core.mesh.growth import CLOSED, Growth, grow_points
from sim_core.mesh.lattice import staggered_points
from sim_core.mesh.layer import apart, layer_points
from sim_core.mesh.raycast import distance_below, inside, keep_points
from sim_core.mesh.repair import repaired
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
POLISHES = 4
ENOUGH = np.cos(np.radians(42.0))  # angles are opened up to this
LEAST = np.cos(np.radians(38.0))  # below this points are added and removed


class BestFill(NamedTuple):
    """vertices: (V, 2) [m], y down, the samples first.  faces: (F, 3) int32.  status, where: of the last growth."""

    vertices: np.ndarray
    faces: np.ndarray
    status: int
    where: int


def best_fill(samples: list[np.ndarray], steps: np.ndarray, edge: float) -> BestFill:
    """Fill sampled contours with nearly equilateral triangles.

    samples: contours (m, 2) [m], y down, cloth on the left in (x, -y).  steps: (sum m, 2) their directed edges.
    """
    fixed = sum(len(loop) for loop in samples)
    places = _points(samples, edge) * UPRIGHT
    segments = np.concatenate([np.hstack([loop, np.roll(loop, -1, axis=0)]) for loop in samples])
    free = fixed + np.flatnonzero(distance_below(places[fixed:] * UPRIGHT, segments, BAND * edge))
    return _relaxed(places, steps, free, fixed)


def _points(samples: list[np.ndarray], edge: float) -> np.ndarray:
    """Samples, then the row along the outline, then the lattice where neither is near. (n, 2) [m]"""
    segments = np.concatenate([np.hstack([loop, np.roll(loop, -1, axis=0)]) for loop in samples])
    row = layer_points(samples)
    row = row[inside(row, samples)]
    row = row[~distance_below(row, segments, LAYER_OFF_OUTLINE * edge)]
    lattice = staggered_points(samples[0].min(axis=0), samples[0].max(axis=0), edge)
    lattice = keep_points(lattice, samples, edge=edge, threshold=LATTICE_OFF_OUTLINE)
    inner = np.concatenate([row, lattice])
    reach = np.full(len(inner), LATTICE_OFF_LAYER * edge)
    reach[: len(row)] = LAYER_APART * edge
    return np.concatenate([*samples, inner[apart(inner, reach, 0)]])


def _relaxed(places: np.ndarray, steps: np.ndarray, free: np.ndarray, fixed: int) -> BestFill:
    """Grow, smooth and grow again; then open the smallest angles, and treat the spots where that is not enough."""
    weights = np.ones(len(places))
    grown = grow_points(places, steps)
    for _ in range(PASSES):
        if grown.status != CLOSED:
            break
        start, items = stars(grown.faces, len(places))
        centre(places, grown.faces, start, items, free, weights, SWEEPS)
        grown = grow_points(places, steps)
    angle, places, grown = _opened(places, grown, steps, free)
    if grown.status == CLOSED and angle > LEAST:
        again, weights, free = repaired(places, grown.faces, free, weights, fixed)
        regrown = grow_points(again, steps)
        if regrown.status == CLOSED:
            again_angle, again, regrown = _opened(again, regrown, steps, free)
            if again_angle < angle:
                places, grown = again, regrown
    return BestFill(places * UPRIGHT, grown.faces, grown.status, grown.where)


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
