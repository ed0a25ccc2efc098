"""Motions of our own making: loops that close, feet that stand, limbs that keep clear, files that tell their faults."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from sim_core.body import JOINTS, LIMITS, Loop, Mannequin, Pose, load_motion
from sim_core.body.motion import (
    Clearances,
    Curve,
    Key,
    Steps,
    clearances,
    ground,
    minimum_jerk,
    seam,
)
from sim_core.errors import FileProblem, SimCoreError

ASSETS = Path(__file__).parents[2] / "assets"
NAMES = ("walk", "turn", "salute", "raised-sleeve")
SLIDE, FLOOR = 0.005, 0.005  # [m] of the issue
OURS = 0.0025  # [m] that ours keep


@cache
def woman() -> Mannequin:
    return Mannequin.load(ASSETS / "mannequins" / "woman.npz")


@cache
def motion(name: str) -> Loop:
    loop = load_motion(ASSETS / "motions" / f"{name}.toml")
    assert isinstance(loop, Loop)
    return loop


@cache
def played(name: str) -> tuple[Pose, ...]:
    return motion(name).poses(woman())


@pytest.mark.parametrize("name", NAMES)
def test_a_loop_closes_in_place_speed_and_acceleration(name: str) -> None:
    jump = seam(woman(), motion(name))
    assert jump.place < 1e-9
    assert jump.speed < 1e-3  # [m/s]
    assert jump.acceleration < 0.3  # [m/s2], of differences over a tenth of a millisecond


@pytest.mark.parametrize("name", NAMES)
def test_nothing_jumps_within_a_loop(name: str) -> None:
    """Speeds of joints change by no more than a body's can between frames of a hundredth of a second."""
    joints = np.stack([woman().skeleton.joints(pose) for pose in motion(name).poses(woman(), rate=100)])
    speed = np.diff(joints, axis=0) * 100
    change = np.linalg.norm(np.diff(speed, axis=0), axis=2) * 100
    assert change.max() < 60.0  # [m/s2]; of feet that come down


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("rate", [25, 100])
def test_planted_feet_do_not_slide_and_nothing_goes_into_the_floor(name: str, rate: int) -> None:
    """With the root travelling, heel and ball alike; once more with a wider notion of what touches."""
    loop = motion(name)
    times = np.arange(0.0, min(2.3, loop.seconds), 1.0 / rate)
    poses = loop.at(woman(), times + 0.2 * loop.seconds)
    met = ground(woman(), poses)
    assert max(met.slide) < OURS < SLIDE
    assert met.deepest < 0.001 < FLOOR
    assert max(ground(woman(), poses, up=0.005).slide) < SLIDE
    assert min(met.planted) > 0.5


def test_measured_slide_is_that_of_a_foot_that_slides() -> None:
    poses = [Pose().shifted(z=0.004 * k) for k in range(4)]
    met = ground(woman(), poses)
    assert met.slide == pytest.approx((0.012, 0.012), abs=1e-9)
    assert ground(woman(), [Pose().shifted(y=0.1, z=0.1 * k) for k in range(3)]).slide == (0.0, 0.0)
    assert ground(woman(), [Pose().shifted(y=-0.02)]).deepest == pytest.approx(0.02, abs=1e-4)


