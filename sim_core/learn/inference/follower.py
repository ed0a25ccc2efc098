"""A sheet followed frame by frame: the base, mended in a few learned steps, each told what balance still lacks.

A step is what an iteration of a solver is, with a network in the place of the inverse: it reads how the coarse sheet
lies and goes, where the fine one was a frame and two ago, and the forces that are out of balance where it is put now,
and says a patch about every coarse vertex to put it elsewhere (learned gradient descent, Andrychowicz et al. 2016). The
first step also says what share of the last frame's displacement stays.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numba import njit

from sim_core.errors import SimCoreError
from sim_core.learn.convolution import depthwise
from sim_core.learn.inference.ground import Ground
from sim_core.learn.inference.settings import PATCH, Settings
from sim_core.learn.patches import SEEN
from sim_core.learn.upsampling import weighted_sums
from sim_core.validation import coordinates

__all__ = ["GATE_BIAS", "Follower"]

GATE_BIAS = -2.0  # so that of the last frame little stays until it is learned otherwise


class Follower:
    """Follows the frames of one sequence from the first on."""

    def __init__(self, ground: Ground, settings: Settings, weights: Mapping[str, np.ndarray]) -> None:
        """weights: float32 by the names of `Settings.shapes`. Raises SimCoreError where they have other shapes."""
        for name, shape in settings.shapes().items():
            if name not in weights or weights[name].shape != shape:
                raise SimCoreError(
                    f"weights: {name} – {shape} is meant, {weights[name].shape if name in weights else 'none'} found"
                )
        self.ground, self.settings, self._weights = ground, settings, weights
        self._last: tuple[np.ndarray, ...] = ()  # coarse, one and two frames ago
        self._turn: np.ndarray | None = None  # the frames in which the last one was said
        self._off = np.zeros((len(ground.pair.fine.rest), 3), np.float32)
        self._was = np.zeros(
            (ground.patches.count, PATCH), np.float32
        )  # the patches of the one before, told then

    def __call__(self, coarse: np.ndarray) -> np.ndarray:
        """The next frame: coarse (C, 3) [m] -> fine (V, 3) [m]. Raises SimCoreError for another sheet, or NaN."""
        ground, fit = self.ground, self.ground.patches.fitted
        now = coordinates("coarse", coarse, (len(ground.pair.coarse.rest), 3))
        before, earlier = (*self._last, now, now)[:2]
        if len(self._last) == 1:
            earlier = before
        turn, seen = ground.surroundings.seen(now, before, earlier)
        last = ground.patches.carried(self._off, turn if self._turn is None else self._turn, turn)
        base, shared = weighted_sums(ground.pair.base, now), ground.imbalance.shared(now)
        was = _flat(fit(last, turn))
        change = was - self._was
        off, there = np.zeros_like(last), np.zeros_like(was)
        for step in range(self.settings.steps):
            ways, means = ground.lacking(base + ground.unit * off, now, shared, turn)
            known = np.concatenate(
                [seen, there, change, there - was, _flat(fit(ways, turn)), means], axis=1, dtype=np.float32
            )
            said, stays = self._step(step, known)
            if step == 0:
                off = ground.patches.scaled(last, 1.0 / (1.0 + np.exp(-(stays + GATE_BIAS))))
            off = off + ground.patches.displaced(said.reshape(len(now), -1, 3), turn)
            if step + 1 < self.settings.steps:
                there = _flat(fit(off, turn))
        self._last, self._turn = (now, before), turn
        self._off, self._was = off, was
        return base + ground.unit * off

    def _step(self, step: int, known: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Patches (C, PATCH) and what the gate says (C,)."""
        name, weights = f"steps.{step}", self._weights
        x = known @ weights[f"{name}.inner.weight"].T + weights[f"{name}.inner.bias"]
        for block in range(self.settings.blocks):
            part = f"{name}.blocks.{block}"
            mixed = depthwise(x, self.ground.surroundings.near, weights[f"{part}.spiral"])
            wide = mixed @ weights[f"{part}.widen.weight"].T
            _swished(wide, weights[f"{part}.widen.bias"])
            x = x + wide @ weights[f"{part}.narrow.weight"].T + weights[f"{part}.narrow.bias"]
        out = x @ weights[f"{name}.outer.weight"].T + weights[f"{name}.outer.bias"]
        return out[:, :PATCH] + known[:, SEEN:] @ weights[f"{name}.past.weight"].T, out[:, PATCH]


def _flat(patches: np.ndarray) -> np.ndarray:
    return patches.reshape(len(patches), -1)


@njit(cache=True)
def _swished(x, bias):
    """x + bias through hard swish, x clip(x + 3, 0, 6) / 6 (Howard et al. 2019), in place."""
    sixth, zero, three, six = np.float32(1 / 6), np.float32(0), np.float32(3), np.float32(6)
    for i in range(len(x)):
        row = x[i]
        for c in range(len(row)):
            y = row[c] + bias[c]
            row[c] = y * min(max(y + three, zero), six) * sixth
