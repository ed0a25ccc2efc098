"""The shop figure: closed, mirrored, free of self-intersections in every pose shown, its hands where they are asked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import KDTree

from sim_core import metrics
from sim_core.body import BONES, Mannequin, turn_between
from sim_core.errors import FileProblem, SimCoreError

FILE = Path(__file__).parents[2] / "assets" / "mannequins" / "woman.npz"
POSES = ((0.0, 0.0), (45.0, 12.0), (58.0, 78.0))


@pytest.fixture(scope="module")
def woman() -> Mannequin:
    return Mannequin.load(FILE)


def _volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6)


def test_the_figure_is_closed_small_and_stands_on_the_floor(woman: Mannequin) -> None:
    ahead = woman.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    there, back = (ahead[:, k] * len(woman.vertices) + ahead[:, 1 - k] for k in (0, 1))
    assert len(np.unique(there)) == len(there)  # no edge twice in one direction
    assert np.array_equal(np.sort(there), np.sort(back))  # and every one in the other
    assert len(np.unique(woman.faces)) == len(woman.vertices) <= 10_000
    assert len(woman.vertices) - 3 * len(woman.faces) // 2 + len(woman.faces) == 2  # one ball, no handle
    assert FILE.stat().st_size <= 1_000_000
    assert woman.vertices[:, 1].min() == pytest.approx(0.0, abs=1e-5)
    assert 1.40 < woman.vertices[:, 1].max() < 1.50
    assert 0.030 < _volume(woman.vertices, woman.faces) < 0.055  # [m3], outward


def test_left_and_right_are_mirror_images(woman: Mannequin) -> None:
    for pose in POSES:
        x = woman.posed(*pose)
        far, twin = KDTree(x * [-1.0, 1.0, 1.0]).query(x)
        assert far.max() < 1e-4
        mirrored = woman.weights[twin][:, [0, 4, 5, 6, 1, 2, 3]]
        assert np.abs(mirrored - woman.weights).max() < 1e-3


@pytest.mark.parametrize("pose", POSES)
def test_no_pose_shown_cuts_itself(woman: Mannequin, pose: tuple[float, float]) -> None:
    assert metrics.intersections(woman.posed(*pose), woman.faces) == 0


def test_weights_are_shares_and_every_bone_moves_something(woman: Mannequin) -> None:
    assert woman.weights.shape == (len(woman.vertices), len(BONES))
    assert woman.weights.min() >= 0
    assert np.allclose(woman.weights.sum(1), 1)
    assert (woman.weights.max(0) > 0.95).all()
    low = woman.vertices[:, 1] < 0.9
    assert (woman.weights[low, 0] > 1 - 1e-4).all()  # legs and hips stay


@pytest.mark.parametrize(
    ("arm", "elbow"), [(0.0, 0.0), (30.0, 0.0), (45.0, 12.0), (58.0, 78.0), (20.0, 90.0)]
)
def test_arms_reach_the_direction_asked(woman: Mannequin, arm: float, elbow: float) -> None:
    marks, rest = woman.landmarks(arm, elbow), woman.landmarks()
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
        tip = np.linalg.norm(woman.posed(arm, elbow) - marks[f"tip_{side}"], axis=1).min()
        assert tip < 0.003  # the mesh follows its joints


def test_landmarks_lie_in_the_figure_in_order(woman: Mannequin) -> None:
    marks = woman.landmarks()
    heights = [marks[name][1] for name in ("crotch", "hip", "waist", "bust", "shoulder_l", "nape", "top")]
    assert heights == sorted(heights)
    assert marks["nape"][2] < marks["neck"][2]
    assert woman.parents == (-1, 0, 1, 2, 0, 4, 5)
    assert woman.bones == BONES


def test_no_anatomy_stands_out(woman: Mannequin) -> None:
    """From hip to collar the trunk's sections are convex within 3 mm: no cleft, no navel, no two breasts."""
    from scipy.spatial import ConvexHull

    from sim_core.body.making import section

    for y in np.arange(0.80, 1.18, 0.02):
        points = section(woman.vertices, woman.faces, float(y))
        hull = ConvexHull(points)
        depth = -(points @ hull.equations[:, :2].T + hull.equations[:, 2]).max(1)
        assert depth.max() < 0.003, f"hollow at {y:.2f} m"


def test_a_saved_figure_is_the_same(woman: Mannequin, tmp_path: Path) -> None:
    woman.save(tmp_path / "again.npz")
    again = Mannequin.load(tmp_path / "again.npz")
    assert np.array_equal(again.vertices, woman.vertices)
    assert np.allclose(again.weights, woman.weights, atol=2e-5)
    assert again.landmarks().keys() == woman.landmarks().keys()


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
    for arm, elbow, word in ((90.0, 0.0, "arm 90"), (0.0, 150.0, "elbow 150")):
        with pytest.raises(SimCoreError, match=word) as caught:
            woman.posed(arm, elbow)
        assert "\n" not in str(caught.value)


def test_the_smallest_turn_is_a_rotation() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        a, b = rng.normal(size=(2, 3))
        turn = turn_between(a, b)
        assert np.allclose(turn @ turn.T, np.eye(3))
        assert np.allclose(turn @ a / np.linalg.norm(a), b / np.linalg.norm(b))
