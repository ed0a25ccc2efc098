"""What the data are worth: the fine film against itself with half the time step, both led by one coarse film."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim_core.learn.data.film import coarse_film, fine_film
from sim_core.learn.data.lead import Lead
from sim_core.learn.data.recipe import Recipe
from sim_core.learn.data.take import Take
from sim_core.learn.evaluation import ErrorSummary, FrameErrors, frame_errors, summary
from sim_core.learn.upsampling import linear

__all__ = ["GATE", "Floor", "floor", "halved"]

GATE = 1 / 3  # of an error that is claimed, at most, may the floor be
EVERY = 5  # frames from one that is measured to the next


@dataclass(frozen=True)
class Floor:
    """halved: the errors of the fine film against that of half the step; linear: of the coarse surface against it, for
    comparison; slack [m]: how far the fine means are from the coarse surface's; fine_ms, halved_ms: of a frame."""

    halved: ErrorSummary
    linear: ErrorSummary
    slack: float
    fine_ms: float
    halved_ms: float


def floor(recipe: Recipe, frames: int) -> Floor:
    """The floor over the first so many frames of a sequence, every fifth of them."""
    recipe = replace(recipe, frames=min(frames, recipe.frames))
    coarse, _ = coarse_film(recipe)
    fine, fine_ms = fine_film(recipe, coarse)
    again, halved_ms = fine_film(recipe.halved(), coarse)
    sheet, below = recipe.on(recipe.fine).sheet, recipe.on(recipe.coarse).sheet
    spread = linear(below.rest, below.faces, sheet.rest)
    lead, own = Lead.of(spread, sheet.mass), coarse[1 + recipe.run_in :]
    rows = range(min(EVERY, len(fine)) - 1, len(fine), EVERY)
    pairs = [(np.asarray(fine[k], float), np.asarray(again[k], float)) for k in rows]
    halved = [frame_errors(one, other, sheet.faces, sheet.rest) for one, other in pairs]
    flat = [
        frame_errors(spread @ own[k], other, sheet.faces, sheet.rest)
        for k, (_, other) in zip(rows, pairs, strict=True)
    ]
    slack = [
        np.linalg.norm(lead.away(other, own[k]), axis=1).mean()
        for k, (_, other) in zip(rows, pairs, strict=True)
    ]
    return Floor(summary(halved), summary(flat), float(np.mean(slack)), fine_ms, halved_ms)


def halved(take: Take, frames: int) -> tuple[FrameErrors, ...]:
    """How far the first so many frames of a fine film that was kept are from what half the step makes, every fifth."""
    recipe = replace(take.recipe, frames=min(frames, len(take.film.fine)))
    coarse, _ = coarse_film(recipe)
    again, _ = fine_film(recipe.halved(), coarse)
    sheet, fine = take.pair.fine, take.film.fine
    rows = range(min(EVERY, len(again)) - 1, len(again), EVERY)
    return tuple(
        frame_errors(np.asarray(fine[k], float), np.asarray(again[k], float), sheet.faces, sheet.rest)
        for k in rows
    )
