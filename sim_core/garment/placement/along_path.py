"""How a scarf is held before it is let go on a figure: an accordion section swept along a path past its arms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.optimize import least_squares

from sim_core.cloth.contact import DistanceField
from sim_core.errors import SimCoreError
from sim_core.garment.pattern import Cloth, Pattern
from sim_core.garment.placement.ground import Ground
from sim_core.garment.placement.path_search import cleared_line

__all__ = ["Accordion", "AlongPath", "Knot", "arranged_path", "swept"]

STEP = 0.005  # [m] between stations of the path
TWIST = 0.5  # strain by twist counts that much of one by a bend over the edge: it is second order


@dataclass(frozen=True)
class Knot:
    """A point of the path: the mean of the landmarks `near`, and by (3,) [m] from there; room [m] the middle of the
    cloth keeps from what lies beneath."""

    near: tuple[str, ...]
    by: tuple[float, float, float] = (0.0, 0.0, 0.0)
    room: float = 0.05


@dataclass(frozen=True)
class AlongPath:
    """A strip swept along a line through knots, the first in the mirror plane; beyond the last it hangs straight down.

    x of the pattern runs along the line from the middle, y across. along: two landmarks, the strip's width lies
    along the way from the first to the second where the line is highest; stations: width [m] at distances [m] from
    there; begin, end [m]: width at the strip's middle and end; waves: folds across the width.
    """

    knots: tuple[Knot, ...]
    along: tuple[str, str] = ("elbow_l", "wrist_l")
    stations: tuple[tuple[float, float], ...] = ()
    begin: float = 0.22
    end: float = 0.24
    waves: float = 5.0

    halves = True  # `start` takes the left half of a mirrored pattern

    def hanging(self, cloth: Cloth) -> float:
        """The longest free length [m]."""
        return float(np.ptp(cloth.vertices[:, 0])) / 2

    def start(self, pattern: Pattern, cloth: Cloth, ground: Ground, rng: np.random.Generator) -> np.ndarray:
        """Positions (P, 3) [m] of the pattern vertices, of a mirrored pattern those of its left half.

        Raises SimCoreError where a landmark is not known, knots are out of reach or lead nowhere, the strip is short.
        """
        length = float(np.ptp(cloth.vertices[:, 0]))
        points = np.array(
            [np.mean([ground.mark(name) for name in k.near], axis=0) + k.by for k in self.knots]
        )
        direction = ground.mark(self.along[1]) - ground.mark(self.along[0])
        if not np.linalg.norm(direction) > STEP:
            raise SimCoreError(f"place.along: {' and '.join(self.along)} are one place – name two landmarks")
        reach = np.linalg.norm(points - points[0], axis=1).max()
        if reach > length:
            raise SimCoreError(
                f"place.knot: the knots lie up to {reach:.2f} m from the first, half the strip is {length:.2f} m "
                "long – bring them nearer"
            )
        room = np.array([knot.room for knot in self.knots])
        path = arranged_path(points, ground.distance, room, length)
        top = float(np.argmax(path[:, 1])) * STEP
        if top == 0.0:
            raise SimCoreError(
                "place.knot: the strip is highest at its middle – lead it over a shoulder or an arm"
            )
        stations = (0.0, *(top + away for away, _ in self.stations), length)
        widths = (self.begin, *(width for _, width in self.stations), self.end)
        return swept(cloth.vertices, path, direction, Accordion(stations, widths, self.waves), rng)


@dataclass(frozen=True)
class Accordion:
    """The section's extent [m] at stations of arc length [m] from the middle; waves: folds across the width.

    spread: relative variation of the folds' widths.
    """

    stations: tuple[float, ...]
    extents: tuple[float, ...]
    waves: float = 3.0
    spread: float = 0.25

    def extent(self, s: np.ndarray) -> np.ndarray:
        """Gathered width [m] at arc lengths s."""
        return np.interp(s, self.stations, self.extents)


def arranged_path(
    knots: np.ndarray, field: DistanceField, room: np.ndarray, length: float, rounds: int = 400
) -> np.ndarray:
    """A smooth line (N, 3) through the neighbourhood of knots (K, 3) [m], N stations STEP apart, `length` [m] long.

    It starts in the mirror plane at the first knot, and keeps room (K,) [m], interpolated, to the field's solid: it
    goes past the knots by the cheapest way through free space, and like a rope it is drawn straight and pushed out by
    turns. Beyond the last knot it hangs straight down.
    """
    line, clear = _resampled(*cleared_line(knots, room, field))
    for _ in range(rounds):
        value, gradient = field.with_gradient(line)
        size = np.maximum(np.linalg.norm(gradient, axis=1, keepdims=True), 0.3)
        line = line + 0.5 * np.maximum(clear - value, 0.0)[:, None] * gradient / size
        straight = np.zeros_like(line)
        straight[1:-1] = 0.5 * (line[:-2] + line[2:]) - line[1:-1]
        straight[0] = (line[1] - line[0]) * [0.0, 1.0, 1.0]
        line = line + 0.4 * straight
        line[0, 0] = 0.0
    line, _ = _resampled(line, clear)
    left = length - STEP * (len(line) - 1)
    if left < 0.05:
        raise SimCoreError(
            f"place: half a strip of {length:.2f} m does not reach round the arm – cut it {0.1 - left:.2f} m longer"
        )
    fall = line[-1] - np.arange(1, int(np.ceil(left / STEP)) + 2)[:, None] * [0.0, STEP, 0.0]
    return np.concatenate([line, fall])


def _resampled(line: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points STEP apart on a line (N, 3), and the values (N,) there."""
    s = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))]
    at = np.arange(0.0, s[-1], STEP)
    return np.stack([np.interp(at, s, line[:, c]) for c in range(3)], axis=1), np.interp(at, s, values)


