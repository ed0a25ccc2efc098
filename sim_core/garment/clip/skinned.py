"""A figure that goes by its bones: its surface at rest, whose weights, and a pose a frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim_core.body import JOINTS, SKINS, Mannequin, Pose, Skeleton
from sim_core.errors import SimCoreError
from sim_core.garment.clip.drawn import Drawn

__all__ = ["Skinned"]

WHOLE = 65535  # weights are kept as shares of it


@dataclass(frozen=True)
class Skinned:
    """A surface and how it goes, frame by frame.

    name; faces (F, 3) int32; rest (V, 3) float64 [m] in the T-pose; weights (V, 21), rows sum to 1; heads (21, 3) [m];
    skin: one of SKINS; turns (T, 21, 4) float32, a unit quaternion a joint, and shifts (T, 3) float32 [m] of the root:
    the poses; drawn: what of a model goes with it.
    """

    name: str
    faces: np.ndarray
    rest: np.ndarray
    weights: np.ndarray
    heads: np.ndarray
    skin: str
    turns: np.ndarray
    shifts: np.ndarray
    drawn: tuple[Drawn, ...] = ()

    @staticmethod
    def of(
        figure: Mannequin,
        poses: Sequence[Pose],
        *,
        part: tuple[np.ndarray, np.ndarray] | None = None,
        drawn: tuple[Drawn, ...] = (),
    ) -> Skinned:
        """A figure in these poses, one a frame.

        part: numbers of the figure's vertices that are shown (V,) and faces (F, 3) of these; None: all of it.
        Rest, weights and turns are rounded as a file keeps them: by less than 0.02 mm of the posed surface.
        Raises SimCoreError where there is no pose.
        """
        if not len(poses):
            raise SimCoreError("clip: no poses – give one for each frame")
        kept, faces = (np.arange(len(figure.vertices)), figure.faces) if part is None else part
        shares = np.round(figure.weights[kept] * WHOLE)
        return Skinned(
            "figure",
            np.asarray(faces, np.int32),
            figure.vertices[kept].astype(np.float32).astype(float),
            shares / shares.sum(1, keepdims=True),
            figure.heads.astype(np.float32).astype(float),
            figure.skin,
            np.stack([pose.quaternions() for pose in poses]).astype(np.float32),
            np.array([pose.shift for pose in poses], np.float32).reshape(-1, 3),
            drawn,
        )

    @property
    def frames(self) -> int:
        """How many poses there are."""
        return len(self.turns)

    def pose(self, frame: int) -> Pose:
        """The pose of a frame."""
        turns = self.turns[frame].astype(float)
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        kept = [(joint, q) for joint, q in zip(JOINTS, turns, strict=True) if abs(q[1:]).max() > 0]
        shift = (float(c) for c in self.shifts[frame])
        return Pose(tuple((joint, _quaternion(q)) for joint, q in kept), _vector(*shift))

    def posed(self, frame: int) -> np.ndarray:
        """Vertices (V, 3) float64 [m] in a frame, blended as the figure's garments met it."""
        return SKINS[self.skin](self.rest, self.weights, Skeleton(self.heads), self.pose(frame))

    def frame_bytes(self, frame: int) -> bytes:
        """The pose of a frame as float32: 21 quaternions, then the shift."""
        return self.turns[frame].astype("<f4").tobytes() + self.shifts[frame].astype("<f4").tobytes()


def _quaternion(q: np.ndarray) -> tuple[float, float, float, float]:
    w, x, y, z = (float(c) for c in q)
    return w, x, y, z


def _vector(x: float, y: float, z: float) -> tuple[float, float, float]:
    return x, y, z
