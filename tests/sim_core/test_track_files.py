"""Motion files: any BVH hierarchy as scipy moves it, mapped to a Kinect's joints; arrays, streams, defects by line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from moving_people import NAMES, person

from sim_core.body import JOINTS
from sim_core.errors import FileProblem, SimCoreError
from sim_core.track import KINECT, MAPPINGS, load_mapping, read_bvh, read_recording

SMALL = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Chest
  {
    OFFSET 0 10 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 5 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.04
0 90 0 0 0 0 0 0 0
0 91 0 0 0 0 90 0 0
"""


def written(folder: Path, text: str, name: str = "clip.bvh") -> Path:
    path = folder / name
    path.write_text(text, "utf-8")
    return path


@pytest.mark.parametrize("order", ["ZYX", "ZXY", "XYZ", "YXZ", "YZX", "XZY"])
@pytest.mark.parametrize("everywhere", [False, True])
def test_forward_kinematics_agree_with_scipy(tmp_path: Path, order: str, everywhere: bool) -> None:
    dancer = person("dance", 1.0, seed=3)
    file = read_bvh(written(tmp_path, dancer.bvh(order, everywhere=everywhere)))
    places, turns = file.moved()
    numbers = [file.names.index(name) for name in NAMES]
    assert np.abs(places[:, numbers] * 0.01 - dancer.places()).max() <= 1e-9
    assert np.abs(turns @ turns.swapaxes(-1, -2) - np.eye(3)).max() <= 1e-12
    assert file.seconds == pytest.approx(1.0 / 30.0)


def test_position_channels_that_stay_at_nothing_are_ways_from_the_offset(tmp_path: Path) -> None:
    text = SMALL.replace("CHANNELS 3 Z", "CHANNELS 6 Xposition Yposition Zposition Z")
    for given, wanted in (("0 10 0", 100.0), ("0 0 0", 100.0), ("0 0.5 0", 100.5), ("0 10.5 0", 100.5)):
        rows = f"0 90 0 0 0 0 {given} 0 0 0\n"
        path = written(tmp_path, text.split("MOTION")[0] + "MOTION\nFrames: 1\nFrame Time: 0.04\n" + rows)
        places, _ = read_bvh(path).moved()
        assert places[0, 1, 1] == pytest.approx(wanted)


def test_end_sites_turn_with_their_joint(tmp_path: Path) -> None:
    file = read_bvh(written(tmp_path, SMALL))
    assert file.names == ("Hips", "Chest", "Chest/end")
    places, _ = file.moved()
    assert np.allclose(places[0, 2], [0.0, 105.0, 0.0])
    assert np.allclose(places[1, 2], [-5.0, 101.0, 0.0])


