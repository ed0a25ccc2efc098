"""A figure from motion: joints of our own motions come back as the angles they were made of; a real clip is walked."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from sim_core.body import JOINTS, Loop, Mannequin, Pose, load_motion
from sim_core.body.motion import clearances, figure_from, ground
from sim_core.errors import SimCoreError
from sim_core.track import KINECT, TrackSettings, read_recording, track

ROOT = Path(__file__).parents[2]
CLIPS = ROOT.parent / "shared" / "data" / "motion"
CMU = {
    "Hips": "pelvis",
    "Spine": "spine_2",
    "Spine1": "spine_3",
    "Neck1": "neck",
    "Head": "head",
    **{
        f"{theirs}{bone}": f"{ours}_{theirs[0].lower()}"
        for theirs in ("Left", "Right")
        for bone, ours in (
            ("UpLeg", "hip"),
            ("Leg", "knee"),
            ("Foot", "ankle"),
            ("ToeBase", "toe"),
            ("Arm", "shoulder"),
            ("ForeArm", "elbow"),
            ("Hand", "wrist"),
        )
    },
}
SEEN = tuple(joint for joint in JOINTS if joint[:-2] not in ("wrist", "toe") and joint not in ("neck",))


@cache
def figure(name: str = "woman") -> Mannequin:
    return Mannequin.load(ROOT / "assets" / "mannequins" / f"{name}.npz")


@cache
def joints_of(name: str) -> tuple[tuple[Pose, ...], np.ndarray]:
    loop = load_motion(ROOT / "assets" / "motions" / f"{name}.toml")
    assert isinstance(loop, Loop)
    poses = loop.poses(figure())[:120]
    return poses, np.stack([figure().skeleton.joints(pose) for pose in poses])


def apart(first: tuple[Pose, ...], second: tuple[Pose, ...]) -> dict[str, np.ndarray]:
    """Angles (T,) [degrees] between the turns of each joint."""
    a, b = (np.array([pose.quaternions() for pose in poses]) for poses in (first, second))
    near = np.where((a * b).sum(2, keepdims=True) < 0.0, -b, b)
    angle = 4.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(a - near, axis=2), 0.0, 1.0))
    return {joint: np.degrees(angle[:, k]) for k, joint in enumerate(JOINTS)}


@pytest.mark.parametrize("name", ["walk", "turn", "salute", "raised-sleeve"])
def test_angles_come_back_from_joints(name: str) -> None:
    """Exactly as far as joints show them: what nothing hangs on is not seen, the spine's roll is shared evenly."""
    poses, joints = joints_of(name)
    back = figure_from(figure(), joints, JOINTS, rate=25, plant=False)
    assert back.scale == pytest.approx(1.0, abs=1e-9)
    assert back.clamped == {}
    again = np.stack([figure().skeleton.joints(pose) for pose in back.poses])
    assert np.abs(again - joints).max() < 1e-3  # [m]; of a toe that points down
    angles = apart(poses, back.poses)
    for joint in SEEN:
        assert angles[joint].max() < (
            6.0 if "spine" in joint else 2.0 if joint[:-2] in ("clavicle", "shoulder") else 0.7
        )


@pytest.mark.parametrize("name", ["walk", "turn", "salute", "raised-sleeve"])
def test_feet_are_found_to_stand_and_set_down(name: str) -> None:
    poses, joints = joints_of(name)
    back = figure_from(figure(), joints, JOINTS, rate=25)
    met = ground(figure(), back.poses)
    assert max(met.slide) < 0.003
    assert met.deepest < 0.001
    assert back.missed < 1e-6
    angles = apart(poses, back.poses)
    for joint in ("hip_l", "knee_l", "ankle_l", "hip_r", "knee_r", "ankle_r"):
        assert angles[joint][:-3].max() < 6.0  # what the last frames come down on is not in the clip
        assert np.median(angles[joint]) < 1.0
    assert min(back.stands) > 0.55


def test_another_figure_takes_the_motion_over_with_its_own_bones() -> None:
    _, joints = joints_of("walk")
    small = figure("woman-150")
    back = figure_from(small, joints, JOINTS, rate=25, rest=figure().heads)
    assert back.scale < 0.95
    met = ground(small, back.poses)
    assert max(met.slide) < 0.005
    assert met.deepest < 0.005
    way = back.poses[-1].shift[2] - back.poses[0].shift[2]
    assert way == pytest.approx(back.scale * (joints[-1, 0, 2] - joints[0, 0, 2]), rel=0.02)


