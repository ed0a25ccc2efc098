"""Dynamic feature points (Eq. 10-12): one constant matrix, trunk and limbs, and points that are bound to them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim_core.body import JOINTS
from sim_core.errors import SimCoreError
from sim_core.track import KINECT, Binding, feature_points, figure_skeleton


def test_a_kinect_has_25_joints_and_24_bones_from_the_trunk_outwards() -> None:
    assert len(KINECT.joints) == 25
    assert KINECT.joints[0] == "SpineBase"
    assert KINECT.joints[20] == "SpineShoulder"
    assert KINECT.joints[24] == "ThumbRight"
    assert sorted(KINECT.torso) == [0, 1, 4, 8, 12, 16, 20]
    reached = {KINECT.root}
    for parent, child in KINECT.bones:
        assert parent in reached
        reached.add(int(child))
    assert len(KINECT.bones) == 24
    assert reached == set(range(25))
    assert figure_skeleton().joints == JOINTS
    assert len(figure_skeleton().bones) == 20


@pytest.mark.parametrize(("level", "count"), [(0, 25), (1, 49), (2, 97), (3, 193), (4, 385)])
def test_each_level_halves_every_bone(level: int, count: int) -> None:
    points = feature_points(KINECT, level)
    assert points.matrix.shape == (count, 25)
    assert np.allclose(points.matrix.sum(1), 1.0, atol=0.0)
    joints = np.random.default_rng(0).normal(size=(4, 25, 3))
    found = points.of(joints)
    assert found.shape == (4, count, 3)
    assert np.array_equal(found[:, :25], joints)
    if level == 2:
        assert points.torso.sum() == 25
        assert (~points.torso).sum() == 72
    for bone, (parent, child) in enumerate(KINECT.bones):
        inner = found[:, (points.bone == bone) & (np.arange(count) >= 25)]
        steps = np.diff(
            np.concatenate([joints[:, parent, None], inner, joints[:, child, None]], axis=1), axis=1
        )
        assert np.allclose(steps, (joints[:, child] - joints[:, parent])[:, None] / 2**level, atol=1e-12)


def test_a_point_is_unseen_where_an_end_is() -> None:
    points = feature_points(KINECT, 1)
    seen = np.ones(25, bool)
    seen[KINECT.joints.index("ElbowLeft")] = False
    unseen = points.unseen(seen)
    assert unseen.sum() == 3  # the joint, and the middles of both its bones
    assert not points.unseen(np.ones((3, 25), bool)).any()


def test_worn_points_go_with_their_bones() -> None:
    points = feature_points(KINECT, 2)
    random = np.random.default_rng(1)
    rest = points.of(random.normal(size=(25, 3)))
    worn = rest + 0.02 * random.normal(size=rest.shape)
    binding = Binding.at_rest(rest, worn)
    turn, shift = Rotation.random(random_state=2).as_matrix(), np.array([1.0, 2.0, 3.0])
    moved = binding.carried(rest @ turn.T + shift, np.broadcast_to(turn, (97, 3, 3)))
    assert np.abs(moved - (worn @ turn.T + shift)).max() <= 1e-12
    with pytest.raises(SimCoreError, match="one for each of the 97"):
        Binding.at_rest(rest, worn[:5])
    with pytest.raises(SimCoreError, match="level"):
        feature_points(KINECT, 9)