def swept(
    rest: np.ndarray, path: np.ndarray, arm: np.ndarray, accordion: Accordion, rng: np.random.Generator
) -> np.ndarray:
    """Start positions (P, 3) of a strip rest (P, 2): x [m] along it from the middle, y across.

    Along the path (N, 3) the section's width turns from upright, at the middle, to lie along the forearm, whose
    direction is arm (3,), where the path is highest. Every section is as long as the cloth is wide.
    """
    width = float(np.ptp(rest[:, 1]))
    across = rest[:, 1] - rest[:, 1].min()
    along = rest[:, 0]
    s = STEP * np.arange(len(path))
    _, lateral, outward = _frames(path, arm, int(np.argmax(path[:, 1])), accordion.extent(s))
    phase, lean = rng.uniform(0, 2 * np.pi), rng.uniform(0, 2 * np.pi)
    sections = [_section(float(e), width, accordion, phase, lean) for e in accordion.extent(s)]
    place = np.clip(along / STEP, 0, len(path) - 1.001)
    low = place.astype(int)
    out = np.zeros((len(rest), 3))
    for k in np.unique(low):
        here = np.flatnonzero(low == k)
        b = (place[here] - k)[:, None]
        points = []
        for m in (k, k + 1):
            arc, side, off = sections[m]
            u, v = np.interp(across[here], arc, side), np.interp(across[here], arc, off)
            points.append(path[m] + u[:, None] * lateral[m] + v[:, None] * outward[m])
        out[here] = (1 - b) * points[0] + b * points[1]
    return out


def _frames(
    path: np.ndarray, arm: np.ndarray, top: int, extent: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tangent, lateral and outward unit vectors (N, 3): the width upright at the middle, along -`arm` from `top` on.

    Between them the width, extent (N,) [m], turns so that the strip bends over its flat side wherever it can: bent
    over its edge, or turned on the spot, its borders would be stretched and its folds pushed through each other.
    """
    tangent = np.gradient(path, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    tangent[0] = [1.0, 0.0, 0.0]
    first = _carried(tangent, np.array([0.0, 1.0, 0.0]))
    second = np.cross(tangent, first)
    bend = np.gradient(tangent, STEP, axis=0)
    toward = -arm / np.linalg.norm(arm)
    goal = np.unwrap(np.arctan2(second @ toward, first @ toward))
    half = 0.5 * extent

    def strains(turn: np.ndarray) -> np.ndarray:
        """What the borders are strained by, station by station, and how far the width is from where it shall be."""
        angle = np.r_[0.0, turn]
        lateral = np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second
        over_edge = half * (bend * lateral).sum(1)
        twist = 0.5 * (half[1:] + half[:-1]) * np.diff(angle) / STEP
        return np.r_[over_edge, TWIST * twist, 10.0 * (angle - goal)[top:]]

    t = np.clip(np.arange(len(path)) / top, 0, 1)
    guess = goal[top] * t * t * (3 - 2 * t)
    turn = np.r_[0.0, least_squares(strains, guess[1:], jac_sparsity=_sparsity(len(path), top)).x]
    lateral = np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * second
    return tangent, lateral, np.cross(tangent, lateral)


def _sparsity(count: int, top: int) -> sparse.csr_array:
    """Which residuals (R, N - 1) of `_frames` know which turns."""
    own = np.eye(count)
    return sparse.csr_array(np.concatenate([own, own[1:] + own[:-1], own[top:]])[:, 1:])


def _carried(tangent: np.ndarray, first: np.ndarray) -> np.ndarray:
    """A unit vector (N, 3) across tangents (N, 3) that turns about them nowhere, beginning with `first`."""
    out = np.zeros_like(tangent)
    for k in range(len(tangent)):
        first = first - (first @ tangent[k]) * tangent[k]
        first = first / np.linalg.norm(first)
        out[k] = first
    return out


def _section(
    extent: float, width: float, accordion: Accordion, phase: float, lean: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cloth coordinate 0..width, place across and offset of one section, a wave as long as the cloth is wide."""
    u = np.linspace(0, 1, 300)
    warp = u + accordion.spread * 0.5 / accordion.waves * np.sin(2 * np.pi * u + phase)
    shape = np.cos(2 * np.pi * accordion.waves * warp) * (1 + 0.25 * np.cos(2 * np.pi * u + lean))
    side = extent * (u - 0.5)

    def arc(amplitude: float) -> np.ndarray:
        return np.r_[0.0, np.cumsum(np.hypot(np.diff(side), amplitude * np.diff(shape)))]

    low, high = 0.0, width
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if arc(middle)[-1] < width else (low, middle)
    s = arc(low)
    return s * (width / s[-1]), side, low * shape
