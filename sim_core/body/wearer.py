"""A mannequin as what cloth meets: distance fields of its poses and motions, with hands that sleeves slide over."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim_core.body.beneath import BAND, HANDS, MARGIN, Beneath, Box, Surface
from sim_core.body.joints import JOINTS
from sim_core.body.mannequin import Mannequin
from sim_core.body.pose import Pose
from sim_core.cloth.contact import DistanceField, MovingGrid, Solid, hull_faces, moving_mesh
from sim_core.errors import SimCoreError
from sim_core.mesh.geometry import hull_girth

__all__ = ["Figure"]

NEAR = 0.01  # [m] above and below a height that a section of the trunk is taken from


@dataclass(frozen=True)
class Figure:
    """A mannequin, and the cell [m] of its fields.

    In them each hand is its convex hull as well: cloth catches on fingers, which no dresser would allow. half: the
    fields hold the left half and a little of the right, as a garment draped against its mirror image needs. The nodes
    of all fields lie at whole cells from the origin, so that fields of one pose agree and mirror images meet.
    """

    mannequin: Mannequin
    cell: float = 0.008

    @property
    def name(self) -> str:
        """Names the figure and its fields, whatever file they came from."""
        return f"{self.mannequin.name} {self.mannequin.digest()[:12]} cell {self.cell}"

    def mesh(self, pose: Pose) -> tuple[np.ndarray, np.ndarray]:
        """The posed figure: vertices (V, 3) [m], faces (F, 3)."""
        return self.mannequin.posed(pose), self.mannequin.faces

    def hands(self) -> tuple[np.ndarray, np.ndarray]:
        """Faces (H, 3) of the hulls of the left hand and of the right, on the figure's own vertices.

        Raises SimCoreError where a figure has no hands.
        """
        left, right = (self._hand(joint) for joint in ("wrist_l", "wrist_r"))
        return left, right

    def trunk(self) -> np.ndarray:
        """Vertices (T,) that are not of the arms: what a skirt goes round."""
        return np.flatnonzero(self.mannequin.trunk())

    def middle(self, pose: Pose, height: float) -> np.ndarray:
        """x and z (2,) [m] of the trunk's middle at a height [m], or at the next height where it has one."""
        trunk = self.mesh(pose)[0][self.trunk()]
        away = np.abs(trunk[:, 1] - height)
        near = trunk[away <= max(NEAR, float(away.min()))]
        return 0.5 * (near.min(0) + near.max(0))[[0, 2]]

    def girth(self, pose: Pose, height: float) -> float:
        """What a tape measure round the trunk says at a height [m]; 0 above and below it."""
        trunk = self.mesh(pose)[0][self.trunk()]
        near = trunk[np.abs(trunk[:, 1] - height) <= NEAR][:, [0, 2]]
        return hull_girth(near)

    def beneath(self, pose: Pose, *, half: bool = False) -> Beneath:
        """The posed figure as what lies beneath cloth."""
        vertices, faces = self.mesh(pose)
        hands = tuple(np.unique(hand).astype(np.int32) for hand in self.hands()[: 1 if half else 2])
        surface = Surface(vertices, faces, hands, hulls_thicker=HANDS)
        return Beneath((surface,), cell=self.cell, box=self._box(vertices[None], half))

    def field(self, pose: Pose, *, half: bool = False) -> DistanceField:
        """Signed distance [m] to the posed figure; BAND from its surface and beyond no more than that."""
        return self.beneath(pose, half=half).field()

    def moving(self, poses: Sequence[Pose], *, half: bool = False, beside: Solid | None = None) -> MovingGrid:
        """The figure going through the poses, one a key of a film frame (1/25 s), fields made as they are needed.

        beside: what stands still beside it, e.g. a floor: HalfSpace(). Raises SimCoreError where there is no pose, or
        one that its joints cannot do.
        """
        if not len(poses):
            raise SimCoreError("figure: no poses – give one for each frame")
        frames, hands = (
            np.stack([self.mannequin.posed(pose) for pose in poses]),
            self.hands()[: 1 if half else 2],
        )
        return moving_mesh(
            frames,
            self.mannequin.faces,
            cell=self.cell,
            band=BAND,
            hulls=hands,
            thicker=[HANDS] * len(hands),
            box=self._box(frames, half),
            beside=beside,
        )

    def _hand(self, joint: str) -> np.ndarray:
        points = np.flatnonzero(self.mannequin.weights[:, JOINTS.index(joint)] > 0.5)
        return points[hull_faces(self.mannequin.vertices[points])]

    def _box(self, frames: np.ndarray, half: bool) -> Box:
        """Around all frames (T, V, 3), to whole cells; of half the figure from two cells beyond the middle."""
        x0, y0, z0 = (self.cell * float(np.floor(c / self.cell)) for c in frames.min((0, 1)) - MARGIN)
        x1, y1, z1 = (self.cell * float(np.ceil(c / self.cell)) for c in frames.max((0, 1)) + MARGIN)
        return (-2 * self.cell if half else x0, y0, z0), (x1, y1, z1)
