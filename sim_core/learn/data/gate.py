"""What the data are worth: the fine film against itself with half the time step, both led by one coarse film."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim_core.learn.data.film import coarse_film, fine_film
from sim_core.learn.data.lead import Lead
from sim_core.learn.data.recipe import Recipe
from sim_core.learn.evaluation import ErrorSummary, FrameErrors, frame_errors, summary
from sim_core.learn.upsampling import linear

__all__ = ["GATE", "Floor", "floor", "looked_at"]

GATE = 1 / 3  # of an error that is claimed, at most, may the floor be
EVERY = 5  # frames from one that is measured to the next


def looked_at(frames: int) -> range:
    """Which of so many frames are measured: every fifth, the last where there are fewer."""
    return range(min(EVERY, frames) - 1, frames, EVERY)


@dataclass(frozen=True)
class Floor:
    """halved: the errors of the fine film against that of half the step, and frames: of each that was measured; linear:
    of the coarse surface against it, for comparison; slack [m]: how far the fine means are from the coarse surface's;
    coarse_ms, fine_ms, halved_ms: of a frame."""

    halved: ErrorSummary
    frames: tuple[FrameErrors, ...]
    linear: ErrorSummary
    slack: float
    coarse_ms: float
    fine_ms: float
    halved_ms: float


def floor(recipe: Recipe, frames: int) -> Floor:
    """The floor over the first so many frames of a sequence. All its films are simulated here and end alike: what was
    kept of another machine's might follow another coarse film, and the last frame of a film is led otherwise than the
    same frame of a longer one."""
    recipe = replace(recipe, frames=min(frames, recipe.frames))
    coarse, coarse_ms = coarse_film(recipe)
    fine, fine_ms = fine_film(recipe, coarse)
    again, halved_ms = fine_film(recipe.halved(), coarse)
    sheet, below = recipe.on(recipe.fine).sheet, recipe.on(recipe.coarse).sheet
    spread = linear(below.rest, below.faces, sheet.rest)
    lead, own = Lead.of(spread, sheet.mass), coarse[1 + recipe.run_in :]
    halved, flat, slack = [], [], []
    for k in looked_at(len(fine)):
        one, other = np.asarray(fine[k], float), np.asarray(again[k], float)
        halved.append(frame_errors(one, other, sheet.faces, sheet.rest))
        flat.append(frame_errors(spread @ own[k], other, sheet.faces, sheet.rest))
        slack.append(np.linalg.norm(lead.away(other, own[k]), axis=1).mean())
    times = coarse_ms, fine_ms, halved_ms
    return Floor(summary(halved), tuple(halved), summary(flat), float(np.mean(slack)), *times)