@pytest.mark.parametrize(
    ("old", "new", "place", "told"),
    [
        ("HIERARCHY", "HIERARCHIE", (1, 1), "HIERARCHY should stand"),
        ("  OFFSET 0 0 0", "  OFFSET 0 0", (5, 3), "the offset's z is meant"),
        (
            "Zrotation Xrotation Yrotation\n  JOINT",
            "Zrotation Wrotation Yrotation\n  JOINT",
            (5, 54),
            "Wrotation",
        ),
        ("CHANNELS 3 Zrotation Xrotation", "CHANNELS 3 Zrotation Zrotation", (9, 26), "a second time"),
        ("CHANNELS 3 Z", "CHANNELS x Z", (9, 14), "the number of channels"),
        ("JOINT Chest", "JOINT", (6, 8), "name of a joint"),
        ("End Site", "End Seite", (10, 9), "Site should stand"),
        ("Frames: 2", "Frames: two", (17, 9), "the number of frames"),
        ("Frames: 2", "Frames: 0", (17, 9), "no frames"),
        ("Frame Time: 0.04", "Frame Time: 0", (18, 13), "a frame time in seconds"),
        ("0 91 0 0 0 0 90 0 0", "0 91 0 0 zero 0 90 0 0", (20, 10), "'zero' is not a finite number"),
        ("0 91 0 0 0 0 90 0 0", "0 91 0 0 nan 0 90 0 0", (20, 10), "'nan' is not a finite number"),
        ("0 91 0 0 0 0 90 0 0", "0 91 0 0 0 0 90 0", (20, 17), "8 numbers – the hierarchy has 9"),
        ("0 91 0 0 0 0 90 0 0\n", "", (19, 19), "1 frames of numbers – 'Frames:' says 2"),
        ("Frames: 2", "Frames: " + 13 * "0" + 5000 * "9", (17, 9), "a whole number from 0 to 200000"),
        ("Frames: 2", "Frames: 7000000", (17, 9), "a whole number from 0 to 200000"),
        ("End Site\n    {\n", "End Site Tip\n", (11, 7), "{ should stand"),
    ],
)
def test_defects_are_told_with_line_and_column(
    tmp_path: Path, old: str, new: str, place: tuple, told: str
) -> None:
    assert old in SMALL
    path = written(tmp_path, SMALL.replace(old, new, 1))
    with pytest.raises(FileProblem) as caught:
        read_bvh(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: line {place[0]}, column {place[1]}: ")
    assert told in message
    assert "\n" not in message


def test_files_as_other_programs_write_them(tmp_path: Path) -> None:
    """Line ends of Windows and of an old Mac, names of end sites, brackets on the line of a name."""
    plain = read_bvh(written(tmp_path, SMALL))
    changed = (
        SMALL.replace("\n", "\r\n"),
        SMALL.replace("\n", "\r"),
        SMALL.replace("End Site", "End Site Head"),
        SMALL.replace("Hips\n{\n", "Hips { ")
        .replace("Chest\n  {\n", "Chest{")
        .replace("Site\n    {", "Site {"),
    )
    for text in changed:
        path = tmp_path / "other.bvh"
        path.write_bytes(text.encode())
        file = read_bvh(path)
        assert (file.names, file.channels) == (plain.names, plain.channels)
        assert np.array_equal(file.frames, plain.frames)


def test_what_would_not_fit_into_memory_is_refused_at_the_door(tmp_path: Path) -> None:
    deep = SMALL.replace("    End Site", "JOINT Chest { OFFSET 0 1 0\n" * 200 + "    End Site")
    deep = deep.replace("}\nMOTION", "}\n" * 200 + "}\nMOTION").replace("Frames: 2", "Frames: 100000")
    with pytest.raises(FileProblem, match="line 417, column 9: 100000 frames of 203 joints.*parts"):
        read_bvh(written(tmp_path, deep))
    short = deep.replace("100000", "2")
    assert len(set(read_bvh(written(tmp_path, short)).names)) == 203  # all but three are called Chest
    path, many = tmp_path / "long.npz", 200_001
    np.savez(
        path, joints=np.zeros((many, 25, 3), "i1"), joint_names=np.array(KINECT.joints), time=np.arange(many)
    )
    with pytest.raises(FileProblem, match=r"long.npz: time: 200001 frames – at most 200000"):
        read_recording(path)


def test_a_long_file_is_read(tmp_path: Path) -> None:
    """Longer than any text that is written by hand: a block after the other."""
    rows = "0 90 0 0 0 0 0 0 0\n" * 150_000
    file = read_bvh(written(tmp_path, SMALL.split("0 90")[0].replace("Frames: 2", "Frames: 150000") + rows))
    assert file.frames.shape == (150_000, 9)
    assert (file.frames == file.frames[0]).all()


@pytest.mark.parametrize("cut", range(0, len(SMALL), 17))
def test_a_file_cut_anywhere_is_refused_in_one_line(tmp_path: Path, cut: int) -> None:
    path = written(tmp_path, SMALL[:cut] or "\n")
    if len(SMALL) - cut < 3:  # the last digit's line end, and the last digit but one
        read_bvh(path)
        return
    with pytest.raises(FileProblem) as caught:
        read_bvh(path)
    assert "\n" not in str(caught.value)


def test_any_hierarchy_is_mapped_and_what_is_left_out_is_named(tmp_path: Path) -> None:
    walker = person("walk", 1.0)
    recording = read_recording(written(tmp_path, walker.bvh()))
    assert recording.skeleton is KINECT
    assert recording.left_out == ()
    places = walker.places()
    at = {name: places[:, NAMES.index(name)] for name in NAMES}
    own = {name: recording.joints[:, KINECT.joints.index(name)] for name in KINECT.joints}
    for kinect, source in (("SpineBase", "Hips"), ("ElbowLeft", "LeftForeArm"), ("KneeRight", "RightLeg")):
        assert np.abs(own[kinect] - at[source]).max() <= 1e-9
    middle = 0.5 * (at["LeftShoulder"] + at["RightShoulder"])
    assert np.abs(own["SpineShoulder"] - middle).max() <= 1e-9
    assert recording.step == pytest.approx(1.0 / 30.0, abs=1e-6)
    bare = read_recording(written(tmp_path, SMALL))  # hips and chest alone
    assert set(KINECT.joints) - set(bare.left_out) == {"SpineBase", "SpineMid"}
    assert any("ElbowLeft" in words for words in bare.told)
    assert np.isfinite(bare.joints).all()
    odd = read_recording(written(tmp_path, SMALL.replace("Hips", "alpha").replace("Chest", "beta")))
    assert any("first joint" in words for words in odd.told)


@pytest.mark.parametrize("unit", [1.0, 0.01, 0.001, 0.0254, 0.056444])
def test_the_unit_is_told_by_stature_or_given(tmp_path: Path, unit: float) -> None:
    walker = person("walk", 0.2)
    path = written(tmp_path, walker.bvh(unit=unit))
    assert np.abs(read_recording(path).joints - read_recording(path, unit=unit).joints).max() <= 1e-12
    tall = np.ptp(read_recording(path).joints[0, :, 1])
    assert 1.3 < tall < 1.9
    assert np.allclose(read_recording(path, unit=2.0 * unit).joints, 2.0 * read_recording(path).joints)


def test_every_mapping_names_joints_of_a_kinect_and_is_found_by_its_marks() -> None:
    for name in MAPPINGS:
        mapping = load_mapping(name)
        assert mapping.words
        assert set(mapping.joints) <= set(KINECT.joints)
    assert load_mapping("cmu").fits(("Hips", "LHipJoint", "LowerBack", "LeftFingerBase"))
    assert load_mapping("mixamo").fits(("mixamorig:Hips", "mixamorig:Spine"))
    assert load_mapping("figure").fits(JOINTS)
    assert not load_mapping("default").fits(JOINTS)
    assert set(KINECT.joints) - set(load_mapping("figure").joints) == {"ThumbLeft", "ThumbRight"}


def test_a_figure_has_hands_and_a_head_where_its_marks_are_given() -> None:
    names, marks = list(JOINTS), ["top", "tip_l", "tip_r"]
    places = np.arange(3.0 * (len(names) + 3)).reshape(1, -1, 3)
    mapping, time = load_mapping("figure"), np.zeros(1)
    bare = mapping.applied(names, places[:, : len(names)], time, 1.0)
    hands = {f"{part}{side}" for part in ("Hand", "HandTip", "Thumb") for side in ("Left", "Right")}
    assert set(bare.left_out) == {"Head"} | hands
    whole = mapping.applied([*names, *marks], places, time, 1.0)
    assert set(whole.left_out) == {"ThumbLeft", "ThumbRight"}
    of = dict(zip(KINECT.joints, whole.joints[0], strict=True))
    tip, wrist = places[0, -2], places[0, names.index("wrist_l")]
    assert np.array_equal(of["HandTipLeft"], tip)
    assert np.array_equal(of["HandLeft"], (tip + wrist) / 2)
    assert np.array_equal(of["Head"], places[0, -3])


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("words = 'x'", "joints: missing"),
        ("[joints]\nSpine = ['a']", "joints.Spine: no joint"),
        ("[joints]\nSpineMid = 3", "joints.SpineMid: 3 – a name"),
        ("unit = -1\n[joints]\nSpineMid = 'a'", "unit"),
        ("scale = 1\n[joints]\nSpineMid = 'a'", "scale: unknown key"),
        ("joints = ", "not valid TOML"),
        ("[joints]\nNeck = 'a + '", "joints.Neck: 'a . ' – a name is missing"),
        ("[joints]\nNeck = ['a', 'b if ']", "joints.Neck: 'b if ' – a name is missing"),
    ],
)
def test_mapping_files_say_what_is_wrong(tmp_path: Path, text: str, told: str) -> None:
    path = written(tmp_path, text, "own.toml")
    with pytest.raises(SimCoreError, match=told) as caught:
        load_mapping(str(path))
    assert "own.toml" in str(caught.value)
    with pytest.raises(FileProblem, match="no mapping"):
        load_mapping("nobody")


