"""Two bones and a foot: the hip, knee and ankle that bring a foot where it is wanted, knee over its toes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sim_core.body.joints import JOINTS
from sim_core.body.pose import Pose
from sim_core.body.skeleton import Skeleton

__all__ = ["Foothold", "legs_at", "pitched", "reach", "rotvec_of"]

STRAIGHT = -1.0  # [degrees] of the knee at least; a figure's legs are bent by ten where it is nought
MOST = 135.0  # [degrees] of the knee


@dataclass(frozen=True)
class Foothold:
    """Where a foot is wanted: ankle (3,) [m] and the foot's rotation (3, 3); hinge (3,): the knee's axis, to the left,
    else the foot's."""

    ankle: np.ndarray
    turn: np.ndarray
    hinge: np.ndarray | None = None


def pitched(yaw: float, pitch: float) -> np.ndarray:
    """The rotation (3, 3) of a foot that points `yaw` [rad] about +y from +z, its toes `pitch` [rad] down."""
    c, s, p, q = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
    return np.array([[c, s * q, s * p], [0.0, p, -q], [-s, c * q, c * p]])


def rotvec_of(turn: np.ndarray) -> np.ndarray:
    """Rotation vectors (..., 3) [degrees] of matrices (..., 3, 3)."""
    from scipy.spatial.transform import Rotation

    flat = Rotation.from_matrix(turn.reshape(-1, 3, 3)).as_rotvec(degrees=True)
    return flat.reshape(*turn.shape[:-2], 3)


def reach(skeleton: Skeleton, side: str, knee: float = STRAIGHT) -> float:
    """From hip to ankle [m] with the knee bent by degrees."""
    u, v = _bones(skeleton, side)
    return float(np.linalg.norm(u + _about_x(np.radians(knee)) @ v))


def legs_at(skeleton: Skeleton, pose: Pose, feet: Mapping[str, Foothold]) -> tuple[Pose, float]:
    """The pose with its legs turned so that the feet ("l", "r") are where they are wanted, and by how much [m] the
    furthest one is missed, being out of reach."""
    turns, shifts = skeleton.moves(Pose(pose.turns[:1] if _turned(pose) else (), pose.shift))
    pelvis, shift = turns[0], shifts[0]
    vectors: dict[str, np.ndarray] = {}
    missed = 0.0
    for side, wanted in feet.items():
        u, v = _bones(skeleton, side)
        way = wanted.ankle - (pelvis @ skeleton.heads[JOINTS.index(f"hip_{side}")] + shift)
        far = float(np.linalg.norm(way))
        bent = _knee(u, v, far)
        knee = _about_x(bent)
        local = u + knee @ v
        missed = max(missed, abs(far - float(np.linalg.norm(local))))
        hinge = wanted.turn[:, 0] if wanted.hinge is None else wanted.hinge
        thigh = _frame(way, hinge) @ _frame(local, np.array([1.0, 0.0, 0.0])).T
        vectors[f"hip_{side}"] = rotvec_of(pelvis.T @ thigh)
        vectors[f"knee_{side}"] = np.degrees([bent, 0.0, 0.0])
        vectors[f"ankle_{side}"] = rotvec_of((thigh @ knee).T @ wanted.turn)
    legs = Pose.from_rotvecs({joint: vector.tolist() for joint, vector in vectors.items()})
    kept = Pose(tuple(turn for turn in pose.turns if turn[0] not in vectors), pose.shift)
    return kept.and_also(legs), missed


def _turned(pose: Pose) -> bool:
    return bool(pose.turns) and pose.turns[0][0] == JOINTS[0]


def _bones(skeleton: Skeleton, side: str) -> tuple[np.ndarray, np.ndarray]:
    hip, knee, ankle = (skeleton.heads[JOINTS.index(f"{joint}_{side}")] for joint in ("hip", "knee", "ankle"))
    return knee - hip, ankle - knee


def _about_x(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def _knee(u: np.ndarray, v: np.ndarray, far: float) -> float:
    """The knee's bend [rad] at which hip and ankle are `far` [m] apart, as near as it can be."""
    # |u + Rx(a) v|2 = |u|2 + |v|2 + 2 (ux vx + p cos a + q sin a)
    p, q = u[1] * v[1] + u[2] * v[2], u[2] * v[1] - u[1] * v[2]
    wanted = 0.5 * (far * far - u @ u - v @ v) - u[0] * v[0]
    bent = np.arctan2(q, p) + np.arccos(np.clip(wanted / np.hypot(p, q), -1.0, 1.0))
    return float(np.clip(bent, np.radians(STRAIGHT), np.radians(MOST)))


def _frame(along: np.ndarray, left: np.ndarray) -> np.ndarray:
    """Axes (3, 3), in columns: along, what of left is square to it, and their cross product."""
    a = along / np.linalg.norm(along)
    b = left - (left @ a) * a
    b = b / np.linalg.norm(b)
    return np.stack([a, b, np.cross(a, b)], axis=1)
