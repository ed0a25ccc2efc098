"""Whether a layer may be dressed as one half against its mirror image, an optimisation that the driver takes itself,
and whether the whole garment agrees with what its half came to."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from sim_core.cloth import Drape
from sim_core.garment.dressing.course import Moves
from sim_core.garment.garment import Garment
from sim_core.garment.garment_sheet import standing
from sim_core.garment.outfit import Layer, Outfit, Step
from sim_core.garment.pattern import Spot

__all__ = ["let_go_whole", "mirrored"]

SLACK = 1e-6  # [m]


def let_go_whole(garment: Garment, rest: Step, hooks: dict[str, Any]) -> tuple[Garment, Drape]:
    """A garment whose half came to rest, let go as a whole until that rests, in up to twice the time of the step.

    Stacked folds bear on each other in turn, and the whole takes them in another turn than its half did: its halves
    differ by a little in the end. hooks: progress, on_frame and checkpoint of `drape`.
    """
    assert garment.settled is not None
    phase = replace(garment.settled.phase(2 * rest.seconds, rest.label), rest=rest.still)
    last = standing(garment)([phase], **hooks)
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
    if not (pattern.alike and layer.place.halves) or pattern.ties or any(spot.side for spot in spots):
        return False
    if any(step.belt is not None for step in steps):
        return False
    lying = [panel.outline()[:, 0].min() for panel in pattern.panels if panel.along is None]
    return min(lying) > -SLACK
