"""Where a figure's joints are, and where a pose takes what hangs on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.body.joints import JOINTS, PARENTS, matrix_of
from sim_core.body.pose import Pose

__all__ = ["Skeleton"]


@dataclass(frozen=True)
class Skeleton:
    """Where the joints are at rest: heads (21, 3) float64 [m], in the order of JOINTS."""

    heads: np.ndarray

    def moves(self, pose: Pose) -> tuple[np.ndarray, np.ndarray]:
        """Rotation (21, 3, 3) and shift (21, 3) [m] that take a point of each bone from rest into the pose."""
        turns, shifts = np.zeros((len(JOINTS), 3, 3)), np.zeros((len(JOINTS), 3))
        for joint, (parent, own) in enumerate(zip(PARENTS, matrix_of(pose.quaternions()), strict=True)):
            head = self.heads[joint]
            if parent < 0:
                turns[joint], place = own, head + pose.shift
            else:
                turns[joint] = turns[parent] @ own
                place = turns[parent] @ head + shifts[parent]
            shifts[joint] = place - turns[joint] @ head
        return turns, shifts

    def joints(self, pose: Pose) -> np.ndarray:
        """Where the joints are in the pose, (21, 3) [m]."""
        turns, shifts = self.moves(pose)
        return (turns @ self.heads[..., None])[..., 0] + shifts
