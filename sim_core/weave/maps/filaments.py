"""Filaments on the surface of the yarns: what catches the light of silk, many fine ridges that run along each yarn.

A yarn shows as many as lie side by side across it; where samples are too few to draw each, as many as can be drawn, for
a bundle of them looks alike. They follow the yarn's width, wander a little, and run aslant where the yarn is twisted.
What cannot be drawn at all is left to the roughness across the yarn.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numba import njit

from sim_core.weave.maps.samples import Samples
from sim_core.weave.yarns.geometry import Strands

__all__ = ["Filaments", "SPREAD_ACROSS", "filaments_of", "with_filaments"]

FEWEST, SAMPLES_EACH = 3, 5.0  # ridges worth drawing, and samples across one that show its shape
ROUNDNESS = 2.4  # ridges are circles that meet at 40 degrees: slope q / sqrt(ROUNDNESS - q^2), -1 < q < 1
SPREAD_ACROSS = 0.19  # mean square of that slope
TONES = 0.18  # how much one filament differs from another in brightness, after a study of the look
CREASE = 0.45  # of the light that does not reach the floor of the crease between two
WANDER = 0.45  # of a filament's width


@dataclass(frozen=True, eq=False)
class Filaments:
    """What is drawn on each kind of yarn. first: (kinds,) number of its first yarn; along: (kinds,) 0 warp, 1 weft;
    shown: (kinds,) ridges side by side, 0 where too few samples would show them; turns: (kinds,) whole turns of the
    twist over the tile, Z above 0; slant: (kinds,) tangent of the twist's angle at the surface; begin: where the tile's
    lower left corner lies, in laps of it (x, y)."""

    first: np.ndarray
    along: np.ndarray
    shown: np.ndarray
    turns: np.ndarray
    slant: np.ndarray
    begin: tuple[float, float]


def filaments_of(
    systems: tuple[Strands, ...],
    repeats: tuple[int, int],
    sample: tuple[float, float],
    origin: tuple[float, float],
) -> Filaments:
    """What samples so far apart (x, y) [m] can show of the yarns of a tile of so many repeats (across, up), whose lower
    left corner lies at `origin` [m]."""
    rows, count = [], 0
    for system in systems:
        along = 0 if system.along == "warp" else 1
        yarn, (across, up) = system.yarn, repeats
        lengthwise, crosswise = (up, across) if along == 0 else (across, up)
        most = yarn.width / sample[along] / SAMPLES_EACH
        shown = int(min(yarn.width / yarn.filament, most))
        turns = round(yarn.twist * lengthwise * system.length)
        rows.append((count, along, shown if shown >= FEWEST else 0, turns, pi * yarn.diameter * yarn.twist))
        count += len(system.place) * crosswise
    numbers = np.array(rows, float).T
    warp = systems[0]
    begin = origin[0] / (repeats[0] * warp.across), origin[1] / (repeats[1] * warp.length)
    first, along, shown, turns = (numbers[k].astype(np.int64) for k in range(4))
    return Filaments(first, along, shown, turns, numbers[4], begin)


def with_filaments(samples: Samples, filaments: Filaments) -> tuple[Samples, np.ndarray]:
    """Samples whose slopes and directions are those of filaments, and how bright each is (rows, columns) float32."""
    dx, dy, run = samples.dx.copy(), samples.dy.copy(), samples.run.copy()
    bright = np.ones(samples.height.shape, np.float32)
    _ridges(samples.yarn, samples.across, filaments.first, filaments.along, filaments.shown, filaments.turns,
            filaments.slant, *filaments.begin, dx, dy, run, bright)  # fmt: skip
    return Samples(samples.height, samples.yarn, dx, dy, run, samples.colour, samples.across), bright


@njit(cache=True, error_model="numpy")
def _hash(a, b):
    """A number in [0, 1) for two whole numbers."""
    x = (np.uint64(a) * np.uint64(0x9E3779B97F4A7C15)) ^ (np.uint64(b) * np.uint64(0xC2B2AE3D27D4EB4F))
    x ^= x >> np.uint64(29)
    x *= np.uint64(0xBF58476D1CE4E5B9)
    x ^= x >> np.uint64(32)
    return float(x >> np.uint64(40)) / 16777216.0


@njit(cache=True, error_model="numpy")
def _ridges(yarn, across, first, along, shown, turns, slant, left, low, dx, dy, run, bright):
    rows, columns = yarn.shape
    for row in range(rows):
        for column in range(columns):
            number = yarn[row, column]
            if number < 0:
                continue
            kind = first.size - 1
            while number < first[kind]:
                kind -= 1
            o = across[row, column]
            lap = low + 1.0 - (row + 0.5) / rows if along[kind] == 0 else left + (column + 0.5) / columns
            count = shown[kind]
            if slant[kind] != 0.0:
                tilt = np.arctan(slant[kind] * np.sqrt(max(1.0 - o * o, 0.0)))
                run[row, column] += -tilt if along[kind] == 0 else tilt
            if count == 0:
                continue
            if turns[kind] != 0:
                # round the yarn there are pi times as many as are seen across it, each at its own angle
                whole = int(np.pi * count)
                u = (np.arcsin(min(max(o, -1.0), 1.0)) / (2 * np.pi) - turns[kind] * lap) * whole
                k = int(np.floor(u))
                lane = k % whole
            else:
                phase = _hash(number, 1)
                u = (o + 1) / 2 * count
                for wave in range(1, 4):
                    laps = 1 + int(2 * wave * _hash(number, 10 + wave))
                    u += WANDER / wave * np.sin(2 * np.pi * (laps * lap + _hash(number, 20 + wave)))
                u += phase
                k = int(np.floor(u))
                lane = k
            q = 2 * (u - k) - 1
            ridge = -q / np.sqrt(ROUNDNESS - q * q)
            side = 1.0 if along[kind] == 0 else -1.0
            dx[row, column] += ridge * np.sin(run[row, column]) * side
            dy[row, column] -= ridge * np.cos(run[row, column]) * side
            tone = (_hash(number, 100 + lane) + _hash(number, 1000 + lane) - 1.0) * 2.45 * TONES
            bright[row, column] = (1 - CREASE * q**6) * (1 + tone)
