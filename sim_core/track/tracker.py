"""Following a person: one frame after the other as they come, or a whole recording, with the same bits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.track.calibration import Calibration, calibrate
from sim_core.track.engine import FASTEST, KALMAN, Frame, State, compiled_step, frame_step
from sim_core.track.feature_points import FeaturePoints, feature_points
from sim_core.track.recording import Recording
from sim_core.track.settings import TrackSettings
from sim_core.track.skeletons import KINECT, TrackedSkeleton
from sim_core.validation import FURTHEST, numeric_array

__all__ = ["Tracked", "TrackedFrame", "Tracker", "track"]

FIRST_STEP = 1.0 / 30.0  # [s] until the clock has told one
LONGEST_STEP = 0.5  # [s]: after a longer gap every joint is taken up anew
UNSEEN = 0.5  # [m] that a joint may be off that was not seen yet
SLACK = 0.02  # [m] that a bone may be off besides its noise
FRESH = 3  # frames at the start in which bones tell outliers, as nothing else can yet
AHEAD = 0.5  # of the joints that have a twin must look swapped
MOST_POINTS = 50_000_000  # of all frames of a recording: 1.2 GB, and the truth as much


@dataclass(frozen=True)
class TrackedFrame:
    """One frame followed: time [s], the tracker's own clock; joints (J, 3), points (P, 3) [m]; lost (P,) bool: not
    seen in this frame, where they are is no more than expected; rotations (B, 4) of the bones from rest (quaternions,
    real part first), trunk (3, 3) and shift (3,) of A = R B + T; m, delta (B,) of Eq. 16-17 ([m]); residual (J,) [m]
    to the filtered joint; iterations; flips: rotations by more than 90 degrees since the last frame; reacquired (J,)
    bool; swapped: left and right came exchanged and were put back; clock: the time was no later than the last.
    """

    time: float
    joints: np.ndarray
    points: np.ndarray
    lost: np.ndarray
    rotations: np.ndarray
    trunk: np.ndarray
    shift: np.ndarray
    m: np.ndarray
    delta: np.ndarray
    residual: np.ndarray
    iterations: int
    flips: int
    reacquired: np.ndarray
    swapped: bool
    clock: bool


@dataclass(frozen=True)
class Tracked:
    """A recording followed: the arrays of `TrackedFrame`, frame by frame (T, ...), and truth (T, P, 3) [m] of the
    points where it is known (NaN where not, None: nowhere)."""

    calibration: Calibration
    feature_points: FeaturePoints
    time: np.ndarray
    joints: np.ndarray
    points: np.ndarray
    truth: np.ndarray | None
    lost: np.ndarray
    rotations: np.ndarray
    trunk: np.ndarray
    shift: np.ndarray
    m: np.ndarray
    delta: np.ndarray
    residual: np.ndarray
    iterations: np.ndarray
    flips: np.ndarray
    reacquired: np.ndarray
    swapped: np.ndarray
    clock: np.ndarray

    def bone_error(self) -> float:
        """The greatest difference [m] between a tracked bone and its length."""
        bones = self.calibration.skeleton.bones
        found = np.linalg.norm(self.joints[:, bones[:, 1]] - self.joints[:, bones[:, 0]], axis=2)
        return float(np.abs(found - self.calibration.lengths).max())

    def errors(self) -> np.ndarray:
        """Distances (T, P) [m] of the points from the truth, NaN where that is not known."""
        if self.truth is None:
            return np.full(self.points.shape[:2], np.nan)
        return np.linalg.norm(self.points - self.truth, axis=2)


class Tracker:
    """Follows one person, frame after frame.

    calibration: of this person, by `calibrate` on some seconds of them; None: the first frame with any joint of the
    trunk, which is only as good as that frame. Frames of a sensor may lack joints (NaN), come late or twice.
    """

    def __init__(
        self,
        calibration: Calibration | None = None,
        settings: TrackSettings | None = None,
        skeleton: TrackedSkeleton = KINECT,
    ) -> None:
        self.settings = settings or TrackSettings()
        self.calibration = calibration
        self.skeleton = calibration.skeleton if calibration is not None else skeleton
        self.feature_points = feature_points(self.skeleton, self.settings.level)
        self._rules = self.settings.rules(None)
        self._frame = compiled_step() if self.settings.compiled else frame_step
        self._twins = _twins(self.skeleton)
        self._state: State | None = None
        self._time = self._wall = 0.0
        self._step = FIRST_STEP
        self._fresh = 0

    def update(self, joints: np.ndarray, time: float) -> TrackedFrame:
        """Follows the next frame: joints (J, 3) [m], y up, NaN (or anything not finite) where one was not seen; time
        [s]. A time that is not later than the last one is reported, and the last step taken instead.

        Raises SimCoreError for another shape, and where the first frame shows nothing of the trunk.
        """
        given = np.array(numeric_array("joints", joints, "joints (J, 3) [m]"), float)
        if given.shape != (len(self.skeleton.joints), 3):
            raise SimCoreError(
                f"joints: shape {given.shape} – ({len(self.skeleton.joints)}, 3) is meant, of the {self.skeleton.name}"
            )
        measured = np.asarray((np.abs(given) < FURTHEST).all(1))  # NaN is not
        given[~measured] = 0.0
        begin = self._state is None
        step, late, gap = self._clocked(float(time), begin)
        if begin:
            self._calibrated(given, measured)
        self._fresh = FRESH if begin or gap else self._fresh - 1
        if self._fresh > 0 and self._rules.kind == KALMAN:
            measured = measured & ~self._implausible(given, measured)
        if begin:
            self._begin(given, measured)
        state = self._state
        assert state is not None
        swapped = self._rules.kind == KALMAN and not begin and self._put_back(given, measured, step)
        taken = measured & gap
        if gap:  # nothing that was known says where anyone is now
            self._restart(state, given, measured)
        found: Frame = self._frame(self._body, state, self._rules, given, measured, step)
        return TrackedFrame(
            self._time,
            found.joints,
            self.feature_points.of(found.joints),
            self.feature_points.unseen(found.seen),
            found.turns,
            found.trunk,
            found.shift,
            found.m,
            found.delta,
            found.residual,
            int(found.iterations),
            0 if begin else int(found.flips),
            found.again | taken,
            bool(swapped),
            late,
        )

    def _clocked(self, time: float, begin: bool) -> tuple[float, bool, bool]:
        """The step [s] to this frame, whether the clock stood or ran back, and whether it leapt."""
        if begin:
            self._time = self._wall = time if np.isfinite(time) else 0.0
            return self._step, not np.isfinite(time), False
        step = time - self._wall
        if not np.isfinite(step) or step <= 0.0:
            self._wall = time if np.isfinite(time) else self._wall
            self._time += self._step
            return self._step, True, False
        self._wall = time
        self._time += step
        if step > LONGEST_STEP:
            return self._step, False, True
        self._step = step
        return step, False, False

    def _calibrated(self, given: np.ndarray, measured: np.ndarray) -> None:
        """Knows who is followed, by the first frame if by nothing else."""
        if self.calibration is None:
            seen = np.where(measured[:, None], given, np.nan)
            self.calibration = calibrate(self.skeleton, seen[None])
        self._body = self.calibration.body()
        self._rules = self.settings.rules(self.calibration.noise)

    def _begin(self, given: np.ndarray, measured: np.ndarray) -> None:
        """Stands where the first frame shows the person, at rest where it shows nothing."""
        assert self.calibration is not None
        count, bones = len(self.skeleton.joints), len(self.skeleton.bones)
        turns = np.zeros((bones, 4))
        turns[:, 0] = 1.0
        place = self.calibration.rest.copy()
        state = State(
            place,
            np.zeros((count, 3)),
            np.zeros((count, 3)),
            np.zeros(count, np.int64),
            np.zeros(count),
            np.zeros(count),
            self.calibration.habit.copy(),
            place.copy(),
            turns,
            np.eye(3),
        )
        self._restart(state, given, measured)
        self._state = state

    def _restart(self, state: State, given: np.ndarray, measured: np.ndarray) -> None:
        """Forgets where joints were and how they moved; those that are not seen go along with those that are."""
        if measured.any():
            state.place[:] += (given - state.place)[measured].mean(0)
            state.place[measured] = given[measured]
        state.tracked[:] = state.place
        state.speed[:] = 0.0
        noise = self._rules.noise
        state.spread[:] = (noise**2, 0.0, FASTEST**2)
        state.spread[~measured, 0] = UNSEEN**2
        state.misses[:] = 0

    def _implausible(self, given: np.ndarray, measured: np.ndarray) -> np.ndarray:
        """Joints (J,) bool whose bones are not as long as they are: outliers where nothing else tells them yet."""
        bones, rules = self.skeleton.bones, self._rules
        found = np.linalg.norm(given[bones[:, 1]] - given[bones[:, 0]], axis=1)
        excess = np.abs(found - self._body.lengths)
        wrong = excess > SLACK + 4.0 * np.sqrt(2.0) * rules.noise
        doubted = np.zeros(len(given), bool)
        while True:
            both = (measured & ~doubted)[bones].all(1)
            told = wrong & both
            if not told.any():
                return doubted
            count = np.bincount(bones[both].ravel(), minlength=len(given))
            mean = np.bincount(bones[both].ravel(), np.repeat(excess[both], 2), len(given)) / np.maximum(
                count, 1
            )
            mean[np.setdiff1d(np.arange(len(given)), bones[told])] = 0.0
            doubted[int(np.argmax(mean))] = True

    def _put_back(self, given: np.ndarray, measured: np.ndarray, step: float) -> bool:
        """Exchanges left and right again where a sensor took one for the other; whether it did."""
        state, rules = self._state, self._rules
        assert state is not None
        twins = self._twins
        other = given[twins]
        both = measured & measured[twins] & (twins != np.arange(len(twins)))
        if both.sum() < 4:
            return False
        ahead = state.place + step * state.speed
        bound = rules.gate**2 * (state.spread[:, 0] + rules.agility * step**3 / 3.0 + rules.noise**2)
        off, crossed = ((given - ahead) ** 2).sum(1), ((other - ahead) ** 2).sum(1)
        fits = both & (off <= bound)
        if fits.sum() > (1.0 - AHEAD) * both.sum() or (both & (crossed <= bound)).sum() < 0.8 * both.sum():
            return False
        given[both] = other[both]
        return True


def _twins(skeleton: TrackedSkeleton) -> np.ndarray:
    """The number (J,) of each joint's twin on the other side, its own in the middle."""

    def other(name: str) -> str:
        for one, two in (("Left", "Right"), ("Right", "Left")):
            if one in name:
                return name.replace(one, two)
        for one, two in (("_l", "_r"), ("_r", "_l")):
            if name.endswith(one):
                return name[: -len(one)] + two
        return name

    return np.array([skeleton.joints.index(other(name)) for name in skeleton.joints])


def track(
    recording: Recording, settings: TrackSettings | None = None, calibration: Calibration | None = None
) -> Tracked:
    """Follows a whole recording, frame by frame as `Tracker.update` does.

    calibration: of the person; None: by the recording itself. Raises SimCoreError as `calibrate` and `update` do, and
    for more than MOST_POINTS points in all.
    """
    settings = settings or TrackSettings()
    if calibration is None:
        calibration = calibrate(recording.skeleton, recording.joints, recording.step)
    tracker = Tracker(calibration, settings)
    count = len(tracker.feature_points.matrix)
    if len(recording.time) * count > MOST_POINTS:
        raise SimCoreError(
            f"level: {settings.level}, {len(recording.time)} frames of {count} points – take a lower level, "
            "or cut the motion into parts"
        )
    frames = [
        tracker.update(joints, float(time))
        for joints, time in zip(recording.joints, recording.time, strict=True)
    ]
    points = tracker.feature_points
    truth = None if recording.truth is None else points.of(recording.truth)
    return Tracked(
        calibration,
        points,
        truth=truth,
        **{
            name: np.array([getattr(one, name) for one in frames])
            for name in TrackedFrame.__dataclass_fields__
        },
    )
