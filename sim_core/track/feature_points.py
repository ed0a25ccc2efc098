"""Dynamic feature points: the joints, and every bone halved again and again between them (Eq. 10-12)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.track.settings import MOST_LEVEL
from sim_core.track.skeletons import TrackedSkeleton
from sim_core.validation import integer, points

__all__ = ["Binding", "FeaturePoints", "feature_points"]


@dataclass(frozen=True)
class FeaturePoints:
    """X = W J. matrix (P, J) float64, W; torso (P,) bool: X1, the others are X2; ends (P, 2) the joints that a point
    lies between, twice the same for a joint; bone (P,) the bone whose rotation it has, -1: the trunk's."""

    matrix: np.ndarray
    torso: np.ndarray
    ends: np.ndarray
    bone: np.ndarray

    def of(self, joints: np.ndarray) -> np.ndarray:
        """Feature points (..., P, 3) of joints (..., J, 3)."""
        return self.matrix @ joints

    def unseen(self, joints_seen: np.ndarray) -> np.ndarray:
        """Whether a point hangs on a joint that was not seen, (..., P) bool, of joints (..., J) bool."""
        return ~(joints_seen[..., self.ends[:, 0]] & joints_seen[..., self.ends[:, 1]])


def feature_points(skeleton: TrackedSkeleton, level: int = 2) -> FeaturePoints:
    """The points of a skeleton: its joints, then those within each bone. Level 2 of a Kinect's 25 joints has 97.

    level: how often midpoints are put between neighbours, 0 to 6. A point is the torso's where both its ends are.
    """
    integer("level", level, 0, f"give 0 to {MOST_LEVEL} halvings of a bone", MOST_LEVEL)
    count = len(skeleton.joints)
    unit = np.eye(count)
    own = {int(child): bone for bone, (_, child) in enumerate(skeleton.bones)}
    rows, ends = list(unit), [(joint, joint) for joint in range(count)]
    bone_of = [own.get(joint, -1) for joint in range(count)]
    for bone, (parent, child) in enumerate(skeleton.bones):
        inner = [unit[parent], unit[child]]
        for _ in range(level):  # Eq. 10-12: a midpoint between every two neighbours
            middles = [(one + other) / 2.0 for one, other in zip(inner, inner[1:], strict=False)]
            inner = [row for pair in zip(inner, middles, strict=False) for row in pair] + inner[-1:]
        rows += inner[1:-1]
        ends += [(int(parent), int(child))] * (len(inner) - 2)
        bone_of += [bone] * (len(inner) - 2)
    trunk = set(skeleton.torso)
    torso = np.array([one in trunk and other in trunk for one, other in ends])
    return FeaturePoints(np.array(rows), torso, np.array(ends, np.int64), np.array(bone_of, np.int64))


@dataclass(frozen=True)
class Binding:
    """Points Y (P, 3) of something worn, each bound once to the feature point X of its number: offsets (P, 3) [m] in
    the frame of that point's bone at rest."""

    offsets: np.ndarray

    @staticmethod
    def at_rest(body: np.ndarray, worn: np.ndarray) -> Binding:
        """Binds worn points (P, 3) [m] to feature points (P, 3) [m], both at rest.

        Raises SimCoreError where they are not one to one.
        """
        body, worn = points("body", body), points("worn", worn)
        if body.shape != worn.shape:
            raise SimCoreError(
                f"worn: {len(worn)} points – give one for each of the {len(body)} feature points"
            )
        return Binding(worn - body)

    def carried(self, body: np.ndarray, turns: np.ndarray) -> np.ndarray:
        """Where the worn points are (..., P, 3): feature points (..., P, 3) and rotations of their bones
        (..., P, 3, 3) from rest."""
        return body + (turns @ self.offsets[..., None])[..., 0]
