"""What was tracked of a wearer in motion: baked from the arrays of `track`, read back, and served beside the clip."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from moving_hall import FRAMES, RATE, box_points, write_moving_hall

from hall_app.build import limb_bones, sensed, write_points
from hall_app.check import check
from hall_app.content import exhibit_json, load
from hall_app.content.models import TrackedError, TrackedMotion
from sim_core.body import Mannequin, Motion, Pose, load_motion
from sim_core.garment.levels import BASE
from sim_core.track import TrackSettings, track

ASSETS = Path(__file__).parents[2] / "assets"
UP = np.array([0.0, BASE[1], 0.0])
REACH = 0.15  # [m] from a feature point to its own on the garment


class Walk:
    """A figure that stands, then walks in place, in a robe that lies 2 cm outside its trunk and legs."""

    def __init__(self, folder: Path) -> None:
        self.wearer = Mannequin.load(ASSETS / "mannequins" / "woman.npz")
        loop = load_motion(ASSETS / "motions" / "walk.toml")
        assert not isinstance(loop, Motion)
        frames = round(loop.period * loop.rounds * RATE)
        stand = Pose.arms(10.0, 2.0)
        self.poses = (stand, *loop.course(stand, self.wearer)[-frames - 1 : -1])
        skin = np.stack([self.wearer.posed(pose) for pose in self.poses])
        robe = np.flatnonzero((self.wearer.vertices[:, 1] > 0.3) & (self.wearer.vertices[:, 1] < 1.3))
        middle = skin.mean(1, keepdims=True) * [1, 0, 1]
        out = skin - middle
        out[..., 1] = 0.0
        out /= np.linalg.norm(out, axis=2, keepdims=True)
        self.robe = (skin + 0.02 * out)[:, robe]
        self.written = write_points(
            self.wearer, self.poses, {"1 robe": self.robe}, folder, rate=RATE, loop=True, begin=1
        )
        self.recording, self.rows = sensed(self.wearer, self.poses, rate=RATE, loop=True, begin=1)
        self.tracked = track(self.recording, TrackSettings())


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("points")


@pytest.fixture(scope="module")
def walk(folder: Path) -> Walk:
    return Walk(folder)


def test_they_are_the_arrays_of_the_tracker(walk: Walk):
    found, tracked, rows = walk.written, walk.tracked, walk.rows
    assert np.array_equal(found.points, tracked.points[rows] + UP)
    limbs = limb_bones(tracked)
    assert np.array_equal(found.m, tracked.m[rows][:, limbs])
    assert np.array_equal(found.delta, tracked.delta[rows][:, limbs])
    assert np.array_equal(found.lost, tracked.lost[rows])
    assert (rows[1:] == np.arange(len(tracked.time) - found.frames, len(tracked.time))).all()
    assert found.m0 == TrackSettings().m0


def test_shapes_and_bounds(walk: Walk):
    found, count = walk.written, len(walk.poses)
    assert found.points.shape == (count, 97, 3)
    assert (found.frames, found.begin) == (count - 1, 1)
    assert (found.torso.sum(), len(found.bones), len(found.limbs)) == (25, 24, 16)
    assert np.isfinite(found.m).all()
    assert found.m.min() >= 0.0
    assert 0.0 < np.median(found.delta) < 0.02
    assert not found.lost.any()
    assert walk.tracked.truth is not None
    truth = walk.tracked.truth[walk.rows] + UP
    away = np.linalg.norm(found.points - truth, axis=2)
    assert np.sqrt((away**2).mean()) < 0.012
    assert away.max() < 0.06
    joints = np.stack([walk.wearer.skeleton.joints(pose) for pose in walk.poses])
    assert np.abs(truth[:, 0] - UP - joints[:, 0]).max() < 1e-12  # SpineBase is the pelvis


def test_the_loop_closes_as_if_it_had_always_gone_on(walk: Walk):
    count = walk.written.frames
    assert np.abs(walk.tracked.points[-count:] - walk.tracked.points[-2 * count : -count]).max() < 1e-9
    way = np.abs(np.diff(walk.written.points[1:], axis=0)).max()
    assert np.abs(walk.written.points[1] - walk.written.points[-1]).max() <= way


def test_points_of_the_garment_are_bound_one_to_one_and_carried(walk: Walk):
    found = walk.written
    assert len(np.unique(found.worn)) == len(found.worn)
    assert 25 < len(found.worn) < 97  # hands and head are bare
    robe = walk.robe + UP
    first = np.abs(robe[0][None] - found.cloth[0][:, None]).max(2)
    vertex = first.argmin(1)
    assert len(np.unique(vertex)) == len(vertex)
    assert np.array_equal(found.cloth, robe[:, vertex])
    assert walk.tracked.truth is not None
    truth = walk.tracked.truth[walk.rows[0]] + UP  # as it stands
    assert np.linalg.norm(found.cloth[0] - truth[found.worn], axis=1).max() <= REACH
    bone = walk.tracked.feature_points.bone
    thumbs = np.flatnonzero(walk.tracked.calibration.lengths[bone] == 0.0)
    assert len(thumbs) == 8  # they lie at the wrists, whose own points are bound
    bare = np.setdiff1d(np.arange(97), [*found.worn, *thumbs])
    near = np.linalg.norm(robe[0][None] - truth[bare][:, None], axis=2).min(1)
    assert near.min() > REACH


def test_the_file_is_small_and_holds_them(walk: Walk, folder: Path):
    path = folder / "motion.points"
    assert path.stat().st_size < 60_000
    read, written = TrackedMotion.load(path), walk.written
    for name, within in (("points", 0.126e-3), ("cloth", 0.126e-3), ("m", 0.51e-3), ("delta", 0.051e-3)):
        assert np.abs(getattr(read, name) - getattr(written, name)).max() < within, name
    for name in ("torso", "bones", "worn", "limbs", "lost"):
        assert np.array_equal(getattr(read, name), getattr(written, name)), name
    for name in ("noise", "m0", "rounds", "rate", "loop", "begin"):
        assert getattr(read, name) == getattr(written, name), name


def test_a_motion_that_ends_stands_before_it_begins(tmp_path: Path):
    wearer = Mannequin.load(ASSETS / "mannequins" / "woman.npz")
    low, high = Pose.arms(10.0, 2.0), Pose.arms(40.0, 2.0)
    poses = Motion(((0.6, high),)).poses(low)
    nothing = np.full((len(poses), 3, 3), 9.0)
    found = write_points(wearer, poses, {"far": nothing}, tmp_path, rate=RATE, loop=False)
    assert found.frames == len(poses)
    assert found.cloth.shape == (len(poses), 0, 3)  # nothing is worn
    recording, rows = sensed(wearer, poses, rate=RATE, loop=False)
    assert recording.truth is not None
    joints = recording.truth[rows] + UP
    assert np.sqrt(((found.points[:, :25] - joints) ** 2).sum(2).mean()) < 0.015
    assert TrackedMotion.load(tmp_path / "motion.points").cloth.shape == (len(poses), 0, 3)


def test_damaged_ones_are_refused(walk: Walk):
    data = walk.written.to_bytes()
    for spoilt in (b"", b"HALLCLIP" + data[8:], data[:60], data[:-9], data + b"0"):
        with pytest.raises(TrackedError):
            TrackedMotion.from_bytes(spoilt)
    with pytest.raises(TrackedError, match="beyond"):
        TrackedMotion.from_bytes(replace(walk.written, worn=walk.written.worn + 97).to_bytes())


@pytest.fixture
def content(tmp_path: Path) -> Path:
    return write_moving_hall(tmp_path / "content", points=True)


def motion_problems(folder: Path) -> list[str]:
    return [str(problem) for problem in check(folder) if "motion" in problem.key or "sway" in str(problem)]


def test_they_are_served_beside_their_clip(content: Path):
    told = exhibit_json(load(content), "box")
    assert told is not None
    assert told["points"].startswith("/media/box/sway.points?v=")
    assert motion_problems(content) == []
    (content / "exhibits" / "box" / "sway.points").unlink()
    told = exhibit_json(load(content), "box")
    assert told is not None
    assert told["points"] is None


def test_what_is_wrong_with_them_is_named(content: Path):
    path = content / "exhibits" / "box" / "sway.points"
    points = box_points()
    path.write_bytes(points.to_bytes()[:-5])
    assert "sway.points: cut off" in " ".join(motion_problems(content))
    replace(points, rate=30.0).save(path)
    assert f"{FRAMES} frames at 30 Hz, the clip {FRAMES} at 25 Hz" in " ".join(motion_problems(content))
