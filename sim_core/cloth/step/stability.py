"""The largest stable step of the current tangent, by power iteration that goes on where the last frame left it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numba import njit

from sim_core.cloth.step.kernels.banded import (
    axes,
    band_add,
    band_bends,
    band_pulls,
    band_strain_changes,
    band_strains,
    band_tensions,
)
from sim_core.cloth.step.kernels.bands import Bands
from sim_core.cloth.step.leapfrog import Room

LEAST_ROUNDS, MOST_ROUNDS = 16, 60  # of the power iteration; the first of a run takes the most
SETTLED = 2e-3  # share by which the largest eigenvalue may still grow in a round and count as found


@njit(cache=True, error_model="numpy")
def stiffness_times(bands, room, x, p, out, stiffer=1.0):
    """out = -K p (3, V) for the tangent at x, whose tensions lie in room.tension: the derivative of the force.

    stiffer: what the elastic part is multiplied with (an implicit step's damping).
    """
    g = room.air
    band_strain_changes(bands.edge_runs, axes(x), axes(p), room.strain)
    band_tensions(bands.tension_runs, bands.own, bands.coupling, room.strain, room.change)
    if stiffer != 1.0:
        room.change[:] *= stiffer
    band_pulls(bands.vertex_runs, room.change, axes(x), axes(out))
    band_pulls(bands.vertex_runs, room.tension, axes(p), axes(g))
    band_add(axes(out), axes(g))
    band_bends(bands.bend_runs, bands.bend, 1.0, axes(p), axes(out))


@njit(cache=True, error_model="numpy")
def tensions_at(bands, room, x):
    """Fills room.strain and room.tension for positions x (3, V), without damping."""
    band_strains(bands.edge_runs, bands.length2, axes(x), room.strain)
    band_tensions(bands.tension_runs, bands.own, bands.coupling, room.strain, room.tension)


@njit(cache=True, error_model="numpy")
def _grown(bands, inverse, room, x, mode, least, bend_only):
    """Largest eigenvalue of M^-1 K [1/s2] by power iteration on mode (3, V), which is renewed.

    It takes `least` rounds or more, until it settles: where the cloth stiffens quickly (a jerk, a start that is no
    rest) a few rounds a frame stay behind, the step is too long, and the cloth crumples without blowing up.
    """
    out = room.force
    value = 0.0
    for turn in range(MOST_ROUNDS):
        before = value
        if bend_only:
            out[:] = 0.0
            band_bends(bands.bend_runs, bands.bend, 1.0, axes(mode), axes(out))
        else:
            stiffness_times(bands, room, x, mode, out)
        square = 0.0
        for c in range(3):
            for i in range(len(inverse)):
                out[c, i] *= inverse[i]
                square += out[c, i] * out[c, i]
        value = np.sqrt(square)
        scale = 1.0 / value if value > 0.0 else 0.0
        for c in range(3):
            for i in range(len(inverse)):
                mode[c, i] = -scale * out[c, i]
        if turn + 1 >= least and not value - before > SETTLED * value:
            break
    return value


@lru_cache(maxsize=4)
def _start(count: int) -> np.ndarray:
    mode = np.random.default_rng(20).standard_normal((3, count))
    return mode / np.sqrt((mode * mode).sum())


def first_mode(count: int) -> np.ndarray:
    """Where the iteration starts (3, V), a copy: the same for every run, so that equal input gives equal bits."""
    return _start(count).copy()


def highest_frequency2(
    bands: Bands, inverse: np.ndarray, room: Room, x: np.ndarray, mode: np.ndarray, *, first: bool
) -> float:
    """Largest eigenvalue of M^-1 K [1/s2] of the tangent at x (3, V); mode (3, V) is where it was and then is.

    A share of the fixed start is mixed in, so that a mode that becomes the stiffest elsewhere is found.
    """
    tensions_at(bands, room, x)
    if not first:
        mode += 0.2 * _start(mode.shape[1])
    return float(_grown(bands, inverse, room, x, mode, MOST_ROUNDS if first else LEAST_ROUNDS, False))


def bending_frequency2(bands: Bands, inverse: np.ndarray, room: Room) -> float:
    """Largest eigenvalue of M^-1 Q [1/s2]: bending alone, which does not change."""
    mode = first_mode(len(inverse))
    return float(_grown(bands, inverse, room, mode.copy(), mode, MOST_ROUNDS, True))


def stable_step(omega2: float, beta: float) -> float:
    """Largest stable leapfrog step [s] at omega2 [1/s2], lagged stiffness damping beta [s] included."""
    if not (np.isfinite(omega2) and omega2 > 0.0):
        return np.nan
    return float(np.sqrt(beta * beta + 4.0 / omega2) - beta)


def stable_with(step: float, beta: float) -> float:
    """Largest stable step [s] with lagged stiffness damping beta [s] where it is `step` [s] without."""
    return float(np.sqrt(beta * beta + step * step) - beta)
