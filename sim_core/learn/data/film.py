"""One sequence simulated: the coarse sheet free, then the fine one softly led by it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from sim_core.cloth import Live, Pace, Scene
from sim_core.cloth.step.frame import FRAME
from sim_core.learn.data.lead import CALM, SLOW, Lead, between
from sim_core.learn.data.recipe import Recipe
from sim_core.learn.upsampling import linear

__all__ = ["Film", "coarse_film", "fine_film", "film"]

GRAVITY = 9.81  # [m/s2]
Told = Callable[[float], None]


@dataclass(frozen=True)
class Film:
    """A sequence after each of T frames of 1/25 s: coarse (T, C, 3), fine (T, V, 3) float32 [m], and what a frame of
    each cost [ms of processor time, median; of the fine one with all that leads it]."""

    coarse: np.ndarray
    fine: np.ndarray
    coarse_ms: float
    fine_ms: float


def film(recipe: Recipe, told: Told | None = None) -> Film:
    """Both films of a sequence, without their run-in; told: hears which share is done.

    Raises what `Live` raises.
    """
    coarse, coarse_ms = coarse_film(recipe)
    fine, fine_ms = fine_film(recipe, coarse, told)
    return Film(coarse[1 + recipe.run_in :].astype(np.float32), fine, coarse_ms, fine_ms)


def coarse_film(recipe: Recipe) -> tuple[np.ndarray, float]:
    """The coarse sheet let go (T + 1, C, 3) [m], its begin and run-in included, and ms a frame."""
    free = _live(recipe.on(recipe.coarse), recipe.paces[0], (0.0, -GRAVITY, 0.0))
    frames, ends = [free.positions], [time.process_time()]
    for _ in range(recipe.length):
        frames.append(free.step())
        ends.append(time.process_time())
    return np.stack(frames), 1000.0 * float(np.median(np.diff(ends)))


def fine_film(
    recipe: Recipe, coarse: np.ndarray, told: Told | None = None, *, pace: Pace | None = None
) -> tuple[np.ndarray, float]:
    """The fine sheet led by a coarse film (T + 1, C, 3) [m], begin and run-in included: its frames (T', V, 3) float32
    after the run-in, and ms a frame; pace: another than its recipe's."""
    own, sheet = recipe.on(recipe.fine, SLOW), recipe.on(recipe.coarse).sheet
    air = own.air
    if air is not None:
        own = replace(own, air=replace(air, gusts=0.0).blowing(_slowed(air.at(0.0))))
    led = _live(own, pace or recipe.paces[1], (0.0, -GRAVITY / SLOW**2, 0.0), CALM / SLOW)
    lead = Lead.of(linear(sheet.rest, sheet.faces, own.sheet.rest), own.sheet.mass)
    loose = np.setdiff1d(np.arange(len(own.sheet.rest)), own.pins)
    frames, ends = [], [time.process_time()]
    for number, (before, there) in enumerate(pairwise(between(coarse)), 1):
        forces = lead.forces(led.positions, before, there)
        wind = None if air is None else _slowed(air.at(number / SLOW * FRAME))
        now = led.step(pulls=(loose, forces[loose]), wind=wind)
        if number % SLOW:
            continue
        ends.append(time.process_time())
        if len(ends) > 1 + recipe.run_in:
            frames.append(now.astype(np.float32))
        if told is not None:
            told(number / SLOW / recipe.length)
    return np.stack(frames), 1000.0 * float(np.median(np.diff(ends)))


def _slowed(wind: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (wind / SLOW).tolist()
    return x, y, z


def _live(scene: Scene, pace: Pace, gravity: tuple[float, float, float], calm: float = 0.0) -> Live:
    return Live(
        scene.sheet,
        scene.positions,
        gravity=gravity,
        damping=scene.sheet.material.mass_damping + calm,
        pins=scene.pins,
        collider=scene.collider,
        contact=scene.contact,
        air=scene.air,
        pace=pace,
    )
