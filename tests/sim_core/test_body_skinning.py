"""How surfaces go with joints: rigidly where one alone holds them; dual quaternions keep what linear blending loses."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim_core.body import JOINTS, POSES, Mannequin, Pose, dual_quaternion_skin, linear_skin
from sim_core.body.making import turn_between

FOLDER = Path(__file__).parents[2] / "assets" / "mannequins"


@pytest.fixture(scope="module", params=["woman-150", "man-167"])
def figure(request: pytest.FixtureRequest) -> Mannequin:
    return Mannequin.load(FOLDER / f"{request.param}.npz")


def _volume(x: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (x[faces[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6)


@pytest.mark.parametrize("skin", [linear_skin, dual_quaternion_skin])
@pytest.mark.parametrize("name", ["step", "salute"])
def test_what_one_joint_holds_goes_rigidly_with_it(figure: Mannequin, skin, name: str) -> None:
    pose = POSES[name][0].facing(150.0).shifted(1.0, 0.2, -3.0)
    nearest = figure.weights.argmax(1)
    posed = skin(figure.vertices, np.eye(len(JOINTS))[nearest], figure.skeleton, pose)
    turns, shifts = figure.skeleton.moves(pose)
    expected = (turns[nearest] @ figure.vertices[..., None])[..., 0] + shifts[nearest]
    assert np.abs(posed - expected).max() < 1e-12


@pytest.mark.parametrize("skin", [linear_skin, dual_quaternion_skin])
def test_at_rest_nothing_moves(figure: Mannequin, skin) -> None:
    posed = skin(figure.vertices, figure.weights, figure.skeleton, Pose())
    assert np.abs(posed - figure.vertices).max() < 1e-15


@pytest.mark.parametrize(
    ("joint", "vector"),
    [("elbow_l", (0.0, -90.0, 0.0)), ("hip_l", (-60.0, 0.0, 0.0)), ("wrist_l", (45.0, 0.0, 0.0))],
)
def test_dual_quaternions_lose_less_than_linear_blending(
    figure: Mannequin, joint: str, vector: tuple[float, float, float]
) -> None:
    pose, rest = Pose.from_rotvecs({joint: vector}), _volume(figure.vertices, figure.faces)
    lost = [
        rest - _volume(skin(figure.vertices, figure.weights, figure.skeleton, pose), figure.faces)
        for skin in (linear_skin, dual_quaternion_skin)
    ]
    assert lost[0] > 0
    assert abs(lost[1]) < 0.75 * lost[0]


def test_the_smallest_turn_is_a_rotation() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        a, b = rng.normal(size=(2, 3))
        turn = turn_between(a, b)
        assert np.allclose(turn @ turn.T, np.eye(3))
        assert np.allclose(turn @ a / np.linalg.norm(a), b / np.linalg.norm(b))
