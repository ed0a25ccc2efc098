"""Points follow a person: the figures to reach, on motions made here and on a real walk where it is at hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from moving_people import person

from sim_core.track import (
    KINECT,
    Disturbance,
    Recording,
    Tracked,
    TrackSettings,
    feature_points,
    read_recording,
    track,
)

WALK = Path(__file__).parents[2].parent / "shared" / "data" / "motion" / "cmu_12_01_walk.bvh"
ARM = [KINECT.joints.index(f"{name}Left") for name in ("Elbow", "Wrist", "Hand", "HandTip", "Thumb")]
CLIPS = ("real walk", "real walk at 30 Hz", "walk", "turn", "salute", "dance")
NOISE = 0.01


def recorded(kind: str, folder: Path, seconds: float = 5.0, rate: float = 30.0, seed: int = 0) -> Recording:
    """A motion made here, by way of a BVH file."""
    path = folder / f"{kind}.bvh"
    path.write_text(person(kind, seconds, rate, seed).bvh(), "utf-8")
    return read_recording(path)


@pytest.fixture(params=CLIPS)
def clip(request: pytest.FixtureRequest, tmp_path: Path) -> Recording:
    if not request.param.startswith("real"):
        return recorded(request.param, tmp_path)
    if not WALK.is_file():
        pytest.skip(f"{WALK}: the real clip is not here")
    whole = read_recording(WALK)
    step = 4 if "30" in request.param else 1
    assert whole.truth is not None
    return Recording(KINECT, whole.time[::step], whole.joints[::step], whole.truth[::step])


def rmse(tracked: Tracked, chosen: np.ndarray | None = None) -> float:
    """[mm]"""
    errors = tracked.errors() if chosen is None else tracked.errors()[chosen]
    return float(np.sqrt((errors**2).mean()) * 1e3)


def test_clean_motion_is_followed_within_3_mm(clip: Recording) -> None:
    for settings in (TrackSettings(filter="none"), TrackSettings(filter="kalman")):
        tracked = track(clip, settings)
        assert rmse(tracked) <= 3.0
        assert tracked.errors().max() <= 0.020
        assert tracked.bone_error() <= 1e-9
        assert tracked.flips.sum() == 0
        assert not tracked.lost.any()
        assert tracked.points.shape[1] == 97


def test_the_trunk_alone_would_be_far_off(clip: Recording) -> None:
    """What the limbs are refined for: points carried rigidly by the trunk's rotation."""
    tracked = track(clip, TrackSettings(filter="none"))
    points = tracked.feature_points.of(clip.joints)
    own = np.einsum("tji,tpj->tpi", tracked.trunk, points - tracked.shift[:, None])
    rigid = np.einsum("tij,pj->tpi", tracked.trunk, own.mean(0)) + tracked.shift[:, None]
    assert np.sqrt(((rigid - points) ** 2).sum(2).mean()) > 0.02


@pytest.mark.parametrize("seed", range(4))
def test_noise_of_10_mm_an_axis_leaves_12(clip: Recording, seed: int) -> None:
    tracked = track(clip.disturbed(Disturbance(NOISE, seed=seed)))
    assert rmse(tracked) <= 12.0
    assert tracked.calibration.noise == pytest.approx(NOISE, rel=0.15)
    assert tracked.bone_error() <= 1e-9
    unfiltered = track(clip.disturbed(Disturbance(NOISE, seed=seed)), TrackSettings(filter="none"))
    raw = np.linalg.norm(
        feature_points(KINECT).of(clip.disturbed(Disturbance(NOISE, seed=seed)).joints) - tracked.truth,
        axis=2,
    )
    assert rmse(tracked) < rmse(unfiltered) < 1e3 * np.sqrt((raw**2).mean())


@pytest.mark.parametrize("seed", range(4))
def test_outliers_leave_half_a_millimetre_more(clip: Recording, seed: int) -> None:
    worse = clip.disturbed(Disturbance(NOISE, outliers=0.01, seed=seed))
    tracked = track(worse)
    assert rmse(tracked) <= 12.5
    struck = np.linalg.norm(worse.joints - clip.joints, axis=2) > 0.2
    assert tracked.lost[:, :25][struck].mean() > 0.9  # told from what was measured
    assert tracked.lost[:, :25][~struck].mean() < 0.01


@pytest.mark.parametrize("start", [0.25, 0.5, 0.7])
def test_half_a_second_without_an_arm_is_told_and_bounded(clip: Recording, start: float) -> None:
    joints = clip.disturbed(Disturbance(NOISE, seed=1)).joints
    first = int(start * len(joints))
    gone = slice(first, first + round(0.5 / clip.step))
    joints[gone, ARM] = np.nan
    tracked = track(Recording(KINECT, clip.time, joints, clip.truth))
    assert rmse(tracked) <= 25.0
    hidden = tracked.feature_points.unseen(~np.isin(np.arange(25), ARM))
    assert tracked.lost[gone][:, hidden].all()
    assert not tracked.lost[gone][:, ~hidden].any()
    assert np.isfinite(tracked.points).all()
    assert tracked.bone_error() <= 1e-9
    back = slice(gone.stop + 3, gone.stop + 15)  # three frames after it is seen again
    assert rmse(tracked, back) <= 15.0


def test_dropout_is_bridged(clip: Recording) -> None:
    tracked = track(clip.disturbed(Disturbance(NOISE, dropout=0.02, seed=3)))
    assert rmse(tracked) <= 12.5
    assert 0.02 < tracked.lost[:, :25].mean() < 0.04 or tracked.lost[:, :25].mean() == pytest.approx(
        0.02, abs=0.005
    )


@pytest.mark.parametrize("rate", [5.0, 60.0, 120.0])
@pytest.mark.parametrize("kind", ["walk", "dance"])
def test_any_rate_is_followed(tmp_path: Path, rate: float, kind: str) -> None:
    clip = recorded(kind, tmp_path, rate=rate)
    assert rmse(track(clip, TrackSettings(filter="none"))) <= 3.0
    tracked = track(clip.disturbed(Disturbance(NOISE, seed=2)))
    assert rmse(tracked) <= (12.0 if rate > 5.0 or kind == "walk" else 14.0)
    one_euro = track(clip.disturbed(Disturbance(NOISE, seed=2)), TrackSettings(filter="one-euro"))
    assert np.isfinite(one_euro.points).all()


def test_a_tighter_threshold_costs_iterations_and_gains_accuracy(clip: Recording) -> None:
    worse = clip.disturbed(Disturbance(NOISE, seed=0))
    errors, rounds = [], []
    for m0 in (1e9, 0.5, 0.1, 0.0):
        tracked = track(worse, TrackSettings(m0=m0))
        errors.append(rmse(tracked))
        rounds.append(tracked.iterations.mean())
        assert tracked.iterations.max() <= 5
        assert tracked.bone_error() <= 1e-9
    assert rounds[0] == 0.0
    assert rounds == sorted(rounds)
    assert errors[2] < errors[0]


def test_one_euro_is_smoother_for_a_viewer(tmp_path: Path) -> None:
    clip = recorded("walk", tmp_path)
    worse = clip.disturbed(Disturbance(NOISE, seed=0))
    jerks = {}
    for name in ("none", "kalman", "one-euro"):
        tracked = track(worse, TrackSettings(filter=name))
        jerks[name] = np.sqrt((np.diff(tracked.points, 2, axis=0) ** 2).mean())
    assert jerks["one-euro"] < 0.8 * jerks["none"]
    assert jerks["kalman"] < jerks["none"]
