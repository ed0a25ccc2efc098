"""Skeletons that are followed: joints by name, what each hangs on, and which of them are the trunk's."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

__all__ = ["KINECT", "TrackedSkeleton", "figure_skeleton"]


@dataclass(frozen=True)
class TrackedSkeleton:
    """name; joints in the order that arrays have; parents: the number of what each hangs on, -1 for the root alone;
    torso: the numbers of the joints that move with the trunk (the paper's X1), three or more."""

    name: str
    joints: tuple[str, ...]
    parents: tuple[int, ...]
    torso: tuple[int, ...]

    @cached_property
    def bones(self) -> np.ndarray:
        """Bones (B, 2) int64, parent and child of each, outwards: a bone comes after those it hangs on."""
        depth = [0] * len(self.joints)
        for joint in self._outwards():
            parent = self.parents[joint]
            depth[joint] = depth[parent] + 1 if parent >= 0 else 0
        order = sorted((j for j, p in enumerate(self.parents) if p >= 0), key=lambda j: (depth[j], j))
        return np.array([(self.parents[joint], joint) for joint in order], np.int64)

    @cached_property
    def root(self) -> int:
        """The number of the joint that hangs on none."""
        return self.parents.index(-1)

    @cached_property
    def bone_names(self) -> tuple[str, ...]:
        """The name of the joint at the outer end of each bone."""
        return tuple(self.joints[child] for _, child in self.bones)

    def _outwards(self) -> list[int]:
        order, left = [self.root], set(range(len(self.joints))) - {self.root}
        while left:
            ready = sorted(joint for joint in left if self.parents[joint] not in left)
            order += ready
            left -= set(ready)
        return order


_KINECT = {
    "SpineBase": "",
    "SpineMid": "SpineBase",
    "Neck": "SpineShoulder",
    "Head": "Neck",
    "ShoulderLeft": "SpineShoulder",
    "ElbowLeft": "ShoulderLeft",
    "WristLeft": "ElbowLeft",
    "HandLeft": "WristLeft",
    "ShoulderRight": "SpineShoulder",
    "ElbowRight": "ShoulderRight",
    "WristRight": "ElbowRight",
    "HandRight": "WristRight",
    "HipLeft": "SpineBase",
    "KneeLeft": "HipLeft",
    "AnkleLeft": "KneeLeft",
    "FootLeft": "AnkleLeft",
    "HipRight": "SpineBase",
    "KneeRight": "HipRight",
    "AnkleRight": "KneeRight",
    "FootRight": "AnkleRight",
    "SpineShoulder": "SpineMid",
    "HandTipLeft": "HandLeft",
    "ThumbLeft": "WristLeft",
    "HandTipRight": "HandRight",
    "ThumbRight": "WristRight",
}
_KINECT_TRUNK = (
    "SpineBase",
    "SpineMid",
    "SpineShoulder",
    "ShoulderLeft",
    "ShoulderRight",
    "HipLeft",
    "HipRight",
)
_FIGURE_TRUNK = ("pelvis", "spine_1", "spine_2", "spine_3")
_FIGURE_TRUNK += tuple(f"{name}_{side}" for name in ("clavicle", "shoulder", "hip") for side in "lr")


def _numbers(names: tuple[str, ...], among: tuple[str, ...]) -> tuple[int, ...]:
    return tuple(among.index(name) if name else -1 for name in names)


_NAMES = tuple(_KINECT)
KINECT = TrackedSkeleton(
    "kinect", _NAMES, _numbers(tuple(_KINECT.values()), _NAMES), _numbers(_KINECT_TRUNK, _NAMES)
)
"""The 25 joints of a Kinect v2, in the order of its software; 24 bones."""


@lru_cache(maxsize=1)
def figure_skeleton() -> TrackedSkeleton:
    """The 21 joints of our own figure (`sim_core.body`, which is loaded only here)."""
    from sim_core.body.joints import JOINTS, PARENTS

    return TrackedSkeleton("figure", JOINTS, PARENTS, _numbers(_FIGURE_TRUNK, JOINTS))
