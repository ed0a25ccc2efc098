"""Why an exhibit moves as it does: its wearer's feature points as they are tracked, with those of the garments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hall_app.content.files import BAKED, MOTION, tracked_beside
from hall_app.content.models.tracked import TrackedMotion

if TYPE_CHECKING:
    from sim_core.body import Mannequin, Pose
    from sim_core.track import Recording, Tracked

__all__ = ["limb_bones", "sensed", "write_points"]

NOISE, SEED = (
    0.010,
    23,
)  # [m] an axis of a depth camera's joints; a motion that was computed has none of its own
BEFORE = 2  # rounds of a loop until nothing is left of the filter's start: the next two agree to rounding
STANDING, GAP = (
    2.0,
    1.0,
)  # [s] of standing ahead of a motion; of the clock's leap after it, by which all is seen anew
REACH = 0.15  # [m] from a feature point to the cloth that goes with it; beyond, nothing is worn there
NEAREST = 64  # vertices that a point may be bound to, where nearer ones are others'


def write_points(
    wearer: Mannequin,
    poses: Sequence[Pose],
    moved: Mapping[str, np.ndarray],
    folder: Path,
    *,
    rate: float,
    loop: bool,
    begin: int = 0,
) -> TrackedMotion:
    """Writes motion.points beside the clip of the same frames.

    poses: a frame each; moved: of each garment its vertices (T, V, 3) [m], without the base's height, on which the
    model stands. begin: the frame that the clip begins with, 1 where the first is how the model stands. Raises what
    `track` raises.
    """
    from sim_core.garment.levels import BASE
    from sim_core.track import TrackSettings, track

    (recording, rows), settings = sensed(wearer, poses, rate=rate, loop=loop, begin=begin), TrackSettings()
    tracked = track(recording, settings)
    up, points = np.array([0.0, BASE[1], 0.0]), tracked.feature_points
    worn, cloth = _bound(tracked, rows[0], moved)
    limbs = limb_bones(tracked)
    written = TrackedMotion(
        points=tracked.points[rows] + up,
        torso=points.torso,
        bones=recording.skeleton.bones,
        worn=worn,
        cloth=cloth + up,
        limbs=limbs,
        m=tracked.m[rows][:, limbs],
        delta=tracked.delta[rows][:, limbs],
        lost=tracked.lost[rows],
        noise=NOISE,
        m0=settings.m0,
        rounds=settings.iterations,
        rate=rate,
        loop=loop,
        begin=begin,
    )
    written.save(folder / tracked_beside(MOTION.removeprefix(BAKED)))
    return written


def sensed(
    wearer: Mannequin, poses: Sequence[Pose], *, rate: float, loop: bool, begin: int = 0
) -> tuple[Recording, np.ndarray]:
    """What a sensor sees of the wearer, and the numbers (T,) of the frames of it that are the poses.

    First it stands for a while, as it does in the first pose; then, after a gap of the clock, a motion that begins
    with a later one. A loop goes round, BEFORE times ahead of the round that counts; its noise is the same in every
    round, so that what is tracked closes as well.
    """
    from sim_core.track import KINECT, Disturbance, Recording, load_mapping

    seen = [wearer.landmarks(pose) for pose in poses]
    names = list(seen[0])
    places = np.array([[one[name] for name in names] for one in seen])
    truth = load_mapping("figure").applied(names, places, np.arange(len(poses)) / rate, 1.0).joints
    standing = round(STANDING * rate)
    once = np.concatenate([np.repeat(truth[:1], standing, axis=0), truth[begin:]])
    noisy = Disturbance(noise=NOISE, seed=SEED).of(once)
    again = np.tile(np.arange(standing, len(once)), BEFORE + 1 if loop else 1)
    order = np.concatenate([np.arange(standing), again])
    time = np.arange(len(order)) / rate
    time[standing:] += GAP if begin else 0.0
    last = np.arange(len(order) - len(poses) + begin, len(order))
    rows = np.concatenate([np.full(begin, standing - 1), last])
    return Recording(KINECT, time, noisy[order], once[order]), rows


def limb_bones(tracked: Tracked) -> np.ndarray:
    """Numbers of the bones that are the limbs', and are there: those of fingers a figure without them lacks."""
    skeleton = tracked.calibration.skeleton
    trunk = np.isin(skeleton.bones, skeleton.torso).all(1)
    return np.flatnonzero(~trunk & (tracked.calibration.lengths > 0.0))


def _bound(tracked: Tracked, row: int, moved: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Numbers (Q,) of the feature points that have cloth within REACH, and the vertices (T, Q, 3) [m] that they are
    bound to: in the first frame, the row of what was tracked, one to one, as near as they may be together; the cloth
    carries them on. Points of bones that a figure lacks lie where others do, and have none."""
    from scipy.optimize import linear_sum_assignment
    from scipy.spatial import KDTree

    frames = np.concatenate([np.asarray(x, float) for x in moved.values()], axis=1)
    assert tracked.truth is not None
    bone = tracked.feature_points.bone
    there = np.flatnonzero((bone < 0) | (tracked.calibration.lengths[bone] > 0.0))
    first = tracked.truth[row, there]
    found, near = KDTree(frames[0]).query(first, k=min(NEAREST, frames.shape[1]), distance_upper_bound=REACH)
    some = np.unique(np.asarray(near)[np.isfinite(found)])
    if not len(some):
        return np.zeros(0, np.int64), np.zeros((len(frames), 0, 3))
    apart = np.linalg.norm(first[:, None] - frames[0, some], axis=2)
    point, vertex = linear_sum_assignment(np.where(apart <= REACH, apart, 1e3))
    kept = apart[point, vertex] <= REACH
    return there[np.asarray(point)[kept]], frames[:, some[np.asarray(vertex)[kept]]]
