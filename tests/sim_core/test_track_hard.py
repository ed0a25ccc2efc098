"""What sensors do: rest, leaps, exchanged sides, missing joints, clocks that stand; finite, reported, back in time."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from moving_people import person

from sim_core.errors import SimCoreError
from sim_core.track import (
    KINECT,
    Disturbance,
    Recording,
    Tracked,
    TrackedFrame,
    Tracker,
    TrackSettings,
    calibrate,
    figure_skeleton,
    read_recording,
    track,
)

FILTERS = ("none", "kalman", "one-euro")
LIMIT = 0.020  # [m] RMS of a frame, at 10 mm noise an axis


def recorded(kind: str, folder: Path, seconds: float = 4.0, rate: float = 30.0, seed: int = 0) -> Recording:
    path = folder / "clip.bvh"
    path.write_text(person(kind, seconds, rate, seed).bvh(), "utf-8")
    return read_recording(path)


def noisy(recording: Recording, seed: int = 0) -> Recording:
    return recording.disturbed(Disturbance(0.01, seed=seed))


def sound(tracked: Tracked) -> None:
    """Finite, with every bone at its length, and rotations that are some."""
    for name in TrackedFrame.__dataclass_fields__:
        assert np.isfinite(np.asarray(getattr(tracked, name), float)).all(), name
    assert tracked.bone_error() <= 1e-9
    assert np.abs(np.linalg.norm(tracked.rotations, axis=2) - 1.0).max() <= 1e-12
    assert np.abs(tracked.trunk @ tracked.trunk.swapaxes(1, 2) - np.eye(3)).max() <= 1e-12
    assert np.linalg.det(tracked.trunk).min() > 0.0


def frame_errors(tracked: Tracked) -> np.ndarray:
    """RMS (T,) [m] over the points."""
    return np.sqrt((tracked.errors() ** 2).mean(1))


@pytest.mark.parametrize("name", FILTERS)
@pytest.mark.parametrize("compiled", [False, True])
def test_frame_by_frame_and_at_once_give_the_same_bits(tmp_path: Path, name: str, compiled: bool) -> None:
    clip = recorded("dance", tmp_path).disturbed(Disturbance(0.01, 0.03, 0.02, seed=4))
    settings = TrackSettings(filter=name, compiled=compiled)
    whole = track(clip, settings)
    tracker = Tracker(calibrate(KINECT, clip.joints, clip.step), settings)
    for number, (joints, time) in enumerate(zip(clip.joints, clip.time, strict=True)):
        one = tracker.update(joints, float(time))
        for field in TrackedFrame.__dataclass_fields__:
            assert np.array_equal(getattr(one, field), getattr(whole, field)[number]), field
    again = track(clip, settings)
    assert np.array_equal(again.points, whole.points)
    sound(whole)


@pytest.mark.parametrize("name", FILTERS)
def test_compiled_and_numpy_agree_to_rounding(tmp_path: Path, name: str) -> None:
    clip = recorded("dance", tmp_path).disturbed(Disturbance(0.01, 0.03, 0.02, seed=5))
    fast, plain = (track(clip, TrackSettings(filter=name, compiled=compiled)) for compiled in (True, False))
    for field in TrackedFrame.__dataclass_fields__:
        one, other = (np.asarray(getattr(tracked, field), float) for tracked in (fast, plain))
        assert np.abs(one - other).max() <= 1e-9, field


def test_it_runs_without_numba() -> None:
    code = (
        "import sys; sys.modules['numba'] = None\n"
        "import numpy as np\n"
        "from sim_core.track import Tracker, TrackSettings\n"
        "found = Tracker().update(np.random.default_rng(0).normal(size=(25, 3)), 0.0)\n"
        "assert np.isfinite(found.points).all()\n"
        "assert not {'torch', 'scipy', 'matplotlib', 'trimesh'} & set(sys.modules), sorted(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=Path(__file__).parents[2])


@pytest.mark.parametrize("name", FILTERS)
@pytest.mark.parametrize("noise", [0.0, 0.0005, 0.01])
def test_a_body_at_rest_has_finite_m(tmp_path: Path, name: str, noise: float) -> None:
    clip = recorded("rest", tmp_path).disturbed(Disturbance(noise))
    tracked = track(clip, TrackSettings(filter=name))
    sound(tracked)
    assert tracked.m.max() <= (1.0 if noise < 0.001 else 20.0)
    assert tracked.flips.sum() == 0
    if noise == 0.0:
        assert tracked.m.max() <= 1e-9
        assert tracked.errors().max() <= 1e-9


def test_a_leap_is_told_and_followed_again(tmp_path: Path) -> None:
    clip = recorded("walk", tmp_path)
    leapt = clip.joints.copy()
    leapt[60:] += [3.0, 0.0, -2.0]
    tracked = track(noisy(Recording(KINECT, clip.time, leapt, leapt)))
    sound(tracked)
    again = np.flatnonzero(tracked.reacquired.any(1))
    assert 60 <= again.min() <= again.max() <= 63
    assert tracked.lost[60:62].all()
    errors = frame_errors(tracked)
    assert errors[:60].max() <= LIMIT
    assert errors[again.max() + 3 :].max() <= LIMIT


@pytest.mark.parametrize("frames", [2, 30])
def test_exchanged_sides_are_put_back_and_told(tmp_path: Path, frames: int) -> None:
    clip = recorded("walk", tmp_path)
    joints = noisy(clip).joints
    twins = [KINECT.joints.index(_other(name)) for name in KINECT.joints]
    joints[50 : 50 + frames] = joints[50 : 50 + frames][:, twins]
    tracked = track(
        Recording(KINECT, clip.time, joints, clip.truth), calibration=calibrate(KINECT, clip.joints)
    )
    sound(tracked)
    assert tracked.swapped[50 : 50 + frames].all()
    assert tracked.swapped.sum() == frames
    assert frame_errors(tracked).max() <= LIMIT
    plain = track(Recording(KINECT, clip.time, joints, clip.truth), TrackSettings(filter="none"))
    sound(plain)
    assert frame_errors(plain)[50 + frames + 3 :].max() <= 0.03
    assert plain.flips.sum() > 0  # a trunk that turns by half


def _other(name: str) -> str:
    if "Left" in name:
        return name.replace("Left", "Right")
    return name.replace("Right", "Left")


@pytest.mark.parametrize("name", FILTERS)
def test_missing_joints_are_lost_and_finite(tmp_path: Path, name: str) -> None:
    clip = recorded("turn", tmp_path)
    joints = noisy(clip).joints
    joints[20:30] = np.nan  # nobody
    joints[50:60, list(KINECT.torso)] = np.nan  # limbs alone
    joints[80, 3] = [np.inf, 0.0, 0.0]
    joints[90, 3, 1] = np.nan
    tracked = track(Recording(KINECT, clip.time, joints, clip.truth), TrackSettings(filter=name))
    sound(tracked)
    assert tracked.lost[20:30].all()
    assert tracked.lost[50:60][:, tracked.feature_points.torso].all()
    assert tracked.lost[[80, 90], 3].all()
    if name == "kalman":
        errors = frame_errors(tracked)
        assert errors[33:50].max() <= LIMIT
        assert errors[63:80].max() <= LIMIT


@pytest.mark.parametrize("name", FILTERS)
def test_clocks_that_stand_or_run_back_are_told(tmp_path: Path, name: str) -> None:
    clip = recorded("walk", tmp_path)
    time = clip.time.copy()
    time[40] = time[39]
    time[60:] -= 1.0
    time[80] = np.nan
    tracked = track(
        Recording(KINECT, time, noisy(clip).joints, clip.truth),
        TrackSettings(filter=name),
        calibrate(KINECT, clip.joints),
    )
    sound(tracked)
    assert set(np.flatnonzero(tracked.clock)) == {40, 60, 80}
    assert (np.diff(tracked.time) > 0.0).all()
    if name == "kalman":
        assert frame_errors(tracked).max() <= LIMIT
    still = track(Recording(KINECT, np.zeros(len(time)), clip.joints, clip.truth), TrackSettings(filter=name))
    sound(still)
    assert still.clock[1:].all()


def test_after_a_gap_everything_is_taken_up_anew(tmp_path: Path) -> None:
    clip = recorded("walk", tmp_path, seconds=6.0)
    kept = np.r_[0:60, 120:180]
    tracked = track(noisy(Recording(KINECT, clip.time[kept], clip.joints[kept], clip.joints[kept])))
    sound(tracked)
    assert tracked.reacquired[60].all()
    assert frame_errors(tracked).max() <= LIMIT


@pytest.mark.parametrize("name", FILTERS)
def test_a_clip_of_one_frame(tmp_path: Path, name: str) -> None:
    clip = recorded("walk", tmp_path, seconds=0.03)
    assert len(clip.time) == 1
    tracked = track(clip, TrackSettings(filter=name))
    sound(tracked)
    assert tracked.errors().max() <= 1e-9
    sound(track(noisy(clip), TrackSettings(filter=name)))


def test_bones_without_length_and_joints_in_one_place(tmp_path: Path) -> None:
    text = person("walk", 2.0).bvh()
    zero = text.replace("OFFSET -8.000000000 0.000000000 0.000000000", "OFFSET 0 0 0")  # of the right hand
    zero = zero.replace("OFFSET 0.000000000 12.000000000 0.000000000", "OFFSET 0 0 0")  # of the neck
    assert zero != text
    path = tmp_path / "zero.bvh"
    path.write_text(zero, "utf-8")
    clip = read_recording(path)
    for name in FILTERS:
        tracked = track(noisy(clip), TrackSettings(filter=name))
        sound(tracked)
        assert tracked.flips.sum() == 0
    clean = track(clip, TrackSettings(filter="none"))
    sound(clean)
    assert clean.errors().max() <= 0.003
    everything = track(Recording(KINECT, clip.time, 0.0 * clip.joints, 0.0 * clip.joints))
    sound(everything)


def test_a_hierarchy_of_end_sites_alone(tmp_path: Path) -> None:
    ends = "\tEnd Site\n\t{\n\t\tOFFSET 1 0 0\n\t}\n" * 3
    text = f"HIERARCHY\nROOT Hips\n{{\n\tOFFSET 0 0 0\n\tCHANNELS 3 Xposition Yposition Zposition\n{ends}}}\n"
    path = tmp_path / "ends.bvh"
    path.write_text(text + "MOTION\nFrames: 3\nFrame Time: 0.1\n0 1 0\n0 1.1 0\n0 1.2 0\n", "utf-8")
    clip = read_recording(path)
    assert len(clip.left_out) == 24
    tracked = track(clip, TrackSettings(filter="none"))
    sound(tracked)
    assert tracked.errors().max() <= 1e-9


def test_a_sensor_may_begin_with_nobody_and_without_calibration(tmp_path: Path) -> None:
    clip = noisy(recorded("walk", tmp_path))
    tracker = Tracker()
    with pytest.raises(SimCoreError, match="trunk"):
        tracker.update(np.full((25, 3), np.nan), 0.0)
    found = [tracker.update(joints, float(time)) for joints, time in zip(clip.joints, clip.time, strict=True)]
    assert np.isfinite([one.points for one in found]).all()
    calibrated = Tracker(calibrate(KINECT, clip.joints))
    first = calibrated.update(np.full((25, 3), np.nan), 0.0)
    assert first.lost.all()
    assert np.isfinite(first.points).all()


def test_wrong_shapes_and_settings_are_told() -> None:
    with pytest.raises(SimCoreError, match=r"\(25, 3\) is meant"):
        Tracker().update(np.zeros((21, 3)), 0.0)
    with pytest.raises(SimCoreError, match="filter: 'moving average'"):
        TrackSettings(filter="moving average")
    with pytest.raises(SimCoreError, match="m0"):
        TrackSettings(m0=-1.0)
    with pytest.raises(SimCoreError, match="level"):
        TrackSettings(level=7)
    with pytest.raises(SimCoreError, match="joints: shape"):
        calibrate(KINECT, np.zeros((3, 21, 3)))
    with pytest.raises(SimCoreError, match="outliers"):
        Disturbance(outliers=2.0)
    with pytest.raises(SimCoreError, match="metres are meant"):
        Recording(KINECT, np.zeros(1), np.full((1, 25, 3), 2e6))


def test_our_own_figure_is_followed_as_well() -> None:
    from sim_core.body import POSES, Mannequin

    figure = Mannequin.load(Path(__file__).parents[2] / "assets" / "mannequins" / "woman.npz")
    start, end = (POSES[name][0] for name in ("arms-down", "salute"))
    poses = [start.towards(end, 0.5 - 0.5 * np.cos(share)) for share in np.linspace(0.0, 2.0 * np.pi, 90)]
    joints = np.array([figure.skeleton.joints(pose) for pose in poses])
    clip = Recording(figure_skeleton(), np.arange(90) / 30.0, joints, joints)
    tracked = track(clip, TrackSettings(filter="none"))
    sound(tracked)
    assert tracked.points.shape[1] == 21 + 3 * 20
    assert tracked.errors().max() <= 0.020
    assert np.sqrt((tracked.errors() ** 2).mean()) <= 0.003
    assert np.sqrt((track(noisy(clip)).errors() ** 2).mean()) <= 0.012


def test_rotations_of_bones_point_where_bones_do_and_do_not_twist(tmp_path: Path) -> None:
    """At 1 mm noise a bone turns about itself by at most 2 degrees a frame; rotations take its rest to where it is."""
    clip = recorded("walk", tmp_path).disturbed(Disturbance(0.001))
    tracked = track(clip, TrackSettings(filter="none"))
    bones, rest = KINECT.bones, tracked.calibration.rest
    begin = rest[bones[:, 1]] - rest[bones[:, 0]]
    along = tracked.joints[:, bones[:, 1]] - tracked.joints[:, bones[:, 0]]
    w, v = tracked.rotations[..., :1], tracked.rotations[..., 1:]
    turned = begin + 2.0 * np.cross(v, np.cross(v, begin) + w * begin)
    assert np.abs(turned - along).max() <= 1e-9
    unit = along / np.linalg.norm(along, axis=2, keepdims=True)
    before, now = tracked.rotations[:-1], tracked.rotations[1:]
    vector = (
        before[..., :1] * now[..., 1:]
        - now[..., :1] * before[..., 1:]
        - np.cross(now[..., 1:], before[..., 1:])
    )
    real = (before * now).sum(2)
    twist = 2.0 * np.degrees(np.abs(np.arctan2((vector * unit[1:]).sum(2), real)))
    twist = np.minimum(twist, 360.0 - twist)
    long = tracked.calibration.lengths > 0.05
    assert twist[:, long].max() <= 2.0


@pytest.mark.nightly
def test_a_hundred_thousand_frames_do_not_drift(tmp_path: Path) -> None:
    clip = recorded("dance", tmp_path, seconds=20.0)
    whole = noisy(clip)
    tracker, worst, bones = Tracker(calibrate(KINECT, whole.joints)), 0.0, 0.0
    there_and_back = np.r_[0 : len(clip.time), len(clip.time) - 2 : 0 : -1]
    lengths, pairs = tracker.calibration.lengths, KINECT.bones
    errors = []
    for number in range(100_000):
        frame = there_and_back[number % len(there_and_back)]
        found = tracker.update(whole.joints[frame], number / 30.0)
        if number % 50 == 0 or number > 99_900:
            worst = max(worst, float(np.abs(found.trunk @ found.trunk.T - np.eye(3)).max()))
            worst = max(worst, float(np.abs(np.linalg.norm(found.rotations, axis=1) - 1.0).max()))
            found_lengths = np.linalg.norm(found.joints[pairs[:, 1]] - found.joints[pairs[:, 0]], axis=1)
            bones = max(bones, float(np.abs(found_lengths - lengths).max()))
            errors.append(np.linalg.norm(found.joints - clip.joints[frame], axis=1))
    assert worst <= 1e-12
    assert bones <= 1e-9
    squares = np.square(errors).mean(1)
    assert np.sqrt(squares[-500:].mean()) <= 1.1 * np.sqrt(squares[:500].mean())
