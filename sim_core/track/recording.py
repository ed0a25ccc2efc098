"""A motion as it was recorded: joints of a skeleton over time, as readers hand it on."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.track.disturbance import Disturbance
from sim_core.track.skeletons import TrackedSkeleton
from sim_core.validation import FURTHEST, numeric_array

__all__ = ["MOST_FRAMES", "Recording"]

MOST_FRAMES = 200_000
"""Frames of a recording: half an hour at 120 a second."""


@dataclass(frozen=True)
class Recording:
    """time (T,) [s]; joints (T, J, 3) [m], y up, NaN where one was not seen; truth (T, J, 3) [m] where the joints are
    known otherwise, as of a motion file by its own kinematics, NaN where not, None: nothing is known.

    left_out: joints of the skeleton that the source does not have; they lie at the joint that they hang on. told: what
    else a reader has to say. Raises SimCoreError where shapes differ, a number is beyond a million, and for more than
    MOST_FRAMES.
    """

    skeleton: TrackedSkeleton
    time: np.ndarray
    joints: np.ndarray
    truth: np.ndarray | None = None
    left_out: tuple[str, ...] = ()
    told: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Checks shapes and reach."""
        time = numeric_array("time", self.time, "seconds (T,)")
        joints = numeric_array("joints", self.joints, "joints (T, J, 3) [m]")
        wanted = (len(time) if time.ndim == 1 else 0, len(self.skeleton.joints), 3)
        if time.ndim != 1 or not len(time):
            raise SimCoreError(f"time: shape {time.shape} – seconds (T,) are meant, one frame or more")
        if len(time) > MOST_FRAMES:
            raise SimCoreError(f"time: {len(time)} frames – at most {MOST_FRAMES}; cut the motion into parts")
        for name, array in (("joints", joints), ("truth", joints if self.truth is None else self.truth)):
            if array.shape != wanted:
                raise SimCoreError(
                    f"{name}: shape {array.shape} – {wanted} is meant, of the {self.skeleton.name}"
                )
            if (np.abs(array[np.isfinite(array)]) > FURTHEST).any():
                raise SimCoreError(
                    f"{name}: beyond {FURTHEST:g} m – metres are meant; give the unit of the file"
                )

    def disturbed(self, disturbance: Disturbance) -> Recording:
        """As a worse sensor would have recorded it, every joint by itself."""
        return replace(self, joints=disturbance.of(self.joints))

    @property
    def step(self) -> float:
        """Seconds from frame to frame, the median; of a clock that tells none: a thirtieth."""
        steps = np.diff(self.time[np.isfinite(self.time)])
        steps = steps[steps > 0.0]
        return float(np.median(steps)) if len(steps) else 1.0 / 30.0