def test_frames_that_are_no_motion_are_left_out_and_told(tmp_path: Path) -> None:
    own = written(tmp_path, "skip = 1\n[joints]\nSpineBase = 'Hips'\n", "own.toml")
    two = read_recording(written(tmp_path, SMALL), str(own))
    assert len(two.time) == 1
    assert "left out: 1, no motion, as mapping 'own' says" in two.told[0]
    one = SMALL.replace("Frames: 2", "Frames: 1").replace("0 91 0 0 0 0 90 0 0\n", "")
    kept = read_recording(written(tmp_path, one), str(own))
    assert len(kept.time) == 1
    assert "all kept" in kept.told[0]


def test_arrays_are_read_by_the_names_of_joints(tmp_path: Path) -> None:
    random = np.random.default_rng(0)
    joints, path = random.normal(size=(4, 25, 3)), tmp_path / "clip.npz"
    joints[2, 3] = np.nan
    order = random.permutation(25)
    names = np.array(KINECT.joints)[order]
    np.savez(path, joints=joints[:, order], joint_names=names, time=np.arange(4) / 30.0)
    recording = read_recording(path)
    assert np.array_equal(recording.joints, joints, equal_nan=True)
    np.savez(
        path, joints=random.normal(size=(4, 21, 3)), joint_names=np.array(JOINTS), time=np.arange(4) / 30.0
    )
    assert "Head" in read_recording(path).left_out
    for wrong in ({"joints": joints[0]}, {"time": np.arange(3)}, {"joint_names": names[:5]}):
        np.savez(path, **({"joints": joints, "joint_names": names, "time": np.arange(4)} | wrong))
        with pytest.raises(FileProblem, match="joints"):
            read_recording(path)
    for wrong in ({"joints": joints + 1j}, {"time": np.array(["a", "b", "c", "d"])}):
        np.savez(path, **({"joints": joints, "joint_names": names, "time": np.arange(4)} | wrong))
        with pytest.raises(FileProblem, match=f"{next(iter(wrong))}: .*no numbers"):
            read_recording(path)
    np.savez(path, joints=joints, joint_names=names, time=np.array([0.0, np.inf, np.inf, 0.1]))
    assert read_recording(path).step == pytest.approx(0.1)
    np.savez(path, joints=joints)
    with pytest.raises(FileProblem, match="no array 'joint_names'"):
        read_recording(path)


