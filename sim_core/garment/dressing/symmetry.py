"""Whether a layer may be dressed as one half against its mirror image: an optimisation that the driver takes itself."""

from __future__ import annotations

import numpy as np

from sim_core.garment.dressing.course import Moves
from sim_core.garment.outfit import Layer, Outfit
from sim_core.garment.pattern import Spot

__all__ = ["mirrored"]

SLACK = 1e-6  # [m]


def mirrored(outfit: Outfit, number: int, moves: Moves) -> bool:
    """Whether pattern, wearer, poses, ties and all layers beneath are mirror images of themselves."""
    if outfit.wearer is None or not all(pose.symmetric for pose in moves.poses):
        return False
    points = np.unique(np.round(outfit.wearer.vertices * 1e5).astype(np.int64), axis=0)
    images = np.unique(points * [-1, 1, 1], axis=0)
    if points.shape != images.shape or np.abs(points - images).max() > 1:
        return False
    return all(_alike(layer) for layer in outfit.layers[: number + 1])


def _alike(layer: Layer) -> bool:
    """Whether a layer's two halves are cut, placed and held alike, and keep to their own sides."""
    pattern, steps = layer.pattern, layer.program.steps
    spots = [spot for step in steps for spot in step.spots if isinstance(spot, Spot)]
    if not (pattern.mirror and layer.place.halves) or pattern.ties or any(spot.side for spot in spots):
        return False
    lying = [panel.outline()[:, 0].min() for panel in pattern.panels if panel.along is None]
    return min(lying) > -SLACK