@pytest.mark.parametrize("name", NAMES)
def test_no_limb_goes_through_another(name: str) -> None:
    poses = played(name)
    once = poses[: len(poses) // motion(name).rounds + 1]
    near = clearances(woman(), once[:: max(3, len(once) // 24)])
    assert min(near.least.values()) > 0.0, near.least
    assert set(near.frame) == set(near.least)


def test_clearances_are_signed_distances() -> None:
    def found(pose: Pose) -> Clearances:
        return clearances(woman(), [pose])

    crossed = Pose.from_rotvecs(
        {
            "elbow_l": (0, -100, 0),
            "elbow_r": (0, 100, 0),
            "shoulder_l": (0, -60, -20),
            "shoulder_r": (0, 60, 20),
        }
    )
    assert found(crossed).least["left arm – right arm"] < 0.0
    assert found(Pose()).least["left arm – right arm"] == 0.08  # far apart: told no further
    legs = Pose.from_rotvecs({"hip_l": (0, 0, -12), "hip_r": (0, 0, 12)})
    assert found(legs).least["left leg – right leg"] < 0.0
    hand = Pose.from_rotvecs({"shoulder_l": (0, 0, -85), "elbow_l": (0, -20, 0), "wrist_l": (0, 0, -60)})
    assert found(hand).least["left hand – trunk and legs"] < 0.08


@pytest.mark.parametrize("name", NAMES)
def test_joints_keep_within_their_limits(name: str) -> None:
    for pose in played(name)[::2]:
        pose.check()
    assert {joint for pose in played(name) for joint, _ in pose.turns} <= set(LIMITS)


def test_the_right_side_of_a_walk_is_the_left_half_a_stride_later() -> None:
    loop = motion("walk")
    times = np.linspace(0.0, loop.period, 9)
    now, later = (loop.at(woman(), times + lag * loop.period, in_place=True) for lag in (0.0, 0.5))
    for left, right in zip(now, later, strict=True):
        twin = right.mirrored()
        assert np.abs(np.abs((left.quaternions() * twin.quaternions()).sum(1)) - 1.0).max() < 1e-6
        assert np.abs(np.subtract(left.shift, twin.shift)).max() < 1e-3


def test_a_walk_is_calm_and_goes_on() -> None:
    """Steps of half a metre, about a metre a second, arms that swing little, knees bent as published."""
    loop, poses = motion("walk"), played("walk")
    stride = loop.stride(woman())
    assert 0.9 < stride < 1.1
    assert 0.85 < stride / loop.period < 1.1
    way = np.array([pose.shift for pose in poses])
    assert way[-1, 2] - way[0, 2] == pytest.approx(stride * loop.rounds, abs=1e-9)
    assert 0.01 < np.ptp(way[:, 1]) < 0.05
    assert 0.01 < np.ptp(way[:, 0]) < 0.06
    knee = np.array([pose.vector("knee_l")[0] for pose in poses])
    assert 35.0 < knee.max() < 65.0
    arm = np.array(
        [woman().skeleton.joints(pose)[JOINTS.index("wrist_l"), 2] - pose.shift[2] for pose in poses]
    )
    assert 0.03 < np.ptp(arm) < 0.25


def test_in_place_the_figure_walks_on_the_spot() -> None:
    held = motion("walk").poses(woman(), in_place=True)
    for going, still in zip(played("walk"), held, strict=True):
        assert going.turns == still.turns
        assert going.shift[:2] == still.shift[:2]
    assert np.ptp([pose.shift[2] for pose in held]) < 0.05
    assert np.subtract(held[-1].shift, held[0].shift) == pytest.approx(0.0, abs=1e-9)


def test_a_turn_faces_as_before_when_it_is_over() -> None:
    poses = played("turn")
    facing = np.unwrap([np.arctan2(*woman().skeleton.moves(pose)[0][0][[0, 2], 2]) for pose in poses])
    assert facing[-1] - facing[0] == pytest.approx(2.0 * np.pi, abs=1e-6)
    assert (np.diff(facing) > 0.0).mean() > 0.9
    assert np.abs(np.array([pose.shift for pose in poses])[:, [0, 2]]).max() < 0.06


def test_hands_meet_in_a_salute_and_the_figure_bows() -> None:
    poses = played("salute")
    marks = [woman().landmarks(pose) for pose in poses]
    apart = np.array([np.linalg.norm(mark["tip_l"] - mark["tip_r"]) for mark in marks])
    lowest = min(mark["nape"][1] for mark in marks)
    assert apart.min() < 0.10
    assert apart.max() > 0.5
    assert marks[0]["nape"][1] - lowest > 0.07
    chest = marks[int(np.argmin(apart))]
    assert chest["tip_l"][2] > chest["bust"][2] + 0.15  # before the chest


def test_one_sleeve_is_raised_after_the_other() -> None:
    poses = played("raised-sleeve")
    tips = np.array([[woman().landmarks(pose)[f"tip_{side}"][1] for side in "lr"] for pose in poses])
    left, right = tips.argmax(0)
    assert left < right
    assert (tips.max(0) > 1.5).all()
    assert (tips[[left, right], [1, 0]] < 1.2).all()


@pytest.mark.parametrize("name", ["woman-150", "man-167"])
def test_other_figures_walk_with_their_own_legs(name: str) -> None:
    figure = Mannequin.load(ASSETS / "mannequins" / f"{name}.npz")
    met = ground(figure, motion("walk").poses(figure))
    assert max(met.slide) < SLIDE
    assert met.deepest < FLOOR
    ratio = motion("walk").stride(figure) / motion("walk").stride(woman())
    assert ratio == pytest.approx(figure.heads[JOINTS.index("hip_l"), 1] / 0.8374, abs=0.05)


@pytest.mark.parametrize("rate", [5.0, 24.0, 30.0, 120.0])
def test_a_loop_closes_at_any_rate(rate: float) -> None:
    loop = motion("walk")
    times = loop.times(rate)
    assert times[-1] == pytest.approx(loop.seconds)
    assert abs((len(times) - 1) / times[-1] - rate) <= 0.5 / loop.seconds
    poses = loop.poses(woman(), rate=rate, in_place=True)
    assert len(poses) == len(times)
    assert np.abs(poses[0].quaternions() - poses[-1].quaternions()).max() < 1e-9
    twice = loop.poses(woman(), rate=rate, loops=2)
    assert len(twice) == 2 * len(times) - 1


def test_a_wearer_comes_into_a_loop_from_where_it_stands() -> None:
    loop, start = motion("walk"), Pose.arms(45.0, 12.0)
    poses = loop.course(start, woman())
    assert poses[0] == start
    assert poses[25] == loop.poses(woman(), in_place=True)[0]
    assert len(poses) == 25 + len(loop.times())


def test_minimum_jerk_begins_and_ends_at_rest() -> None:
    t = np.linspace(-0.5, 1.5, 4001)
    way = minimum_jerk(t)
    speed = np.gradient(way, t)
    assert way[0] == 0.0
    assert way[-1] == 1.0
    assert np.abs(np.gradient(speed, t)).max() < 6.0
    assert minimum_jerk(0.5) == pytest.approx(0.5)


def test_keys_that_overlap_do_not_stop_between() -> None:
    there = Pose.from_rotvecs({"shoulder_l": (0.0, 0.0, -40.0)})
    further = Pose.from_rotvecs({"shoulder_l": (0.0, 0.0, -80.0)})
    rest = Pose()

    def speeds(early: float) -> np.ndarray:
        keys = (Key(1.0, there), Key(1.0, further, early), Key(1.0, rest))
        loop = Loop("raise", 3.0 - early, keys=keys)
        z = [loop.raw(t / loop.period).vector("shoulder_l")[2] for t in np.linspace(0.3, 1.7 - early, 60)]
        return np.diff(z)

    assert np.abs(speeds(0.0)).min() < 0.01 * np.abs(speeds(0.0)).max()
    assert np.abs(speeds(0.5)).min() > 0.3 * np.abs(speeds(0.5)).max()


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (lambda: Curve("thigh", "x", (0, 50), (0, 1)), "joint: none called 'thigh' – there are root, pelvis"),
        (lambda: Curve("hip", "x", (0, 50), (0, 1, 2)), "at: 2 places for 3 values"),
        (lambda: Curve("hip", "x", (50, 20), (0, 1)), "give percentages that rise"),
        (lambda: Curve("hip", "x", (0, 100), (0, 1)), "there it begins again"),
        (lambda: Curve("hip", "x", (0, 1e-9), (0, 1)), "rise by 0.01 or more"),
        (lambda: Curve("hip", "x", (0, 50), (0, 1e308), 10.0), "degrees: .* comes to -360 to 360"),
        (lambda: Curve("root", "y", (0, 50), (0, 11)), "metres: .* comes to -10 to 10"),
        (lambda: Steps(off=0.4), "off: 0.4 – one foot stands always"),
        (lambda: Steps(flat=(0.5, 0.3)), "flat: .* two shares that rise"),
        (lambda: Loop("x", 1.0, steps=Steps(turn=50.0)), "rounds: 1 times 50 degrees is no whole turn"),
        (lambda: Loop("x", 1.0, keys=(Key(1.0, Pose()),), steps=Steps()), "feet of keyed poses stand"),
    ],
)
def test_what_cannot_be_played_says_so(made, words: str) -> None:
    with pytest.raises(SimCoreError, match=words) as caught:
        made()
    assert "\n" not in str(caught.value)


def test_strides_that_legs_cannot_make_are_refused() -> None:
    hip = Curve("hip", "x", (0, 12, 31, 50, 62, 75, 87), (20, 18, 0, -20, -10, 15, 25), -3.5)
    with pytest.raises(SimCoreError, match="hip curves of smaller scale"):
        Loop("far", 1.0, curves=(hip,), steps=Steps()).poses(woman())
    arm = Curve("shoulder", "z", (0, 50), (-80, 120))
    with pytest.raises(SimCoreError, match=r"motion wave at 0\.\d\d s: shoulder_r turned"):
        Loop("wave", 1.0, curves=(arm,)).poses(woman())


CURVE = 'period = 1.0\n[[curve]]\njoint = "hip"\naxis = "x"\nat = [0, 50]\ndegrees = [0, 10]\nsource = "made up"\n'


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "the file is empty"),
        ('name = "x"', r"key: missing – give \[\[key\]\] tables"),
        (CURVE.replace("period = 1.0\n", ""), "period: missing"),
        (CURVE.replace('"x"', '"w"'), r"curve\.1\.axis: .*\(found 'w'\)"),
        (CURVE.replace("hip", "thigh"), r"curve\.1\.joint: none called 'thigh'"),
        (CURVE.replace("degrees", "metres"), r"curve\.1\.degrees: hip takes degrees"),
        (CURVE.replace("[0, 10]", "[0, 10, 20]"), r"curve\.1\.at: 2 places for 3 values"),
        (CURVE.replace('source = "made up"\n', ""), r"curve\.1\.source: Field required"),
        (CURVE + "colour = 1\n", r"curve\.1\.colour: unknown key – remove it or correct its name"),
        (CURVE + "[steps]\noff = 0.3\n", r"steps\.off: 0\.3 – one foot stands always"),
        (CURVE.replace("period = 1.0", 'period = "one"'), r"period: .*\(found 'one'\)"),
        ("loop = false\n" + CURVE, "loop: false, but curves repeat"),
        ('loop = true\n[[key]]\nseconds = 1.0\npose = "dsplay"\n', r"key\.1\.pose: none called 'dsplay'"),
        (
            'period = 2.0\n[[key]]\nseconds = 1.0\npose = "display"\n',
            "period: only a motion that repeats has one",
        ),
        (
            'loop = true\nperiod = 2.0\n[[key]]\nseconds = 1.0\npose = "display"\n',
            "period: 2, but the keys take 1 s",
        ),
        (
            '[[key]]\nseconds = 1.0\nearly = 0.5\npose = "display"\n',
            r"key\.1\.early: only keys of a loop overlap",
        ),
        (
            "rounds = 100\n" + CURVE.replace("1.0", "60.0"),
            "rounds: 100 periods take 6000 s – .* 600 s at most",
        ),
        ("[[key]]\nseconds = 60\npose = {}\n" * 11, "key: its keys take 660 s – .* 600 s at most"),
    ],
)
def test_a_faulty_file_is_told_by_file_key_value_and_remedy(tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "bow.toml"
    file.write_text(text, "utf-8")
    with pytest.raises(FileProblem, match=words) as caught:
        load_motion(file)
    assert str(caught.value).startswith(f"{file}: ")
    assert "\n" not in str(caught.value)


def test_every_curve_that_ships_names_its_source() -> None:
    for name in NAMES:
        for curve in motion(name).curves:
            assert len(curve.source) > 20, (name, curve.joint)
        assert set(motion(name).title) == {"zh", "en"}
