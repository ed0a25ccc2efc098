"""The 21 joints of a figure, and rotations about them.

At rest a figure stands in T-pose, y up, +z its front, its left at +x, and the axes of every joint are those of the
world. A joint's rotation therefore needs no frame of its own: it turns all that hangs on the joint, first, about an
axis as it lies at rest; then the parent's turn follows.
"""

from __future__ import annotations

import numpy as np

__all__ = ["JOINTS", "OTHER_SIDE", "PARENTS", "matrix_of", "product", "unit"]

_TRUNK = {"pelvis": "", "spine_1": "pelvis", "spine_2": "spine_1", "spine_3": "spine_2", "neck": "spine_3"}
_ARM = {"clavicle": "spine_3", "shoulder": "clavicle", "elbow": "shoulder", "wrist": "elbow"}
_LEG = {"hip": "pelvis", "knee": "hip", "ankle": "knee", "toe": "ankle"}
_SIDES = {
    f"{name}_{side}": parent if parent in _TRUNK else f"{parent}_{side}"
    for limb in (_ARM, _LEG)
    for side in "lr"
    for name, parent in limb.items()
}

JOINTS: tuple[str, ...] = (*_TRUNK, *_SIDES)
"""Names, parents first; `_l` is the figure's own left."""
PARENTS: tuple[int, ...] = tuple(
    JOINTS.index(parent) if parent else -1 for parent in (*_TRUNK.values(), *_SIDES.values())
)
"""Index of each joint's parent, -1 for the pelvis."""
OTHER_SIDE: tuple[int, ...] = tuple(
    JOINTS.index(name[:-1] + {"l": "r", "r": "l"}[name[-1]])
    if name[-2] == "_" and name[-1] in "lr"
    else number
    for number, name in enumerate(JOINTS)
)
"""Index of each joint's twin on the other side, its own in the middle."""


def matrix_of(quaternion: np.ndarray) -> np.ndarray:
    """Rotations (..., 3, 3) of unit quaternions (..., 4), real part first."""
    w, x, y, z = np.moveaxis(np.asarray(quaternion, float), -1, 0)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def product(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The product (4,) of two quaternions: the rotation `second`, then `first`."""
    a, u, b, v = first[0], first[1:], second[0], second[1:]
    return np.r_[a * b - u @ v, a * v + b * u + np.cross(u, v)]


def unit(q: np.ndarray) -> tuple[float, float, float, float]:
    """A quaternion (4,) made one of a rotation, its real part not below nought."""
    w, x, y, z = (q / np.copysign(np.linalg.norm(q), q[0])).tolist()
    return w, x, y, z
