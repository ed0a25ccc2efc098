"""The shop figures: closed, mirrored, free of self-intersections in every pose by name, hands where they are asked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import KDTree

from sim_core import metrics
from sim_core.body import JOINTS, OTHER_SIDE, PARENTS, POSES, Mannequin, Pose
from sim_core.body.making import FIGURES, section, turn_between
from sim_core.errors import FileProblem, SimCoreError

FOLDER = Path(__file__).parents[2] / "assets" / "mannequins"
FILES = sorted(FOLDER.glob("*.npz"))


@pytest.fixture(scope="module", params=FILES, ids=[file.stem for file in FILES])
def figure(request: pytest.FixtureRequest) -> Mannequin:
    return Mannequin.load(request.param)


@pytest.fixture(scope="module")
def woman() -> Mannequin:
    return Mannequin.load(FOLDER / "woman.npz")


def test_women_and_men_of_the_statures_there_are() -> None:
    assert {file.stem for file in FILES} == set(FIGURES)
    assert sum(file.stat().st_size for file in FILES) <= 1_500_000
    assert sorted(made.stature for made in FIGURES.values()) == [1.50, 1.58, 1.61, 1.62, 1.67]
    for file in FILES:
        top = Mannequin.load(file).vertices[:, 1].max()
        assert (
            0.88 < top / FIGURES[file.stem].stature < 0.91
        )  # to the top of the neck; the head is a sixth more


def _volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6)


def test_the_figure_is_closed_small_and_stands_on_the_floor(figure: Mannequin) -> None:
    ahead = figure.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    there, back = (ahead[:, k] * len(figure.vertices) + ahead[:, 1 - k] for k in (0, 1))
    assert len(np.unique(there)) == len(there)  # no edge twice in one direction
    assert np.array_equal(np.sort(there), np.sort(back))  # and every one in the other
    most = 10_000 if figure.name.startswith("woman") else 10_500  # men's arms are longer
    assert len(np.unique(figure.faces)) == len(figure.vertices) <= most
    assert len(figure.vertices) - 3 * len(figure.faces) // 2 + len(figure.faces) == 2  # one ball, no handle
    assert figure.vertices[:, 1].min() == pytest.approx(0.0, abs=1e-5)
    assert 0.030 < _volume(figure.vertices, figure.faces) < 0.070  # [m3], outward


def test_left_and_right_are_mirror_images(figure: Mannequin) -> None:
    assert np.abs(figure.heads - (figure.heads * [-1.0, 1.0, 1.0])[list(OTHER_SIDE)]).max() < 1e-4
    for name in ("t", "display", "held"):
        x = figure.posed(POSES[name][0])
        far, twin = KDTree(x * [-1.0, 1.0, 1.0]).query(x)
        assert far.max() < 1.2e-4
        mirrored = figure.weights[twin][:, list(OTHER_SIDE)]
        assert np.abs(mirrored - figure.weights).max() < 1e-3


@pytest.mark.parametrize("name", POSES)
def test_no_pose_by_name_cuts_the_figure(figure: Mannequin, name: str) -> None:
    pose = figure.standing(POSES[name][0])
    x = figure.posed(pose)
    assert metrics.intersections(x, figure.faces) == 0
    assert x[:, 1].min() == pytest.approx(0.0, abs=1e-9)
    assert _volume(x, figure.faces) == pytest.approx(_volume(figure.vertices, figure.faces), rel=0.03)


def test_weights_are_shares_and_every_joint_moves_something(figure: Mannequin) -> None:
    assert figure.weights.shape == (len(figure.vertices), len(JOINTS))
    assert figure.weights.min() >= 0
    assert np.allclose(figure.weights.sum(1), 1)
    most = dict(zip(JOINTS, figure.weights.max(0), strict=True))
    limbs = ("neck", "shoulder", "elbow", "wrist", "hip", "knee", "ankle")
    assert min(share for name, share in most.items() if name.startswith(limbs)) > 0.95
    assert min(share for name, share in most.items() if not name.startswith("clavicle")) > 0.6
    assert min(most.values()) > 0.4  # clavicles share the chest with the spine
    shin = figure.vertices[:, 1] < 0.2
    legs = [JOINTS.index(f"{name}_{side}") for name in ("knee", "ankle", "toe") for side in "lr"]
    assert (figure.weights[shin][:, legs].sum(1) > 0.999).all()


def test_arms_lower_as_they_did_when_garments_were_draped_on_them(woman: Mannequin) -> None:
    """Seven bones, linear: hands with their forearms, all but the arms still (the figure of release 0.1)."""
    columns = {name: woman.weights[:, JOINTS.index(name)] for name in JOINTS}
    for arm, elbow in ((0.0, 0.0), (45.0, 12.0), (58.0, 78.0), (-10.0, 110.0), (80.0, 0.0), (33.3, 47.7)):
        expected = np.zeros_like(woman.vertices)
        still = np.ones(len(expected))
        for side, sign in (("l", 1.0), ("r", -1.0)):
            down, fore = np.radians(arm), np.radians(elbow)
            upper = np.array([sign * np.cos(down), -np.sin(down), 0.0])
            lower = np.cos(fore) * upper + np.array([0.0, 0.0, np.sin(fore)])
            shoulder, joint = (woman.heads[JOINTS.index(f"{name}_{side}")] for name in ("shoulder", "elbow"))
            raised = turn_between(np.array([sign, 0.0, 0.0]), upper)
            bent = turn_between(upper, lower) @ raised
            shift = shoulder - raised @ shoulder
            below = raised @ joint + shift - bent @ joint
            fist = columns[f"elbow_{side}"] + columns[f"wrist_{side}"]
            own = columns[f"shoulder_{side}"]
            expected += own[:, None] * (woman.vertices @ raised.T + shift)
            expected += fist[:, None] * (woman.vertices @ bent.T + below)
            still -= own + fist
        expected += still[:, None] * woman.vertices
        assert np.abs(woman.posed(Pose.arms(arm, elbow)) - expected).max() < 1e-9


@pytest.mark.parametrize(
    ("arm", "elbow"), [(0.0, 0.0), (30.0, 0.0), (45.0, 12.0), (58.0, 78.0), (20.0, 90.0)]
)
def test_arms_reach_the_direction_asked(figure: Mannequin, arm: float, elbow: float) -> None:
    marks, rest = figure.landmarks(Pose.arms(arm, elbow)), figure.landmarks()
    for side, sign in (("l", 1.0), ("r", -1.0)):
        shoulder, joint, wrist = (marks[f"{name}_{side}"] for name in ("shoulder", "elbow", "wrist"))
        upper, lower = joint - shoulder, wrist - joint
        down = np.degrees(np.arctan2(-upper[1], sign * upper[0]))
        assert down == pytest.approx(arm, abs=0.1)
        cosine = upper @ lower / np.linalg.norm(upper) / np.linalg.norm(lower)
        assert np.degrees(np.arccos(min(cosine, 1.0))) == pytest.approx(elbow, abs=0.1)
        assert elbow == 0 or lower[2] > 0
        for a, b in (("shoulder", "elbow"), ("elbow", "wrist"), ("wrist", "tip")):  # bones keep their length
            ends = [np.linalg.norm(m[f"{b}_{side}"] - m[f"{a}_{side}"]) for m in (marks, rest)]
            assert ends[0] == pytest.approx(ends[1], abs=1e-9)
        tip = np.linalg.norm(figure.posed(Pose.arms(arm, elbow)) - marks[f"tip_{side}"], axis=1).min()
        assert tip < 0.003  # the mesh follows its joints


def test_a_turned_and_shifted_root_takes_the_figure_as_a_whole(figure: Mannequin) -> None:
    pose = POSES["step"][0]
    there = figure.posed(pose.facing(90.0).shifted(x=2.0, z=-1.0))
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    root = figure.heads[0]
    expected = (figure.posed(pose) - root) @ turn.T + root + [2.0, 0.0, -1.0]
    assert np.abs(there - expected).max() < 1e-9


def test_landmarks_lie_in_the_figure_in_order(figure: Mannequin) -> None:
    marks = figure.landmarks()
    heights = [marks[name][1] for name in ("crotch", "hip", "waist", "bust", "shoulder_l", "nape", "top")]
    assert heights == sorted(heights)
    assert marks["nape"][2] < marks["neck"][2]
    bowed = figure.landmarks(Pose.from_rotvecs({"spine_1": (20.0, 0.0, 0.0)}))
    assert bowed["nape"][2] > marks["nape"][2] + 0.1  # the marks of the trunk go with it
    assert np.array_equal(bowed["hip"], marks["hip"])
    assert len(JOINTS) == len(PARENTS) == len(marks) - len(figure.marks) + 1 == 21  # "neck" is joint and mark


def test_no_anatomy_stands_out(figure: Mannequin) -> None:
    """From hip to collar the trunk's sections are convex within 3 mm: no cleft, no navel, no two breasts."""
    from scipy.spatial import ConvexHull

    marks = figure.landmarks()
    for y in np.arange(marks["crotch"][1] + 0.05, marks["bust"][1] + 0.01, 0.02):
        points = section(figure.vertices, figure.faces, float(y))
        hull = ConvexHull(points)
        depth = -(points @ hull.equations[:, :2].T + hull.equations[:, 2]).max(1)
        assert depth.max() < 0.003, f"hollow at {y:.2f} m"


