"""Whether a layer may be dressed as one half against its mirror image, an optimisation that the driver takes itself,
and whether the whole garment agrees with what its half came to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sim_core.cloth import Drape
from sim_core.cloth.step import FRAME
from sim_core.garment.dressing.course import Moves
from sim_core.garment.garment import Garment
from sim_core.garment.garment_sheet import standing
from sim_core.garment.outfit import Layer, Outfit, Step
from sim_core.garment.pattern import Spot

__all__ = ["confirmed", "mirrored"]

SLACK = 1e-6  # [m]
ALIKE = 5e-5  # [m] that p99 of a whole garment may move in a frame where its half had come to rest


def confirmed(garment: Garment, last: Drape, rest: Step) -> tuple[Garment, Drape]:
    """A garment and how its half came to rest, `last`, if the whole rests there, too; else the whole comes to rest
    itself, in up to twice the time of the step, and its halves differ a little.

    Stacked folds bear on each other in turn, and the whole takes them in another turn than its half did.
    """
    assert garment.settled is not None
    let_go, phase = standing(garment), garment.settled.phase(2 * rest.seconds, rest.label)
    if let_go([replace(phase, seconds=FRAME)]).rest_p99 <= ALIKE:
        return garment, last
    last = let_go([replace(phase, rest=rest.still)])
    return replace(garment, positions=last.positions), last


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
