"""Poses: rotations a joint, between two, mirrored, written down, and refused where no body goes."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim_core.body import JOINTS, LIMITS, OTHER_SIDE, PARENTS, POSES, Pose, Skeleton, pose_named
from sim_core.errors import SimCoreError

SIDED = ("clavicle", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe")


def _heads() -> np.ndarray:
    """Some skeleton, mirrored in x = 0."""
    heads = np.random.default_rng(1).normal(size=(len(JOINTS), 3))
    return 0.5 * (heads + (heads * [-1.0, 1.0, 1.0])[list(OTHER_SIDE)])


def _somewhere() -> st.SearchStrategy[Pose]:
    """Up to six joints turned within their limits, to the ends too, and a root up to 5 m away."""
    share = st.floats(0.0, 1.0)
    turned = st.dictionaries(st.sampled_from(JOINTS), st.tuples(share, share, share), max_size=6)
    shifts = st.tuples(*[st.floats(-5.0, 5.0)] * 3)
    return st.builds(lambda shares, shift: Pose.from_rotvecs(_within(shares), shift), turned, shifts)


def _within(shares: dict[str, tuple[float, float, float]]) -> dict[str, list[float]]:
    """Rotation vectors [degrees] that lie so far between the limits of each axis."""
    return {
        joint: [low + t * (high - low) for t, (low, high) in zip(ts, LIMITS[joint], strict=True)]
        for joint, ts in shares.items()
    }


def _angle(a: np.ndarray, b: np.ndarray) -> float:
    """The angle [rad] of the rotation from one quaternion (4,) to another, exact where it is small."""
    b = b if a @ b > 0 else -b
    return 4.0 * float(np.arctan2(np.linalg.norm(a - b), np.linalg.norm(a + b)))


def test_there_are_twenty_one_joints_parents_first_in_pairs() -> None:
    assert len(JOINTS) == len(set(JOINTS)) == 21
    assert JOINTS[0] == "pelvis"
    assert all(-1 <= parent < number for number, parent in enumerate(PARENTS))
    assert PARENTS.count(-1) == 1
    for name in SIDED:
        left, right = JOINTS.index(f"{name}_l"), JOINTS.index(f"{name}_r")
        assert OTHER_SIDE[left] == right
        assert OTHER_SIDE[right] == left
        assert PARENTS[right] == OTHER_SIDE[PARENTS[left]]
    assert [JOINTS[k] for k in range(21) if OTHER_SIDE[k] == k] == [
        "pelvis",
        "spine_1",
        "spine_2",
        "spine_3",
        "neck",
    ]


def test_a_rotation_turns_all_that_hangs_on_a_joint() -> None:
    heads = np.zeros((len(JOINTS), 3))
    for number, parent in enumerate(PARENTS):
        heads[number] = [1.0, 0.0, 0.0] + (heads[parent] if parent >= 0 else np.zeros(3))
    elbow, wrist, shoulder = (JOINTS.index(name) for name in ("elbow_l", "wrist_l", "shoulder_l"))
    bent = Skeleton(heads).joints(Pose.from_rotvecs({"elbow_l": (0.0, -90.0, 0.0)}))
    assert np.allclose(bent[wrist], heads[elbow] + [0.0, 0.0, 1.0])  # forward
    both = Skeleton(heads).joints(Pose.arms(30.0, 90.0))
    upper = np.array([np.cos(np.pi / 6), -0.5, 0.0])
    assert np.allclose(both[elbow], heads[shoulder] + upper)
    assert np.allclose(both[wrist], both[elbow] + [0.0, 0.0, 1.0])


@settings(max_examples=60)
@given(_somewhere())
def test_a_pose_written_down_is_the_same(pose: Pose) -> None:
    again = Pose.of(pose.table())
    assert np.abs(again.quaternions() - pose.quaternions()).max() < 1e-9
    assert again.shift == pytest.approx(pose.shift)
    pose.check()  # its joints were drawn within their limits
    assert hash(Pose(pose.turns, pose.shift)) == hash(pose)


def test_a_table_of_a_file_gives_a_named_pose_changed_joint_by_joint() -> None:
    assert Pose.of({}) == Pose()
    assert Pose.of({"name": "arms-down"}) == POSES["arms-down"][0]
    table = tomllib.loads(
        'pose = { name = "display", joints = { elbow_l = [0, -30, 0] }, shift = [0, 0.1, 2] }'
    )
    pose = Pose.of(table["pose"])
    display = POSES["display"][0]
    assert pose.vector("elbow_l") == pytest.approx((0.0, -30.0, 0.0))
    assert pose.turn("elbow_r") == display.turn("elbow_r")
    assert pose.turn("shoulder_l") == display.turn("shoulder_l")
    assert pose.shift == (0.0, 0.1, 2.0)
    assert display.symmetric
    assert not pose.symmetric
    straight = Pose.of({"name": "display", "joints": {"elbow_l": [0, 0, 0], "elbow_r": [0, 0, 0]}})
    assert straight == Pose.arms(45.0)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("display", r"pose: a str – give a table, e\.g\. { name"),
        ({"nmae": "t"}, r"pose: no key 'nmae' – there are name, joints, shift"),
        ({"name": "asleep"}, r"pose: name: none called 'asleep' – there are t, gown"),
        ({"name": ["t"]}, r"pose: name: none called \['t'\] – there are t, gown"),
        ({"joints": [0, 1, 2]}, r"pose: joints: a list – give a table of joint = \[x, y, z\] in degrees"),
        ({"joints": {"thumb": [0, 0, 0]}}, r"pose: joints: no joint 'thumb' – there are pelvis"),
        (
            {"joints": {"hip_l": [0, 0]}},
            r"pose: joints: hip_l: .* three finite numbers \(x, y, z\) in degrees",
        ),
        ({"joints": {"hip_l": "far"}}, r"pose: joints: hip_l: 'far' – .*expected three finite numbers"),
        (
            {"name": "held", "joints": {"elbow_l": [0, 60, 0]}},
            r"pose: joints: elbow_l turned 60\.0 degrees about y – give -145 to 2",
        ),
        ({"shift": [0, 2000, 0]}, r"pose: shift: \[0, 2000, 0\] – at most 1000 m each way"),
    ],
)
def test_a_table_that_is_no_pose_names_key_value_limit_and_remedy(table, words: str) -> None:
    with pytest.raises(SimCoreError, match=words) as caught:
        Pose.of(table, where="coat.toml: pose")
    assert str(caught.value).startswith("coat.toml: pose")
    assert "\n" not in str(caught.value)


def test_a_turn_within_the_limits_may_be_shorter_the_other_way_round() -> None:
    corner = tuple(bounds[0] if abs(bounds[0]) > bounds[1] else bounds[1] for bounds in LIMITS["shoulder_l"])
    assert np.linalg.norm(corner) > 180.0
    Pose.from_rotvecs({"shoulder_l": corner}).check()


@settings(max_examples=60)
@given(_somewhere())
def test_the_mirrored_pose_is_what_a_looking_glass_shows(pose: Pose) -> None:
    skeleton = Skeleton(_heads())
    shown = (skeleton.joints(pose) * [-1.0, 1.0, 1.0])[list(OTHER_SIDE)]
    assert np.abs(skeleton.joints(pose.mirrored()) - shown).max() < 1e-8
    assert pose.mirrored().mirrored() == pose
    pose.mirrored().check()  # limits are mirrored too
    even = all(pose.turn(j) == pose.mirrored().turn(j) for j in JOINTS) and pose.shift[0] == 0.0
    assert pose.symmetric or not even


def test_which_poses_are_their_own_mirror_image() -> None:
    assert Pose().symmetric
    assert Pose.arms(45.0, 12.0).symmetric
    assert {name for name, (pose, _) in POSES.items() if not pose.symmetric} == {"contrapposto", "step"}
    assert not Pose.arms(45.0, 12.0).shifted(x=0.001).symmetric
    assert Pose.arms(45.0, 12.0).shifted(y=-0.1, z=3.0).symmetric
    assert not Pose.from_rotvecs({"elbow_l": (0.0, -0.001, 0.0)}).symmetric
    assert not Pose().facing(20.0).symmetric


@settings(max_examples=60)
@given(_somewhere(), _somewhere(), st.floats(0.0, 1.0))
def test_between_two_poses_every_joint_turns_evenly(first: Pose, last: Pose, share: float) -> None:
    middle = first.towards(last, share)
    for joint in JOINTS:
        a, b, c = (np.array(pose.turn(joint)) for pose in (first, last, middle))
        whole, part = (_angle(a, q) for q in (b, c))
        assert part == pytest.approx(share * whole, abs=1e-9)
    assert first.towards(last, 0.0).quaternions() == pytest.approx(first.quaternions(), abs=1e-12)
    assert np.abs((first.towards(last, 1.0).quaternions() * last.quaternions()).sum(1)) == pytest.approx(1.0)
    assert middle.shift == pytest.approx((1 - share) * np.array(first.shift) + share * np.array(last.shift))


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_lowering_arms_pass_the_poses_of_lesser_angles(share: float) -> None:
    expected = Pose.arms(58.0 * share, 78.0 * share)
    assert Pose().towards(Pose.arms(58.0, 78.0), share).quaternions() == pytest.approx(expected.quaternions())


def test_poses_by_name_are_within_the_limits() -> None:
    for name, (pose, words) in POSES.items():
        pose.check()
        assert pose_named(name) == pose
        assert words
    assert {"t", "display", "held", "gown", "arms-down", "contrapposto", "step"} <= set(POSES)
    assert POSES["display"][0] == Pose.arms(45.0, 12.0)
    assert POSES["held"][0] == Pose.arms(58.0, 78.0)
    with pytest.raises(SimCoreError, match="none called 'asleep' – there are t, gown"):
        pose_named("asleep")


@pytest.mark.parametrize("joint", JOINTS[1:])
def test_every_joint_stops_on_every_axis(joint: str) -> None:
    for axis in range(3):
        for end, sign in zip(LIMITS[joint][axis], (-1.0, 1.0), strict=True):
            vector = [0.0, 0.0, 0.0]
            vector[axis] = end
            Pose.from_rotvecs({joint: vector}).check()
            vector[axis] = end + sign * 0.1
            with pytest.raises(
                SimCoreError, match=rf"pose: {joint} turned .* about {'xyz'[axis]} – give"
            ) as caught:
                Pose.from_rotvecs({joint: vector}).check()
            assert f"{end:g}" in str(caught.value)
            assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (lambda: Pose.from_rotvecs({"thumb": (0, 0, 0)}), "no joint 'thumb' – there are pelvis"),
        (lambda: Pose.from_rotvecs({"hip_l": (0, 0)}), "hip_l"),
        (lambda: Pose.from_rotvecs({"hip_l": (0, float("nan"), 0)}), "hip_l"),
        (lambda: Pose.from_rotvecs({}, (0, 2000, 0)), "shift"),
        (lambda: Pose.of({"shift": "far"}), "shift"),
        (lambda: Pose.arms(float("inf")), "arm"),
    ],
)
def test_what_is_no_pose_says_so_in_one_line(made, words: str) -> None:
    with pytest.raises(SimCoreError, match=words) as caught:
        made()
    assert "\n" not in str(caught.value)


def test_one_pose_over_another() -> None:
    whole = Pose.arms(45.0, 12.0).and_also(Pose.from_rotvecs({"elbow_l": (0.0, -30.0, 0.0)}, (0.0, 0.1, 0.0)))
    assert whole.vector("elbow_l") == pytest.approx((0.0, -30.0, 0.0))
    assert whole.vector("elbow_r") == pytest.approx((0.0, 12.0, 0.0))
    assert whole.shifted(y=0.2).shift == pytest.approx((0.0, 0.3, 0.0))