ROWS = [
    (0.0, "SpineBase", 0.0, 1.0, 2.0, "tracked"),
    (0.0, "20", 0.0, 1.5, 2.0, "inferred"),
    (0.033, "SpineBase", 0.1, 1.0, 2.0, "2"),
    (0.033, "spineshoulder", 9.0, 9.0, 9.0, "NotTracked"),
    (0.033, "SpineBase", 0.2, 1.0, 2.0, "2"),
]


def test_streams_are_frames_of_rows(tmp_path: Path) -> None:
    head = "time, joint, x, y, z, state\n"
    text = head + "\n".join(",".join(map(str, row)) for row in ROWS) + "\n"
    rows = [dict(zip(("time", "joint", "x", "y", "z", "state"), row, strict=True)) for row in ROWS]
    base, top = 0, KINECT.joints.index("SpineShoulder")
    for path in (written(tmp_path, text, "s.csv"), written(tmp_path, json.dumps(rows), "s.json")):
        recording = read_recording(path)
        assert recording.time.tolist() == [0.0, 0.033, 0.033]  # a joint that comes again begins a frame
        assert recording.joints[:, base, 0].tolist() == [0.0, 0.1, 0.2]
        assert np.isfinite(recording.joints[0, top]).all()
        assert np.isnan(recording.joints[1:, top]).all()
        assert recording.truth is None
        assert any("HandTipLeft" in words for words in recording.told)
        small = read_recording(path, unit=0.001)
        assert np.allclose(small.joints, 0.001 * recording.joints, equal_nan=True)