def test_a_kinect_body_is_known_by_its_names() -> None:
    poses, joints = joints_of("raised-sleeve")
    at = {name: joints[:, k] for k, name in enumerate(JOINTS)}
    seen = {"SpineBase": at["pelvis"], "SpineMid": at["spine_3"], "Neck": at["neck"]}
    seen["SpineShoulder"] = 0.5 * (at["clavicle_l"] + at["clavicle_r"])
    for side, ours in (("Left", "l"), ("Right", "r")):
        for bone in ("Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle"):
            seen[f"{bone}{side}"] = at[f"{bone.lower()}_{ours}"]
        seen[f"Foot{side}"] = at[f"toe_{ours}"]
        seen[f"Thumb{side}"] = at[f"wrist_{ours}"] + 0.1  # passed over
    points = np.stack(list(seen.values()), axis=1)
    back = figure_from(figure(), points, tuple(seen), rate=25)
    again = np.stack([figure().skeleton.joints(pose) for pose in back.poses])
    for joint in ("wrist_l", "wrist_r", "elbow_l", "elbow_r"):
        away = np.linalg.norm(again[:, JOINTS.index(joint)] - at[joint], axis=1)
        assert away.max() < 0.06  # shoulders of a Kinect tell nothing of collar bones
    assert max(ground(figure(), back.poses).slide) < 0.005
    assert np.median(apart(poses, back.poses)["elbow_r"]) < 5.0


def test_turns_that_are_known_are_taken() -> None:
    poses, joints = joints_of("raised-sleeve")
    world = np.stack([figure().skeleton.moves(pose)[0] for pose in poses])
    turns = {joint: world[:, k] for k, joint in enumerate(JOINTS)}
    back = figure_from(figure(), joints, JOINTS, rate=25, turns=turns, plant=False)
    assert max(angle.max() for angle in apart(poses, back.poses).values()) < 1e-4


def test_a_joint_beyond_its_limit_is_clamped_and_told() -> None:
    bent = Pose.from_rotvecs({"knee_l": (-25.0, 0.0, 0.0)})
    joints = figure().skeleton.joints(Pose.from_rotvecs({"hip_l": (40.0, 0.0, 0.0)}))[None]
    back = figure_from(figure(), joints, JOINTS, rate=25, plant=False)
    assert back.clamped["hip_l"] == (pytest.approx(22.0, abs=0.1), 1)
    back.poses[0].check()
    assert bent.turns  # a knee cannot bend back: whatever is seen, poses are within limits
    odd = np.stack([figure().skeleton.joints(bent)] * 3)
    for pose in figure_from(figure(), odd, JOINTS, rate=25).poses:
        pose.check()


def test_a_straight_arm_keeps_its_roll() -> None:
    """Noise of a millimetre on an arm that hangs straight does not spin it."""
    pose = Pose.from_rotvecs({"shoulder_l": (0.0, -6.0, -70.0), "shoulder_r": (0.0, 6.0, 70.0)})
    still = np.stack([figure().skeleton.joints(pose)] * 40)
    noisy = still + np.random.default_rng(3).normal(scale=0.001, size=still.shape)
    back = figure_from(figure(), noisy, JOINTS, rate=25, plant=False)
    turns = np.array([pose.quaternions()[JOINTS.index("shoulder_l")] for pose in back.poses])
    step = 2.0 * np.degrees(np.arccos(np.clip(np.abs((turns[1:] * turns[:-1]).sum(1)), 0.0, 1.0)))
    assert step.max() < 5.0


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda p, n: (p[:, :5], n), r"joints: \(120, 5, 3\) – expected \(T, 21, 3\)"),
        (lambda p, n: (p, ("nose", *n[1:])), r"joints: no pelvis \(Kinect: SpineBase\) – a figure needs"),
        (
            lambda p, n: (np.where(np.arange(120)[:, None, None] == 7, np.nan, p), n),
            "pelvis in frame 7 is not finite",
        ),
        (lambda p, n: (p[:0], n), "T at least 1"),
    ],
)
def test_what_is_no_motion_is_refused(change, words: str) -> None:
    points, names = change(joints_of("salute")[1], JOINTS)
    with pytest.raises(SimCoreError, match=words):
        figure_from(figure(), points, names, rate=25)


def test_a_clip_of_one_frame_is_a_pose() -> None:
    _, joints = joints_of("walk")
    back = figure_from(figure(), joints[:1], JOINTS, rate=25)
    assert len(back.poses) == 1
    back.poses[0].check()


