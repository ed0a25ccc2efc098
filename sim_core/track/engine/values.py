"""What the engine works with: who is followed, what goes on from frame to frame, what a frame gives; constants."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

__all__ = [
    "FAR",
    "FASTEST",
    "HABIT",
    "HALF",
    "KALMAN",
    "NEAR",
    "NONE",
    "ONE_EURO",
    "TINY",
    "Body",
    "Frame",
    "Rules",
    "State",
]

NONE, KALMAN, ONE_EURO = 0, 1, 2
NEAR = 0.02  # [m] that a joint may always be off: five of them are no outlier
HABIT = 3.0  # [s] over which it is learnt where a joint mostly is
FAR = 0.05  # [m] of the trust in a place that nothing was seen of, for filters that keep none themselves
TINY = 1e-12
FASTEST = 2.5  # [m/s] a joint that was just taken up may be moving at
HALF = math.sqrt(0.5)  # the cosine of half a right angle: a quaternion's product for a turn of 90 degrees


class Body(NamedTuple):
    """Who is followed, as calibrated. bones (B, 2) parent and child, outwards; ends (B, 2): the same with joints that
    lie in one place taken for one, whose number each has in `one` (J,); lengths (B,) [m]; directions (B, 3) of
    the bones at rest, in the trunk's frame; torso (K,) joints; template (K, 3) [m] their places at rest about their
    mean; looseness (K,) [m2]: how much each moves within the trunk, a variance an axis; incidence (J, B): -1 at a
    bone's first end, +1 at the other; paths (J, B): 1 for the bones that lead from the root to a joint;
    recall (J,) [s]: in which an unseen joint comes to where it mostly is."""

    bones: np.ndarray
    ends: np.ndarray
    one: np.ndarray
    lengths: np.ndarray
    directions: np.ndarray
    torso: np.ndarray
    template: np.ndarray
    looseness: np.ndarray
    incidence: np.ndarray
    paths: np.ndarray
    recall: np.ndarray


class State(NamedTuple):
    """What goes on from frame to frame, changed in place. place, speed (J, 3) [m], [m/s] of the filter; spread (J, 3):
    its variances of place, both and speed; misses (J,): rejected in a row; bound (J,) [m2]: the variance that the gate
    went by before; gone (J,) [s]: not seen for so long; habit (J, 3) [m]: where a joint mostly is, in the trunk's
    frame; tracked (J, 3) [m] after the last frame;
    turns (B, 4): rotations of the bones from rest, quaternions with the real part first; trunk (3, 3) the trunk's."""

    place: np.ndarray
    speed: np.ndarray
    spread: np.ndarray
    misses: np.ndarray
    bound: np.ndarray
    gone: np.ndarray
    habit: np.ndarray
    tracked: np.ndarray
    turns: np.ndarray
    trunk: np.ndarray


class Rules(NamedTuple):
    """What a filter and the local step go by; see `TrackSettings`, where each is told with its unit."""

    kind: int
    noise: float
    agility: float
    gate: float
    patience: int
    coasting: float
    cutoff: float
    cutoff_slope: float
    m0: float
    floor: float
    iterations: int
    prior: float
    untwist: float


class Frame(NamedTuple):
    """What a frame gave. joints (J, 3) [m]; seen (J,) bool: measured and accepted; again (J,) bool: taken up anew;
    turns (B, 4); trunk (3, 3); shift (3,) [m]: A = R B + T with B about its mean; m, delta (B,) [1], [m];
    residual (J,) [m] between tracked and filtered joints; iterations; flips."""

    joints: np.ndarray
    seen: np.ndarray
    again: np.ndarray
    turns: np.ndarray
    trunk: np.ndarray
    shift: np.ndarray
    m: np.ndarray
    delta: np.ndarray
    residual: np.ndarray
    iterations: int
    flips: int
