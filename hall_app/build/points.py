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
STANDING = 2.0  # [s] that a motion which does not repeat is stood in its first pose before it begins
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
) -> TrackedMotion:
    """Writes motion.points beside the clip of the same frames.

    poses: a frame each; moved: of each garment its vertices (T, V, 3) [m], without the base's height, on which the
    model stands. Raises what `track` raises.
    """
    from sim_core.garment.levels import BASE
    from sim_core.track import TrackSettings, track

    recording, settings = sensed(wearer, poses, rate=rate, loop=loop), TrackSettings()
    tracked = track(recording, settings)
    count, up = len(poses), np.array([0.0, BASE[1], 0.0])
    points, skeleton = tracked.feature_points, recording.skeleton
    worn, cloth = _bound(tracked, moved)
    limbs = limb_bones(tracked)
    written = TrackedMotion(
        points=tracked.points[-count:] + up,
        torso=points.torso,
        bones=skeleton.bones,
        worn=worn,
        cloth=cloth + up,
        limbs=limbs,
        m=tracked.m[-count:, limbs],
        delta=tracked.delta[-count:, limbs],
        lost=tracked.lost[-count:],
        noise=NOISE,
        m0=settings.m0,
        rounds=settings.iterations,
        rate=rate,
        loop=loop,
    )
    written.save(folder / tracked_beside(MOTION.removeprefix(BAKED)))
    return written


def sensed(wearer: Mannequin, poses: Sequence[Pose], *, rate: float, loop: bool) -> Recording:
    """What a sensor sees of the wearer, the poses last: a loop in rounds, BEFORE of them ahead of the last, else the
    motion after a while of standing. Its noise is the same in every round, so that what is tracked closes as well."""
    from sim_core.track import KINECT, Disturbance, Recording, load_mapping

    seen = [wearer.landmarks(pose) for pose in poses]
    names = list(seen[0])
    places = np.array([[one[name] for name in names] for one in seen])
    truth = load_mapping("figure").applied(names, places, np.arange(len(poses)) / rate, 1.0).joints
    if not loop:
        truth = np.concatenate([np.repeat(truth[:1], round(STANDING * rate), axis=0), truth])
    joints = Disturbance(noise=NOISE, seed=SEED).of(truth)
    rounds = (BEFORE + 1 if loop else 1, 1, 1)
    joints, truth = np.tile(joints, rounds), np.tile(truth, rounds)
    return Recording(KINECT, np.arange(len(joints)) / rate, joints, truth)


def limb_bones(tracked: Tracked) -> np.ndarray:
    """Numbers of the bones that are the limbs', and are there: those of fingers a figure without them lacks."""
    skeleton = tracked.calibration.skeleton
    trunk = np.isin(skeleton.bones, skeleton.torso).all(1)
    return np.flatnonzero(~trunk & (tracked.calibration.lengths > 0.0))


def _bound(tracked: Tracked, moved: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Numbers (Q,) of the feature points that have cloth within REACH, and the vertices (T, Q, 3) [m] that they are
    bound to: in the first frame one to one, as near as they may be together; the cloth carries them on. Points of
    bones that a figure lacks lie where others do, and have none."""
    from scipy.optimize import linear_sum_assignment
    from scipy.spatial import KDTree

    frames = np.concatenate([np.asarray(x, float) for x in moved.values()], axis=1)
    assert tracked.truth is not None
    bone = tracked.feature_points.bone
    there = np.flatnonzero((bone < 0) | (tracked.calibration.lengths[bone] > 0.0))
    first = tracked.truth[-len(frames), there]
    found, near = KDTree(frames[0]).query(first, k=min(NEAREST, frames.shape[1]), distance_upper_bound=REACH)
    some = np.unique(np.asarray(near)[np.isfinite(found)])
    if not len(some):
        return np.zeros(0, np.int64), np.zeros((len(frames), 0, 3))
    apart = np.linalg.norm(first[:, None] - frames[0, some], axis=2)
    point, vertex = linear_sum_assignment(np.where(apart <= REACH, apart, 1e3))
    kept = apart[point, vertex] <= REACH
    return there[np.asarray(point)[kept]], frames[:, some[np.asarray(vertex)[kept]]]