@pytest.mark.parametrize("every", [1, 4])
def test_a_real_walk_is_walked(every: int) -> None:
    """CMU 12_01 at 120 and at 30 frames a second: feet stand, nothing goes into the floor, no limb through another."""
    path = CLIPS / "cmu_12_01_walk.bvh"
    if not path.is_file():
        pytest.skip(f"{path.name} is not in {CLIPS}: a clip that does not belong to the project")
    names, places, rate = bvh_joints(path)
    kept = [k for k, name in enumerate(names) if name in CMU]
    points = places[:, kept]
    back = figure_from(
        figure(), points[1::every], tuple(CMU[names[k]] for k in kept), rate=rate / every, rest=points[0]
    )
    met = ground(figure(), back.poses)
    assert max(met.slide) < 0.005
    assert met.deepest < 0.005
    assert min(back.stands) > 0.4
    for pose in back.poses:
        pose.check()
    assert min(clearances(figure(), back.poses[:: 32 // every]).least.values()) > 0.0
    joints = np.stack([figure().skeleton.joints(pose) for pose in back.poses])
    way = np.ptp(joints[:, 0, 2]) / np.ptp(points[1::4, 0, 2])
    assert way == pytest.approx(back.scale, abs=0.02)


@pytest.mark.parametrize("every", [1, 2, 4])
def test_a_real_walk_is_walked_by_the_points_that_follow_it(every: int) -> None:
    """Of a Kinect's joints nobody knows the T-pose; this capture's knees snap straight as a foot leaves the floor."""
    path = CLIPS / "cmu_12_01_walk.bvh"
    if not path.is_file():
        pytest.skip(f"{path.name} is not in {CLIPS}: a clip that does not belong to the project")
    followed = track(read_recording(path), TrackSettings("none"))
    back = figure_from(figure(), followed.joints[::every], KINECT.joints, rate=120 / every)
    met = ground(figure(), back.poses)
    assert max(met.slide) < 0.005
    assert met.deepest < 0.005


def test_arms_leave_the_room_that_a_coat_needs() -> None:
    """An arm that swings along the trunk is held off it, smoothly; one that is far from it stays as it was seen."""
    near = [
        Pose.from_rotvecs({"shoulder_l": (0.0, 4.0 * np.sin(0.3 * k), -82.0), "shoulder_r": (0.0, 0.0, 35.0)})
        for k in range(40)
    ]
    joints = np.stack([figure().skeleton.joints(pose) for pose in near])
    seen, held = (
        figure_from(figure(), joints, JOINTS, rate=25, plant=False, room=room) for room in (0.0, 0.06)
    )
    assert seen.raised == (0.0, 0.0)
    pair = "left forearm – trunk and legs"
    assert clearances(figure(), seen.poses[::5]).least[pair] < 0.04
    assert (
        clearances(figure(), held.poses[::5]).least[pair] > 0.055
    )  # from vertices to the middles of faces: 60 mm
    assert 2.0 < held.raised[0] < 30.0
    assert held.raised[1] == 0.0
    assert [pose.vector("shoulder_r") for pose in held.poses] == [
        pose.vector("shoulder_r") for pose in seen.poses
    ]
    turned = np.array([pose.vector("shoulder_l") for pose in held.poses])
    was = np.array([pose.vector("shoulder_l") for pose in seen.poses])
    assert np.abs(np.diff(turned - was, axis=0)).max() < 2.0  # [degrees] a frame: nothing jerks
    assert held.cramped == 0.0
    for pose in held.poses:
        pose.check()


@pytest.mark.parametrize("name", ["woman", "man-167"])
@pytest.mark.parametrize("raised", [0.0, 40.0, 70.0])
def test_arms_that_are_far_from_the_trunk_stay(name: str, raised: float) -> None:
    pose = Pose.from_rotvecs({"shoulder_l": (0.0, 0.0, raised), "shoulder_r": (0.0, 0.0, -raised)})
    joints = figure(name).skeleton.joints(pose)[None]
    seen, held = (
        figure_from(figure(name), joints, JOINTS, rate=25, plant=False, room=r) for r in (0.0, 0.035)
    )
    assert held.raised == (0.0, 0.0)
    assert held.cramped == 0.0
    assert held.poses == seen.poses


def test_our_own_raised_sleeve_is_not_raised_further() -> None:
    poses, joints = joints_of("raised-sleeve")
    held = figure_from(figure(), joints[::8], JOINTS, rate=25, plant=False, room=0.035)
    assert held.raised == (0.0, 0.0)
    assert len(poses) > 8


def test_forearms_before_the_chest_stay_where_raising_gives_no_room() -> None:
    pose = Pose.from_rotvecs(
        {"shoulder_l": (0.0, -40.0, -70.0), "elbow_l": (0.0, -125.0, 0.0)}
        | {"shoulder_r": (0.0, 40.0, 70.0), "elbow_r": (0.0, 125.0, 0.0)}
    )
    joints = figure().skeleton.joints(pose)[None]
    seen, held = (figure_from(figure(), joints, JOINTS, rate=25, plant=False, room=r) for r in (0.0, 0.12))
    pairs = [pair for pair in clearances(figure(), seen.poses).least if pair.endswith("trunk and legs")]
    before, after = ([clearances(figure(), one.poses).least[pair] for pair in pairs] for one in (seen, held))
    assert len(pairs) == 4
    assert held.cramped > 0.0
    assert min(after) > min(before) - 0.002


@pytest.mark.parametrize("room", [np.nan, np.inf, -0.01, 0.3, "wide", None])
def test_a_room_without_meaning_is_refused(room: object) -> None:
    with pytest.raises(SimCoreError, match="room"):
        figure_from(figure(), joints_of("walk")[1][:1], JOINTS, rate=25, room=room)


@pytest.mark.parametrize(
    ("joint", "at"), [("knee_l", "hip_l"), ("elbow_r", "shoulder_r"), ("ankle_l", "knee_l")]
)
def test_bones_without_length_go_along(joint: str, at: str) -> None:
    _, joints = joints_of("walk")
    flat = joints.copy()
    flat[:, JOINTS.index(joint)] = flat[:, JOINTS.index(at)]
    whole, back = (figure_from(figure(), points, JOINTS, rate=25, plant=False) for points in (joints, flat))
    other = [name for name in JOINTS if name[-2:] != joint[-2:]]
    for one, two in zip(whole.poses, back.poses, strict=True):
        two.check()
        assert (
            np.abs(
                np.subtract([one.vector(name) for name in other], [two.vector(name) for name in other])
            ).max()
            < 1e-6
        )


def bvh_joints(path: Path) -> tuple[list[str], np.ndarray, float]:
    """Names, places (T, J, 3) [m] and frames a second of a BVH file."""
    words = path.read_text("utf-8").split()
    names: list[str] = []
    parents: list[int] = []
    offsets: list[list[float]] = []
    channels: list[list[str]] = []
    stack, at = [-1], 0
    while words[at] != "MOTION":
        word = words[at]
        if word in ("ROOT", "JOINT", "End"):
            names.append(words[at + 1] if word != "End" else f"{names[stack[-1]]}_end")
            parents.append(stack[-1])
            channels.append([])
            at += 2
        elif word == "{":
            stack.append(len(names) - 1)
            at += 1
        elif word == "OFFSET":
            offsets.append([float(c) for c in words[at + 1 : at + 4]])
            at += 4
        elif word == "CHANNELS":
            count = int(words[at + 1])
            channels[-1] = words[at + 2 : at + 2 + count]
            at += 2 + count
        else:
            if word == "}":
                stack.pop()
            at += 1
    count, step = int(words[at + 2]), float(words[at + 5])
    values = np.array(words[at + 6 :], float).reshape(count, -1)
    places, turns = np.zeros((count, len(names), 3)), np.zeros((count, len(names), 3, 3))
    column = 0
    for k, parent in enumerate(parents):
        turn, offset = np.tile(np.eye(3), (count, 1, 1)), np.tile(offsets[k], (count, 1))
        for channel in channels[k]:
            axis = "XYZ".index(channel[0])
            if channel.endswith("position"):
                offset[:, axis] = values[:, column]
            else:
                turn = turn @ about(axis, np.radians(values[:, column]))
            column += 1
        if parent < 0:
            places[:, k], turns[:, k] = offset, turn
        else:
            places[:, k] = places[:, parent] + (turns[:, parent] @ offset[..., None])[..., 0]
            turns[:, k] = turns[:, parent] @ turn
    return names, 0.056444 * places, 1.0 / step


def about(axis: int, angle: np.ndarray) -> np.ndarray:
    """Rotations (T, 3, 3) about a coordinate axis."""
    out = np.zeros((len(angle), 3, 3))
    b, c = (axis + 1) % 3, (axis + 2) % 3
    out[:, axis, axis] = 1.0
    out[:, b, b] = out[:, c, c] = np.cos(angle)
    out[:, b, c], out[:, c, b] = -np.sin(angle), np.sin(angle)
    return out