def test_a_saved_figure_is_the_same(figure: Mannequin, tmp_path: Path) -> None:
    figure.save(tmp_path / "again.npz")
    again = Mannequin.load(tmp_path / "again.npz")
    assert np.array_equal(again.vertices, figure.vertices)
    assert np.allclose(again.weights, figure.weights, atol=2e-5)
    assert again.landmarks().keys() == figure.landmarks().keys()
    assert again.skin == figure.skin


def test_what_cannot_be_read_or_posed_says_so_in_one_line(woman: Mannequin, tmp_path: Path) -> None:
    with pytest.raises(FileProblem, match=r"none\.npz: no such file"):
        Mannequin.load(tmp_path / "none.npz")
    (tmp_path / "bad.npz").write_bytes(b"PK no archive")
    with pytest.raises(FileProblem, match=r"bad\.npz: not a mannequin"):
        Mannequin.load(tmp_path / "bad.npz")
    with (tmp_path / "other.npz").open("wb") as stream:
        np.savez(stream, format=np.array(99))
    with pytest.raises(FileProblem, match="another format"):
        Mannequin.load(tmp_path / "other.npz")
    for arm, elbow, word in ((90.0, 0.0, "shoulder_l turned -90"), (0.0, 150.0, "elbow_l turned -150")):
        with pytest.raises(SimCoreError, match=word) as caught:
            woman.posed(Pose.arms(arm, elbow))
        assert "\n" not in str(caught.value)
