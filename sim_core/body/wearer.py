"""A mannequin as what a robe is dressed on: distance fields of its poses, with hands that sleeves slide over."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np

from sim_core.body.beneath import Beneath, Surface
from sim_core.body.mannequin import Mannequin
from sim_core.body.pose import Pose
from sim_core.cloth.contact.distance_field import field_of

__all__ = ["Figure"]

MARGIN = 0.06  # [m] of the field around the figure
HANDS = ("hand_l", "hand_r")


@dataclass(frozen=True)
class Figure:
    """A mannequin, and the cell [m] of its fields. The fields hold its left half and a little of the right.

    In them each hand is its convex hull: cloth catches on fingers, which no dresser would allow.
    """

    mannequin: Mannequin
    cell: float = 0.008

    @property
    def name(self) -> str:
        """Names the figure and its fields, whatever file they came from."""
        m = self.mannequin
        digest = hashlib.sha256(
            m.vertices.tobytes() + m.faces.tobytes() + m.weights.tobytes() + m.heads.tobytes()
        )
        return f"{m.name} {digest.hexdigest()[:12]} cell {self.cell}"

    @property
    def origin(self) -> tuple[float, float, float]:
        """The lowest node of every field [m]."""
        low, _ = self._box()
        return low

    def _box(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """From two cells beyond the middle to the tip of the left hand; forearms may bend forward."""
        v = self.mannequin.vertices
        reach = float(v[:, 0].max()) + MARGIN
        low = (-2 * self.cell, -MARGIN, float(v[:, 2].min()) - MARGIN)
        return low, (reach, float(v[:, 1].max()) + MARGIN, float(v[:, 2].max()) + 0.25 + MARGIN)

    def field(self, pose: Pose) -> np.ndarray:
        """Signed distance (nx, ny, nz) float32 [m] of the posed figure; beyond 40 mm no more than that."""
        posed = self.mannequin.posed(pose.arm, pose.elbow)
        weights, bones = self.mannequin.weights, self.mannequin.bones
        hands = [posed[weights[:, bones.index(hand)] > 0.5] for hand in HANDS[:1]]
        made = field_of(
            posed, self.mannequin.faces, cell=self.cell, band=0.04, hulls=hands, box=self._box(), far=False
        )
        return made.values

    def beneath(self, pose: Pose) -> Beneath:
        """The whole posed figure as what lies beneath cloth; its nodes are those of `field` and their mirror images."""
        low, high = self._box()
        reach = self.cell * float(np.ceil(high[0] / self.cell))
        weights, bones = self.mannequin.weights, self.mannequin.bones
        hands = tuple(np.flatnonzero(weights[:, bones.index(hand)] > 0.5).astype(np.int32) for hand in HANDS)
        vertices, faces = self.mesh(pose)
        box = (-reach, low[1], low[2]), (reach, high[1], high[2])
        return Beneath((Surface(vertices, faces, hands),), cell=self.cell, box=box)

    def mesh(self, pose: Pose) -> tuple[np.ndarray, np.ndarray]:
        """The posed figure: vertices (V, 3) [m], faces (F, 3)."""
        return self.mannequin.posed(pose.arm, pose.elbow), self.mannequin.faces
