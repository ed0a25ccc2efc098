"""Arms held away from the trunk, as they are by whoever wears more than skin: cloth between them needs its room."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from sim_core.body.joints import JOINTS, matrix_of, product, unit
from sim_core.body.mannequin import Mannequin
from sim_core.body.motion.curves import spread
from sim_core.body.pose import Pose
from sim_core.validation import finite

__all__ = ["arms_apart"]

TRUNK = ("pelvis", "spine_1", "spine_2", "spine_3", "hip_l", "hip_r", "knee_l", "knee_r")
ARMPIT = 0.14  # [m] from the shoulder within which an arm is one with the trunk
DEEP = 0.06  # [m] behind a face from where on nothing is told: a limb's far side is behind faces at its rims, too
TRIED = np.arange(0.0, 31.0, 3.0)  # [degrees] that an arm is raised by
HALVINGS = 4  # of a step, till the angle is found: a fifth of a degree
HELPS = 0.002  # [m] that an arm has to gain where no angle gives it all of its room
MOST_ROOM = 0.2  # [m] that may be asked for
SMOOTH = 0.2  # [s] over which arms are raised and lowered


@dataclass(frozen=True)
class _Skin:
    """Faces by their middles (M, 3) [m] and normals (M, 3)."""

    tree: KDTree
    middles: np.ndarray
    normals: np.ndarray

    @staticmethod
    def of(corners: np.ndarray) -> _Skin:
        """Of faces' corners (M, 3, 3) [m]."""
        middles = corners.mean(1)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        return _Skin(KDTree(middles), middles, normals)

    def clearance(self, points: np.ndarray) -> float:
        """Least distance [m] of points (N, 3), below nought behind a face that is near."""
        away, nearest = self.tree.query(points)
        behind = ((points - self.middles[nearest]) * self.normals[nearest]).sum(1) < 0.0
        return float(np.where(behind & (away < DEEP), -away, away).min())


def arms_apart(
    figure: Mannequin, poses: Sequence[Pose], room: float, rate: float
) -> tuple[list[Pose], tuple[float, float], float]:
    """Poses whose arms keep `room` [m] from trunk and thighs; by how many degrees the left one and the right one were
    raised sideways at most, at the shoulder; and how much room [m] is still missing in the worst of them.

    rate: poses a second. Measured from vertices of the arm, a hand's breadth below the armpit and on, to the middles of
    faces. An arm that up to 30 degrees give less room takes the angle that gives most, and stays as it is where that
    hardly helps: one that lies before the chest. Arm against arm is not looked at. Without room all stay as they are.
    Raises SimCoreError for a room that is not 0 to 0.2 m.
    """
    if not finite("room [m]", room, least=0, most=MOST_ROOM):
        return list(poses), (0.0, 0.0), 0.0
    dominant = figure.weights.argmax(1)
    trunk = figure.faces[np.isin(dominant, [JOINTS.index(joint) for joint in TRUNK])[figure.faces].all(1)]
    arms = {side: _arm(figure, dominant, side) for side in "lr"}
    need = {side: np.zeros(len(poses)) for side in arms}
    for row, pose in enumerate(poses):
        vertices = figure.posed(pose)
        near = _Skin.of(vertices[trunk])
        turns, shifts = figure.skeleton.moves(pose)
        for side, arm in arms.items():
            shoulder = JOINTS.index(f"shoulder_{side}")
            pivot = turns[shoulder] @ figure.skeleton.heads[shoulder] + shifts[shoulder]
            axis = turns[JOINTS.index(f"clavicle_{side}")][:, 2] * (1.0 if side == "l" else -1.0)
            need[side][row] = _angle(vertices[arm] - pivot, pivot, axis, near, room)
    out, most = list(poses), []
    for side, angles in need.items():
        given = spread(angles, SMOOTH * rate) if angles.any() else angles
        out = [_raised(pose, side, float(angle)) for pose, angle in zip(out, given, strict=True)]
        most.append(float(given.max(initial=0.0)))
    return out, (most[0], most[1]), _short(figure, out, trunk, tuple(arms.values()), room)


def _short(
    figure: Mannequin, poses: Sequence[Pose], trunk: np.ndarray, arms: Sequence[np.ndarray], room: float
) -> float:
    """What is missing of the room at worst [m], in the poses as they are after all."""
    short = 0.0
    for pose in poses:
        vertices = figure.posed(pose)
        near = _Skin.of(vertices[trunk])
        short = max(short, *(room - near.clearance(vertices[arm]) for arm in arms))
    return short


def _arm(figure: Mannequin, dominant: np.ndarray, side: str) -> np.ndarray:
    """Vertices (N,) of an arm below its armpit."""
    own = np.isin(dominant, [JOINTS.index(f"{joint}_{side}") for joint in ("shoulder", "elbow", "wrist")])
    away = np.linalg.norm(figure.vertices - figure.skeleton.heads[JOINTS.index(f"shoulder_{side}")], axis=1)
    return np.flatnonzero(own & (away > ARMPIT))


def _angle(arm: np.ndarray, pivot: np.ndarray, axis: np.ndarray, near: _Skin, room: float) -> float:
    """By how many degrees an arm (N, 3) [m] about its pivot is to be turned about an axis."""

    def clearance(degrees: float) -> float:
        return near.clearance(arm @ matrix_of(_about(axis, degrees)).T + pivot)

    seen = [clearance(0.0)]
    for high in TRIED[1:]:
        if seen[-1] >= room:
            break
        seen.append(clearance(high))
    if seen[-1] < room:
        best = int(np.argmax(seen))
        return float(TRIED[best]) if seen[best] > seen[0] + HELPS else 0.0
    if len(seen) == 1:
        return 0.0
    low, high = TRIED[len(seen) - 2], TRIED[len(seen) - 1]
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if clearance(middle) >= room else (middle, high)
    return float(high)


def _about(axis: np.ndarray, degrees: float) -> np.ndarray:
    """The quaternion (4,) of a turn about a unit axis."""
    half = 0.5 * np.radians(degrees)
    return np.r_[np.cos(half), np.sin(half) * axis]


def _raised(pose: Pose, side: str, degrees: float) -> Pose:
    """The pose with an arm raised sideways from where it is."""
    if degrees == 0.0:
        return pose
    joint, axis = f"shoulder_{side}", np.array([0.0, 0.0, 1.0 if side == "l" else -1.0])
    turns = dict(pose.turns) | {joint: unit(product(_about(axis, degrees), np.array(pose.turn(joint))))}
    return Pose(tuple((name, turns[name]) for name in JOINTS if name in turns), pose.shift)
