"""Belts, floors and motions of outfits: drawn to a length, trailed on, moved in."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim_core import metrics
from sim_core.body import Figure, Loop, Motion, Pose, pose_named
from sim_core.cli import main
from sim_core.cloth import Capsule
from sim_core.cloth.contact import solid_mesh
from sim_core.errors import FileProblem, SimCoreError
from sim_core.garment import Garment, Outfit, check_fits, dress, follow, load_outfit, move
from sim_core.garment.dressing import belt_pairs
from sim_core.metrics import winding

ASSETS = Path(__file__).parents[2] / "assets"
ROBE = """\
wearer = "mannequins/woman.npz"
pose = "t"
HEAD
[[layer]]
pattern = "patterns/robe.toml"
weave = "weaves/juan.toml"
edge = 0.05
MEASURES
[[layer.step]]
do = "sew"
seconds = 0.48
gravity = [0.0, 1.5]
damping = 6.0
friction = 0.0
[[layer.step]]
do = "weld"
[[layer.step]]
do = "settle"
seconds = 0.2
damping = 3.0
friction = 0.15
[[layer.step]]
do = "pose"
seconds = 0.6
damping = 2.5
friction = 0.1
CLOSE
[[layer.step]]
do = "rest"
seconds = 0.6
damping = 10.0
friction = 0.45
"""
BELT = '[[layer.step]]\ndo = "close"\nseconds = 0.4\ndamping = 3.0\nbelt = { length = 0.80 }\n'


def written(folder: Path, *, head: str = "", measures: str = "", close: str = "", pose: str = "") -> Path:
    text = ROBE.replace("HEAD", head).replace("MEASURES", measures).replace("CLOSE", close)
    path = folder / "it.toml"
    path.write_text(text.replace('pose = "t"', f'pose = "{pose}"', 1) if pose else text, "utf-8")
    return path


def of(folder: Path, **parts: str) -> Outfit:
    return load_outfit(written(folder, **parts), ASSETS)


THICK = 0.0025  # [m] of a layer


def clear(garment: Garment) -> bool:
    """Nothing is inside the wearer, but for vertices by less than a layer is thick: these robes of large triangles have
    not come to rest, and what the body would push through an upper layer it pushes later."""
    facts = garment.provenance["errors"]
    return facts["inside_midpoints"] + facts["inside_centroids"] == 0 and facts["clearance_m"][0] > -THICK


def ring(garment: Garment) -> float:
    """What the belt measures [m] where the garment lies."""
    assert garment.settled is not None
    holds = garment.settled.holds
    ends = garment.positions[holds.pairs]
    assert sorted(holds.pairs[:, 0]) == sorted(holds.pairs[:, 1])  # closed
    return float(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).sum())


def test_a_belt_goes_round_the_body_and_leaves_sleeves_out() -> None:
    """Two cloths round the body, one within the other, and one beside it."""
    parts, faces = [], []
    for radius, aside in ((0.20, 0.0), (0.15, 0.0), (0.08, 0.4)):
        tube, around = solid_mesh(Capsule((aside, 0.0, 0.0), (aside, 2.0, 0.0), radius), 48)
        faces.append(around + sum(map(len, parts)))
        parts.append(tube)
    x, cloth = np.concatenate(parts), np.concatenate(faces)
    pairs, ends = belt_pairs(x, cloth, np.array([0.0, 1.0, 0.0]), 1.0, 0.03)
    assert len(pairs) >= 12
    assert np.array_equal(pairs[1:, 0], pairs[:-1, 1])
    assert pairs[0, 0] == pairs[-1, 1]
    assert pairs.max() < len(parts[0])  # of the outermost alone
    assert ends.sum() == pytest.approx(1.0)
    _, loose = belt_pairs(x, cloth, np.array([0.0, 1.0, 0.0]), 9.0, 0.03)
    assert loose.sum() == pytest.approx(2 * np.pi * 0.2, rel=0.05)
    with pytest.raises(SimCoreError, match=r"no cloth goes round the wearer 3\.00 m above the floor"):
        belt_pairs(x, cloth, np.array([0.0, 3.0, 0.0]), 1.0, 0.03)


@pytest.mark.slow
def test_a_belt_is_drawn_to_its_length_and_holds(tmp_path: Path) -> None:
    it = of(tmp_path, close=BELT)
    (robe,) = dress(it)
    assert clear(robe)
    assert ring(robe) == pytest.approx(0.80, rel=0.02)
    assert it.wearer is not None
    waist = float(it.wearer.landmarks(it.pose)["waist"][1])
    assert robe.settled is not None
    belt = robe.positions[robe.settled.holds.pairs[:, 0]]
    assert (
        np.abs(belt[:, 1] - waist).max() < 0.2
    )  # between hips and arms: in cloth of 5 cm triangles it rides up
    way = belt - np.r_[0.0, 0.0, Figure(it.wearer).middle(it.pose, waist)[1]]
    angle = np.sort(np.arctan2(way[:, 0], way[:, 2]))
    assert np.diff(angle).max() < 1.0  # all the way round, sleeves left out
    after = follow(robe, seconds=0.2)
    assert ring(replace(robe, positions=after.positions)) == pytest.approx(0.80, rel=0.02)


@pytest.mark.slow
def test_what_lies_under_a_belt_is_held_there(tmp_path: Path) -> None:
    (robe,) = dress(of(tmp_path, close=BELT + '[[layer.step]]\ndo = "pin"\nat = ["belt"]\n'))
    assert clear(robe)
    assert robe.settled is not None
    under = np.unique(robe.settled.holds.pairs)
    assert set(robe.settled.last.pins) == set(under)
    after = follow(robe, seconds=0.2).positions
    assert np.array_equal(after[under], robe.positions[under])
    assert not np.array_equal(after, robe.positions)


def test_a_belt_shorter_than_the_wearer_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        SimCoreError,
        match=r"it\.toml: layer\.1\.step\.5\.belt\.length: 60\.0 cm, the wearer is .* cm round there – make",
    ):
        check_fits(of(tmp_path, close=BELT.replace("0.80", "0.60")))
    with pytest.raises(
        SimCoreError, match=r"layer\.1\.step\.5\.belt\.rise: 90\.0 cm from the waist there is nothing"
    ):
        check_fits(of(tmp_path, close=BELT.replace("0.80", "0.80, rise = 0.9")))
    with pytest.raises(
        FileProblem, match=r"layer\.1\.step\.5\.belt\.mark: no landmark 'wasit' – landmarks: "
    ):
        of(tmp_path, close=BELT.replace("length", 'mark = "wasit", length'))
    with pytest.raises(FileProblem, match=r"layer\.1\.step\.5\.belt: settle does not read it, only close"):
        of(tmp_path, close=BELT.replace('"close"', '"settle"'))


def test_a_belt_does_not_squeeze_what_is_worn_beneath(tmp_path: Path) -> None:
    """Said as soon as that is dressed: the robe beneath hangs, wider than the belt."""
    it = of(tmp_path, close=BELT)
    (robe,) = it.layers
    loose = replace(robe.program, steps=robe.program.steps[:4])
    within = replace(robe, name="within", program=loose)
    layers: set[int] = set()
    with pytest.raises(
        SimCoreError,
        match=r"layer\.2\.step\.5\.belt\.length: 80\.0 cm, round 'within' beneath it is \d{2,3}\.\d cm there – draw",
    ):
        dress(replace(it, layers=(within, robe)), on_frame=lambda frame: layers.add(frame.layer))
    assert layers == {0}


@pytest.mark.slow
def test_a_hem_that_is_longer_than_its_wearer_trails_on_the_floor(tmp_path: Path) -> None:
    it = of(tmp_path, measures="measures = { length = 1740 }\norigin = [10, 20]")
    (robe,) = dress(it)
    half = len(robe.panels) // 2
    assert (
        robe.origins == ((0.01, 0.02),) * half + ((-0.01, 0.02),) * half
    )  # as far from the middle on both sides
    assert clear(robe)
    assert robe.settled is not None
    assert robe.settled.beneath.floor
    assert robe.positions[:, 1].min() > 0.0
    lying = robe.positions[:, 1] < 0.03
    assert lying.sum() > 10
    assert robe.provenance["errors"]["area_strain_p95"] < 0.03
    robe.save(tmp_path / "robe.npz")
    again = Garment.load(tmp_path / "robe.npz")
    stood = follow(again, seconds=0.12)
    assert stood.positions[:, 1].min() > 0.0
    body = np.stack([it.wearer.posed(it.pose)] * 3)  # type: ignore[union-attr]
    assert follow(again, body, it.wearer.faces).positions[:, 1].min() > 0.0  # type: ignore[union-attr]


def test_a_floor_is_there_only_for_what_can_reach_it(tmp_path: Path) -> None:
    it = of(tmp_path)
    (layer,) = it.layers
    few = replace(layer.program, steps=layer.program.steps[:2])
    (robe,) = dress(replace(it, layers=(replace(layer, program=few),)))
    assert robe.settled is not None
    assert not robe.settled.beneath.floor


def test_a_figure_is_as_tall_as_its_outfit_says(tmp_path: Path) -> None:
    usual, taller = (of(tmp_path, head=head).wearer for head in ("", "size = 1.05"))
    assert usual is not None
    assert taller is not None
    assert np.ptp(taller.vertices, axis=0) == pytest.approx(1.05 * np.ptp(usual.vertices, axis=0))
    for name, place in usual.landmarks(pose_named("display")).items():
        assert taller.landmarks(pose_named("display"))[name] == pytest.approx(1.05 * place)
    assert usual.digest() != taller.digest()
    with pytest.raises(FileProblem, match=r"size: Input should be less than or equal to 2 \(found 3\.0\)"):
        of(tmp_path, head="size = 3.0")


MOTION = """\
[[key]]
seconds = 0.12
pose = { joints = { shoulder_l = [0.0, 0.0, -4.0] } }
[[key]]
seconds = 0.08
pose = { joints = { shoulder_l = [0.0, 0.0, -4.0], elbow_l = [0.0, -3.0, 0.0] } }
"""


def test_a_motion_goes_from_pose_to_pose(tmp_path: Path) -> None:
    (tmp_path / "wave.toml").write_text(MOTION, "utf-8")
    it = of(tmp_path, head=f'motion = "{tmp_path / "wave.toml"}"')
    assert it.motion is not None
    poses = it.motion.poses(it.pose)
    assert len(poses) == 6
    assert poses[0] == it.pose
    assert poses[3] == Pose.from_rotvecs({"shoulder_l": (0.0, 0.0, -4.0)})
    assert poses[5].vector("elbow_l") == pytest.approx((0.0, -3.0, 0.0))


def test_a_motion_that_cannot_be_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "wave.toml"
    head = f'motion = "{file}"'
    for text, words in (
        ("", "the file is empty"),
        ('[[key]]\npose = "display"\n', "key.1.seconds: Field required"),
        ('[[key]]\nseconds = 1.0\npose = "dsplay"\n', "key.1.pose: none called 'dsplay'"),
        (MOTION.replace("-3.0, 0.0] } }", "-170.0, 0.0] } }"), "elbow_l"),
    ):
        file.write_text(text, "utf-8")
        with pytest.raises(FileProblem, match=f"wave.toml: {words}|wave.toml.*{words}"):
            of(tmp_path, head=head)
    with pytest.raises(FileProblem, match="motion: no file nowhere.toml in "):
        of(tmp_path, head='motion = "nowhere.toml"')
    beyond = Motion(((0.08, Pose.from_rotvecs({"elbow_l": (0.0, -170.0, 0.0)})),))
    with pytest.raises(SimCoreError, match=r"motion\.1.*elbow_l"):
        beyond.poses(Pose())


def test_an_outfit_names_a_motion_that_repeats(tmp_path: Path) -> None:
    """The wearer comes into it from the pose of the outfit, then walks one whole loop on the spot."""
    it = of(tmp_path, head='motion = "motions/walk.toml"')
    assert isinstance(it.motion, Loop)
    poses = it.poses()
    lead, once = round(25 * it.motion.lead), len(it.motion.times())
    assert len(poses) == lead + once
    assert poses[0] == it.pose
    assert poses[lead].quaternions() == pytest.approx(poses[-1].quaternions(), abs=1e-9)
    with pytest.raises(SimCoreError, match="nobody moves"):
        of(tmp_path).poses()


def test_a_motion_of_the_command_needs_a_place_and_a_wearer(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, walk = written(tmp_path), ASSETS / "motions" / "walk.toml"
    for words, told in (
        (["--motion", str(walk)], "says how it moves – add --motion FILE.npz"),
        (["--motion", "a.npz", "--motion", "b.npz"], "give one FILE.toml and one FILE.npz at most"),
        (["--motion", "a.glb"], "name a file that ends in .npz"),
    ):
        assert main(["dress", str(path), "--content", str(ASSETS), *words]) == 2
        assert told in capsys.readouterr().err


@pytest.mark.slow
def test_layers_follow_the_motion_of_their_wearer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "wave.toml").write_text(MOTION, "utf-8")
    path = written(tmp_path, head=f'motion = "{tmp_path / "wave.toml"}"')
    names = ["--motion", str(tmp_path / "moved.npz"), "--out", str(tmp_path / "robe.npz")]
    assert main(["dress", str(path), "--content", str(ASSETS), *names]) == 0
    assert not list(tmp_path.glob("*.part*"))
    garment = Garment.load(tmp_path / "robe.npz")
    with np.load(tmp_path / "moved.npz") as data:
        body, robe, faces = data["wearer"], data["robe"], data["robe_faces"]
        solid = data["wearer_faces"]
    assert len(body) == len(robe) == 6
    assert np.array_equal(faces, garment.faces)
    assert robe[0] == pytest.approx(garment.positions, abs=1e-6)
    assert (winding(robe[-1].astype(float), body[-1].astype(float), solid) < 0.5).all()
    assert metrics.area_strain(garment.rest_corners(), robe[-1].astype(float), faces).max() < 0.1
    capsys.readouterr()
    still = written(tmp_path)
    assert main(["dress", str(still), "--content", str(ASSETS), *names]) == 2
    assert 'add motion = "motions/' in capsys.readouterr().err
    with pytest.raises(SimCoreError, match="nobody moves"):
        move(of(tmp_path), (garment,))