def test_rows_of_a_time_are_one_frame_in_whatever_order_they_come(tmp_path: Path) -> None:
    """Joint by joint, or one row late; a time without a value belongs nowhere."""
    names = KINECT.joints[:4]
    rows = [(0.1 * frame, name, frame, k, 0.0) for k, name in enumerate(names) for frame in range(3)]
    for order in (rows, sorted(rows), [*sorted(rows)[1:], sorted(rows)[0]]):
        text = "time,joint,x,y,z\n" + "\n".join(",".join(map(str, row)) for row in order) + "\n"
        recording = read_recording(written(tmp_path, text, "s.csv"))
        assert recording.time.tolist() == pytest.approx([0.0, 0.1, 0.2])
        assert np.isfinite(recording.joints[:, : len(names)]).all()
        assert (recording.joints[:, 0, 0] == [0, 1, 2]).all()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "time,joint,x,y,z\n0,SpineBase,1,2,3\nnan,SpineBase,1,2,3\n",
            "line 3, column 1: time: nan – seconds",
        ),
        ("time,joint,x,y\n", "line 1, column 1: no z"),
        ("time,joint,x,y,z,colour\n", "line 1, column 18: 'colour'"),
        ("time,joint,x,y,z\n0,SpineBase,1,2\n", "line 2, column 15: 4 cells"),
        ("time,joint,x,y,z\n0,SpineBase,1, two,3\n", "line 2, column 16: y: 'two' is no number"),
        ("time,joint,x,y,z\n\n0,Tail,1,2,3\n", "line 3, column 3: joint: 'Tail'"),
        ("time,joint,x,y,z,state\n0,SpineBase,1,2,3,asleep\n", "line 2, column 19: state: 'asleep'"),
        ("time,joint,x,y,z\n", "no row"),
        ("\u00a0\n\u3000\n", "s.csv: the file is empty"),
        ("time,joint,x,y,z\n0,SpineBase,1e9,2,3\n", "s.csv: joints: beyond 1e+06 m"),
    ],
)
def test_defects_of_streams_are_told_with_line_and_column(tmp_path: Path, text: str, told: str) -> None:
    with pytest.raises(FileProblem) as caught:
        read_recording(written(tmp_path, text, "s.csv"))
    assert told in str(caught.value)
    high = {"time": 0, "joint": "Head", "x": 10**400, "y": 0, "z": 0}
    for rows in ({}, [3], [high], [{"time": 0}], [{"time": 0, "joint": "Head", "x": "a", "y": 0, "z": 0}]):
        with pytest.raises(FileProblem, match="s.json"):
            read_recording(written(tmp_path, json.dumps(rows), "s.json"))


def test_other_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileProblem, match="no motion file"):
        read_recording(written(tmp_path, "x", "clip.fbx"))
    with pytest.raises(FileProblem, match="give the path of"):
        read_recording(tmp_path / "none.bvh")
