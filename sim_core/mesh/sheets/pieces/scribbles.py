"""Closed lines that cross themselves all over, which are no outlines and take n² steps to tell areas of."""

import numpy as np
import shapely

from sim_core.mesh.outline.crossings import crossed_steps

__all__ = ["is_scribble"]

FEW = 60  # steps whose crossings are told in a moment however many they are
SAMPLE = 200  # steps that are looked at
OFTEN = 6  # steps that one of these crosses: of small loops, as offset lines have them, two or three


def is_scribble(points: np.ndarray) -> bool:
    """Whether a line (n, 2) [m], closed, crosses itself not here and there but each step several others."""
    if len(points) <= FEW or shapely.is_valid(shapely.Polygon(points)):
        return False
    ring = np.vstack([points, points[:1]])
    ring = ring[np.append(True, (ring[1:] != ring[:-1]).any(axis=1))]
    crossed = np.flatnonzero(crossed_steps([ring])[0])
    if len(crossed) <= FEW:
        return False
    steps = np.asarray(shapely.linestrings(np.stack([ring[:-1], ring[1:]], axis=1)))
    some = crossed[:: 1 + len(crossed) // SAMPLE]
    met = shapely.STRtree(steps).query(steps[some], predicate="crosses")
    return met.shape[1] > OFTEN * len(some)
