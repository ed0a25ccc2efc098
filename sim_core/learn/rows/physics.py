"""Cheaper physics: how near the engine itself comes on meshes between the coarse one and the fine, and for how much."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array, eye_array

from sim_core.cloth import Pace, Sheet
from sim_core.errors import SimCoreError
from sim_core.learn.data import Take, coarse_film, fine_film, looked_at
from sim_core.learn.evaluation import FrameErrors, frame_errors, summary
from sim_core.learn.rows.measured import Measured, Told
from sim_core.learn.upsampling import biharmonic, linear, weighted_sums

__all__ = ["QUICK", "led_physics"]

QUICK = Pace("single", 0.95)  # as fast as the engine goes
CUT = 1e-3  # weights of a row that are less of its greatest are left out
AFTER = 1  # frames beyond those that are measured: the last of a film is led otherwise than others
SAME = 1e-4  # [m] that a coarse film may differ by from what was kept of it in 16 bits


def led_physics(takes: Sequence[Take], share: float, frames: int, told: Told | None = None) -> Measured:
    """Sheets of so large a share of the fine vertices, simulated as fast as the engine goes and led by the same coarse
    films, over the first so many frames of each sequence; the smoothest sheet through them is measured.

    Milliseconds are those of leading and simulating, with the coarse sheet not counted. Raises SimCoreError for a
    coarse film that comes out otherwise here than where the data were made: errors would be those of two motions.
    """
    found: dict[str, tuple[FrameErrors, ...]] = {}
    spent: list[float] = []
    for number, take in enumerate(takes):
        if told is not None:
            told(number / len(takes), f"physics {share:.0%} {take.name}")
        found[take.name], milliseconds = _led(take, share, min(frames, len(take.film.fine)))
        spent.append(milliseconds)
    whole = [error for errors in found.values() for error in errors]
    return Measured(summary(whole), found, float(np.median(spent)))


def _led(take: Take, share: float, frames: int) -> tuple[tuple[FrameErrors, ...], float]:
    recipe = take.recipe
    recipe = replace(
        recipe, frames=min(frames + AFTER, recipe.frames), fine=max(4, round(share * recipe.fine))
    )
    coarse, _ = coarse_film(recipe)
    own, kept = coarse[1 + recipe.run_in :][:frames], take.film.coarse[:frames]
    if np.abs(own - kept).max() > SAME:
        raise SimCoreError(
            f"{take.name}: its coarse film comes out otherwise on this machine – make the data here, in another folder"
        )
    made, milliseconds = fine_film(recipe, coarse, pace=QUICK)
    fine, between = take.pair.fine, recipe.on(recipe.fine).sheet
    through = _through(between, fine)
    errors = []
    for k in looked_at(frames):
        now, wanted = (film[k].astype(float) for film in (made, take.film.fine))
        errors.append(frame_errors(weighted_sums(through, now), wanted, fine.faces, fine.rest))
    return tuple(errors), milliseconds


def _through(between: Sheet, fine: Sheet) -> csr_array:
    """The smoothest fine sheet (V, M) whose surface has the other's vertices where they lie at rest."""
    if np.array_equal(between.rest, fine.rest):
        return csr_array(eye_array(len(fine.rest)))
    return biharmonic(fine.rest, fine.faces, linear(fine.rest, fine.faces, between.rest), cut=CUT).matrix
