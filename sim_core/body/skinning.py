"""How a surface goes with its joints: dual quaternions, linear blending, and linear arms on a body of the other.

Linear blending adds the moves of a vertex's joints by its weights; a sum of two rotations is shorter than either, so a
bent limb loses volume and folds sharply. Dual quaternions (Kavan, Collins, Zara and O'Sullivan 2008) add the moves as
screws and scale the sum back to one. README.md has the figures of both (`simcore bench figure`).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sim_core.body.joints import JOINTS, PARENTS, product
from sim_core.body.pose import Pose
from sim_core.body.skeleton import Skeleton

__all__ = ["LINEAR_JOINTS", "SKINS", "dual_quaternion_skin", "linear_arms_skin", "linear_skin"]

Skin = Callable[[np.ndarray, np.ndarray, Skeleton, Pose], np.ndarray]
ARMS = [number for number, name in enumerate(JOINTS) if name[:-2] in ("shoulder", "elbow", "wrist")]
REST = [number for number in range(len(JOINTS)) if number not in ARMS]


def linear_skin(vertices: np.ndarray, weights: np.ndarray, skeleton: Skeleton, pose: Pose) -> np.ndarray:
    """Posed vertices (V, 3) [m] of a surface at rest: weights (V, 21), their joints' moves added by them."""
    turns, shifts = skeleton.moves(pose)
    blended = weights @ np.concatenate([turns.reshape(-1, 9), shifts], axis=1)
    placed = (blended[:, :9].reshape(-1, 3, 3) @ vertices[..., None])[..., 0]
    return placed + blended[:, 9:]


def dual_quaternion_skin(
    vertices: np.ndarray, weights: np.ndarray, skeleton: Skeleton, pose: Pose
) -> np.ndarray:
    """Posed vertices (V, 3) [m] of a surface at rest: weights (V, 21), their joints' screws added by them."""
    real, dual = _screws(skeleton, pose)
    r, d = weights @ real, weights @ dual
    size = np.linalg.norm(r, axis=1, keepdims=True)
    r, d = r / size, d / size
    w, v = r[:, :1], r[:, 1:]
    turned = vertices + 2.0 * np.cross(v, np.cross(v, vertices) + w * vertices)
    return turned + 2.0 * (w * d[:, 1:] - d[:, :1] * v + np.cross(v, d[:, 1:]))


def linear_arms_skin(vertices: np.ndarray, weights: np.ndarray, skeleton: Skeleton, pose: Pose) -> np.ndarray:
    """As `dual_quaternion_skin`, but arms blended linearly, for a figure whose garments were draped on such arms."""
    share = weights[:, REST].sum(1)
    body, own = share > 0.0, np.zeros_like(weights)
    own[:, REST] = weights[:, REST]
    arms = weights - own
    out = linear_skin(vertices, arms, skeleton, pose)
    still = dual_quaternion_skin(vertices[body], own[body] / share[body, None], skeleton, pose)
    out[body] += share[body, None] * still
    return out


def _screws(skeleton: Skeleton, pose: Pose) -> tuple[np.ndarray, np.ndarray]:
    """The joints' moves as unit dual quaternions, (21, 4) each part; next to a joint's parent, not to its antipode."""
    shifts = skeleton.moves(pose)[1]
    real, dual = np.zeros((len(JOINTS), 4)), np.zeros((len(JOINTS), 4))
    for joint, (parent, own) in enumerate(zip(PARENTS, pose.quaternions(), strict=True)):
        real[joint] = own if parent < 0 else product(real[parent], own)
        if parent >= 0 and real[joint] @ real[parent] < 0.0:
            real[joint] = -real[joint]
        dual[joint] = 0.5 * product(np.r_[0.0, shifts[joint]], real[joint])
    return real, dual


SKINS: dict[str, Skin] = {"dual": dual_quaternion_skin, "linear arms": linear_arms_skin}
"""What a figure's file may name."""
LINEAR_JOINTS: dict[str, tuple[int, ...]] = {"dual": (), "linear arms": tuple(ARMS)}
"""Of each of them the joints whose moves are blended linearly; the others' as screws."""
