"""Height-field rasteriser of flattened yarn tubes, supersampled, over any window of the endless periodic cloth.

A yarn's section depends only on the place along it, so all sections are worked out once per sample row (warp) and
sample column (weft); a sample then only asks the few yarns that may lie over it how high they are there.
"""

from math import floor, sqrt

import numpy as np
from numba import njit

from sim_core.weave.lines import YarnSystem

__all__ = ["CHANNELS", "rasterise"]

CHANNELS = 8  # linear red, green, blue, normal x, y, z (all weighted by cover), height, cover
GAP = -1.0e9
PROFILE = 512  # steps of the section's profile from its middle to its edge
FIBRE_TILT = 1.0  # slope of the surface per relative shade of a fibre streak, so that streaks also glint
FLANK = 0.12  # the section is vertical at its edge; its slope is cut off here


def rasterise(
    warp: YarnSystem, weft: YarnSystem, origin, pixel, shape, samples: int, low: float, high: float
):
    """Render a window of the cloth, x along the weft, y along the warp (down the picture).

    origin: (row, column) of the first pixel, may be negative: the cloth has no end.  pixel: (height, width) [m].
    shape: (rows, columns).  samples: per pixel and direction.  low, high: [m] heights of the deepest and the highest
    point, between which the yarns darken with depth.  Returns (rows, columns, CHANNELS) float64.
    """
    y, x = (
        (origin[axis] + (np.arange(shape[axis] * samples) + 0.5) / samples) * pixel[axis] for axis in range(2)
    )
    return _cover(
        *(x, y, samples, low, high),
        *(_sections(warp, y), _profile(warp), warp.streak, warp.across, warp.colour),
        *(_sections(weft, x), _profile(weft), weft.streak, weft.across, weft.colour),
    )


def _sections(system: YarnSystem, along: np.ndarray) -> np.ndarray:
    """Every yarn's section at every place: (places, yarns, 6) wander, half width, axis z, half height, slope, twist."""
    count, table = system.swell.shape
    crossings = system.height.shape[1]
    knot = np.floor(along / system.along)
    t = along / system.along - knot
    k0 = knot.astype(int) % crossings
    k1 = (k0 + 1) % crossings
    z0, z1, m0, m1 = (
        a[:, k] for a, k in zip((system.height,) * 2 + (system.slope,) * 2, (k0, k1) * 2, strict=True)
    )
    axis = z0 + (z1 - z0) * t * t * (3 - 2 * t) + m0 * t * (1 - t) ** 2 - m1 * t * t * (1 - t)
    slope = ((z1 - z0) * 6 * t * (1 - t) + m0 * (1 - t) * (1 - 3 * t) - m1 * t * (2 - 3 * t)) / system.along
    lap = along / system.length - np.floor(along / system.length)
    s0 = np.minimum((lap * table).astype(int), table - 1)
    part = lap * table - s0
    swell, wander = (
        a[:, s0] * (1 - part) + a[:, (s0 + 1) % table] * part for a in (system.swell, system.wander)
    )
    lines = np.arange(count) % len(system.height)
    axis, slope = axis[lines], slope[lines]
    tall = system.half_height * swell * np.sqrt(1 + slope**2)  # the envelope of a sloping tube is taller
    twist = np.broadcast_to(system.turns * lap, axis.shape)
    values = np.stack([wander, system.half_width * swell, axis, tall, slope, twist])
    return np.ascontiguousarray(values.transpose(2, 1, 0))


def _profile(system: YarnSystem) -> np.ndarray:
    """(PROFILE + 1, 3) height, its derivative and the angle round the yarn (in turns) from the middle to the edge.

    A superellipse between ellipse and racetrack, flatter the more the yarn is pressed; smooth, so that light glides.
    """
    offset = np.linspace(0, 1, PROFILE + 1)
    power = 1 + min(system.half_width / system.half_height, 3.0)
    height = np.sqrt(np.maximum(1 - offset**power, 0))
    derivative = power / 2 * offset ** (power - 1) / np.maximum(height, FLANK)
    return np.column_stack([height, derivative, np.arcsin(offset) / (2 * np.pi)])


@njit(cache=True)
def _top(u, place, sections, profile, streak, across):
    """The highest yarn of one system at u [m] across it: (z, dz/du, dz/dv, shade); z = GAP where there is none."""
    count, streaks = streak.shape
    nearest = int(floor(u / across + 0.5))
    best, best_du, best_dv, shade = GAP, 0.0, 0.0, 0.0
    for line in range(nearest - 1, nearest + 2):
        yarn = line % count
        half = sections[place, yarn, 1]
        offset = (u - line * across - sections[place, yarn, 0]) / half
        if offset <= -1 or offset >= 1:
            continue
        sign = 1 if offset > 0 else -1
        step = int(offset * sign * PROFILE + 0.5)
        z = sections[place, yarn, 2] + sections[place, yarn, 3] * profile[step, 0]
        if z > best:
            turn = sign * profile[step, 2] + sections[place, yarn, 5]
            shade = streak[yarn, int(floor(turn * streaks)) % streaks]
            steep = sections[place, yarn, 3] / half * profile[step, 1]
            best, best_du, best_dv = z, FIBRE_TILT * (shade - 1) - sign * steep, sections[place, yarn, 4]
    return best, best_du, best_dv, shade


@njit(cache=True)
def _cover(
    x, y, samples, low, high,
    warp_sections, warp_profile, warp_streak, warp_across, warp_colour,
    weft_sections, weft_profile, weft_streak, weft_across, weft_colour,
):  # fmt: skip
    """Sum the samples of every pixel; x: (columns * samples,), y: (rows * samples,) places [m]."""
    picture = np.zeros((y.size // samples, x.size // samples, CHANNELS))
    share = 1.0 / (samples * samples)
    for i in range(y.size):
        row = i // samples
        for j in range(x.size):
            column = j // samples
            z, dx, dy, shade = _top(x[j], i, warp_sections, warp_profile, warp_streak, warp_across)
            z2, dy2, dx2, shade2 = _top(y[i], j, weft_sections, weft_profile, weft_streak, weft_across)
            on_top = z2 > z
            if on_top:
                z, dx, dy, shade = z2, dx2, dy2, shade2
            if z == GAP:
                picture[row, column, 6] += low * share
                continue
            depth = min(max((z - low) / (high - low), 0.0), 1.0)
            light = shade * (0.62 + 0.38 * sqrt(depth)) * share
            upright = share / sqrt(1 + dx * dx + dy * dy)
            for channel in range(3):
                picture[row, column, channel] += light * (
                    weft_colour[channel] if on_top else warp_colour[channel]
                )
            picture[row, column, 3] -= dx * upright
            picture[row, column, 4] += dy * upright  # rows run down, the normal's y runs up
            picture[row, column, 5] += upright
            picture[row, column, 6] += z * share
            picture[row, column, 7] += share
    return picture
