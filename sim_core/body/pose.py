"""How a figure stands: a rotation a joint and where its root is; poses by name, between two, mirrored."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sim_core.body.joints import JOINTS, OTHER_SIDE, product
from sim_core.body.limits import check_limits
from sim_core.errors import SimCoreError
from sim_core.validation import excerpt, finite, instance_of, vector3

__all__ = ["POSES", "T_POSE", "Pose", "pose_named"]

Quaternion = tuple[float, float, float, float]
Vector = tuple[float, float, float]
_STILL: Quaternion = (1.0, 0.0, 0.0, 0.0)
_FARTHEST = 1000.0  # [m] of a root from the origin
KEYS = ("name", "joints", "shift")  # of a pose written as a table
_EVEN = 1e-9  # [rad, m] that a pose and its mirror image may differ by rounding


@dataclass(frozen=True)
class Pose:
    """Rotations of joints against the T-pose, and the way [m] of the root; of no joints: the T-pose itself.

    turns: joint and unit quaternion (real part first, that is not negative), in the order of JOINTS, without those
    that do not turn. A turn is about axes as they lie at rest, x to the figure's left, y up, z to its front; the
    pelvis's turns the whole figure about its pelvis. spread: how far its petticoat is, from 0, folded, to 1; no part of
    a table. Equal poses compare equal and hash alike.
    """

    turns: tuple[tuple[str, Quaternion], ...] = ()
    shift: Vector = (0.0, 0.0, 0.0)
    spread: float = field(default=1.0, repr=False)

    @staticmethod
    def of(table: Mapping[str, Any], where: str = "pose") -> Pose:
        """The pose that a file's table gives, its joints within their limits.

        name: of POSES, else the T-pose; joints: rotation vectors (3,) [degrees] by joint, instead of those that the
        name gives; shift: the way (3,) [m] of the root. `{ name = "display", joints = { elbow_l = [0, -30, 0] } }`.
        where: file and key of the table, for errors. Raises SimCoreError naming key, value, limit and remedy.
        """
        table = instance_of(where, table, Mapping, 'give a table, e.g. { name = "display" }')
        if unknown := [key for key in table if key not in KEYS]:
            raise SimCoreError(f"{where}: no key {excerpt(unknown[0])} – there are {', '.join(KEYS)}")
        base = pose_named(table["name"], f"{where}: name") if "name" in table else T_POSE
        remedy = "give a table of joint = [x, y, z] in degrees"
        joints = instance_of(f"{where}: joints", table.get("joints", {}), Mapping, remedy)
        turns = _turns(joints, f"{where}: joints")
        shift = _shift(table.get("shift", (0.0, 0.0, 0.0)), f"{where}: shift")
        pose = _posed(dict(base.turns) | turns, shift)
        pose.check(f"{where}: joints")
        return pose

    @staticmethod
    def from_rotvecs(
        vectors: Mapping[str, Sequence[float]], shift: Sequence[float] = (0.0, 0.0, 0.0)
    ) -> Pose:
        """The pose of rotation vectors (3,) [degrees] by joint and a root's way [m], whatever the joints' limits.

        Raises SimCoreError for what is none.
        """
        return _posed(_turns(vectors, "pose"), _shift(shift, "pose: shift"))

    @staticmethod
    def arms(arm: float = 0.0, elbow: float = 0.0) -> Pose:
        """Both upper arms `arm` degrees below horizontal, to the sides, forearms bent `elbow` degrees forward.

        Raises SimCoreError beyond the joints' limits.
        """
        arm, elbow = finite("pose: arm", arm), finite("pose: elbow", elbow)
        pose = Pose.from_rotvecs(
            {
                "shoulder_l": (0.0, 0.0, -arm),
                "elbow_l": (0.0, -elbow, 0.0),
                "shoulder_r": (0.0, 0.0, arm),
                "elbow_r": (0.0, elbow, 0.0),
            }
        )
        pose.check()
        return pose

    def table(self) -> dict[str, Any]:
        """The table that `of` reads: rotation vectors [degrees] by joint and, of a root that moved, its way [m]."""
        out: dict[str, Any] = {"joints": {joint: list(self.vector(joint)) for joint, _ in self.turns}}
        return out | {"shift": list(self.shift)} if any(self.shift) else out

    def turn(self, joint: str) -> Quaternion:
        """The rotation of a joint; that of one which does not turn is (1, 0, 0, 0)."""
        return dict(self.turns).get(joint, _STILL)

    def vector(self, joint: str) -> Vector:
        """The rotation vector [degrees] of a joint: its axis times its angle, 0 to 180."""
        w, *v = self.turn(joint)
        size = math.sqrt(sum(c * c for c in v))
        share = math.degrees(2.0 * math.atan2(size, w)) / size if size > 0.0 else 0.0
        return v[0] * share, v[1] * share, v[2] * share

    def quaternions(self) -> np.ndarray:
        """Rotations (21, 4) in the order of JOINTS."""
        turns = dict(self.turns)
        return np.array([turns.get(joint, _STILL) for joint in JOINTS])

    def check(self, where: str = "pose") -> None:
        """Raises SimCoreError, naming joint, angle and limit, where a joint is turned further than it goes."""
        for joint, _ in self.turns:
            check_limits(joint, self.vector(joint), where)

    def and_also(self, other: Pose) -> Pose:
        """This pose, the other's joints turned as there instead; the ways of both roots are added."""
        turns = dict(self.turns) | dict(other.turns)
        a, b = self.shift, other.shift
        return _posed(turns, (a[0] + b[0], a[1] + b[1], a[2] + b[2]), self.spread * other.spread)

    def shifted(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Pose:
        """This pose with its root so far [m] from where it was."""
        return self.and_also(Pose((), (x, y, z)))

    def facing(self, degrees: float) -> Pose:
        """This pose turned about the vertical through the pelvis, 0 = +z, 90 = +x."""
        turned = product(np.array(_turn((0.0, degrees, 0.0))), np.array(self.turn("pelvis")))
        return _posed(dict(self.turns) | {"pelvis": _unit(turned)}, self.shift, self.spread)

    def towards(self, other: Pose, share: float) -> Pose:
        """The pose a share of the way to another, each joint by the shortest turn, evenly (slerp)."""
        if share in (0.0, 1.0):
            return other if share else self
        turns = {
            joint: _between(self.turn(joint), other.turn(joint), share)
            for joint in {**dict(self.turns), **dict(other.turns)}
        }
        a, b = self.shift, other.shift
        shift = tuple((1.0 - share) * p + share * q for p, q in zip(a, b, strict=True))
        return _posed(turns, shift, (1.0 - share) * self.spread + share * other.spread)

    def mirrored(self) -> Pose:
        """What a looking glass at x = 0 shows."""
        turns = {}
        for joint, (w, x, y, z) in self.turns:
            turns[JOINTS[OTHER_SIDE[JOINTS.index(joint)]]] = (w, x, -y, -z)
        return _posed(turns, (-self.shift[0], self.shift[1], self.shift[2]), self.spread)

    @property
    def symmetric(self) -> bool:
        """Whether the pose is its own mirror image, so that half a garment can be draped against the other."""
        twin = self.mirrored()
        turned = np.abs((self.quaternions() * twin.quaternions()).sum(1))
        apart = np.linalg.norm(self.quaternions() - twin.quaternions(), axis=1)
        way = max(abs(a - b) for a, b in zip(self.shift, twin.shift, strict=True))
        return bool((np.where(turned > 0.5, 2.0 * apart, np.inf) <= _EVEN).all() and way <= _EVEN)


def _posed(turns: Mapping[str, Quaternion], shift: Sequence[float], spread: float = 1.0) -> Pose:
    """In the order of JOINTS, without what does not turn."""
    kept = tuple((joint, turns[joint]) for joint in JOINTS if turns.get(joint, _STILL) != _STILL)
    return Pose(kept, (float(shift[0]), float(shift[1]), float(shift[2])), spread)


def _shift(value: object, name: str) -> Vector:
    shift = vector3(name, value, "in metres")
    if max(abs(c) for c in shift) > _FARTHEST:
        raise SimCoreError(f"{name}: {excerpt(value)} – at most {_FARTHEST:g} m each way")
    return shift


def _turns(vectors: Mapping[str, Sequence[float]], where: str) -> dict[str, Quaternion]:
    """Quaternions by joint of rotation vectors (3,) [degrees]."""
    if unknown := [joint for joint in vectors if joint not in JOINTS]:
        raise SimCoreError(f"{where}: no joint {excerpt(unknown[0])} – there are {', '.join(JOINTS)}")
    return {joint: _turn(vector3(f"{where}: {joint}", v, "in degrees")) for joint, v in vectors.items()}


def _turn(degrees: Sequence[float]) -> Quaternion:
    """The quaternion of a rotation vector [degrees]."""
    size = math.sqrt(sum(c * c for c in degrees))
    if size == 0.0:
        return _STILL
    half = math.radians(size) / 2.0
    share = math.sin(half) / size
    return _unit((math.cos(half), share * degrees[0], share * degrees[1], share * degrees[2]))


def _unit(q: Sequence[float] | np.ndarray) -> Quaternion:
    """Of length 1, its real part not negative."""
    w, x, y, z = (float(c) for c in q)
    size = math.copysign(math.sqrt(w * w + x * x + y * y + z * z), w)
    return w / size, x / size + 0.0, y / size + 0.0, z / size + 0.0


def _between(a: Quaternion, b: Quaternion, share: float) -> Quaternion:
    """Spherical linear interpolation, the shorter way round."""
    p, q = np.array(a), np.array(b)
    if p @ q < 0.0:
        q = -q
    angle = 2.0 * math.atan2(float(np.linalg.norm(p - q)), float(np.linalg.norm(p + q)))
    if angle < 1e-9:
        return _unit((1.0 - share) * p + share * q)
    return _unit((math.sin((1.0 - share) * angle) * p + math.sin(share * angle) * q) / math.sin(angle))


T_POSE = Pose()
# Of the named poses the arms of the first ones are what shops and museums use; the last ones shift the weight.
_CONTRAPPOSTO = Pose.from_rotvecs(
    {
        "pelvis": (0.0, 6.0, -7.0),
        "spine_1": (0.0, -2.0, 5.0),
        "spine_2": (0.0, -4.0, 5.0),
        "spine_3": (0.0, -4.0, 2.0),
        "hip_l": (-18.0, 8.0, 6.0),
        "knee_l": (30.0, 0.0, 0.0),
        "ankle_l": (-12.0, 0.0, 0.0),
        "hip_r": (0.0, -4.0, 11.0),
        "ankle_r": (0.0, 0.0, -4.0),
    }
)
_STEP = Pose.from_rotvecs(
    {
        "pelvis": (2.0, -6.0, 0.0),
        "spine_1": (0.0, 3.0, 0.0),
        "spine_2": (0.0, 4.0, 0.0),
        "spine_3": (0.0, 4.0, 0.0),
        "hip_l": (-26.0, 6.0, 0.0),
        "knee_l": (8.0, 0.0, 0.0),
        "ankle_l": (4.0, 0.0, 0.0),
        "hip_r": (14.0, 2.0, 0.0),
        "knee_r": (22.0, 0.0, 0.0),
        "ankle_r": (8.0, 0.0, 0.0),
        "toe_r": (-22.0, 0.0, 0.0),
    }
)
_WALKING = Pose.from_rotvecs({"shoulder_l": (0.0, 22.0, -62.0), "shoulder_r": (0.0, 22.0, 62.0)})
_WALKING = _WALKING.and_also(Pose.from_rotvecs({"elbow_l": (0.0, -14.0, 0.0), "elbow_r": (0.0, 24.0, 0.0)}))

POSES: dict[str, tuple[Pose, str]] = {
    "t": (T_POSE, "arms straight out: cloth is laid on"),
    "gown": (Pose.arms(40.0, 8.0), "arms 40 degrees down: sleeves hang in full width"),
    "display": (Pose.arms(45.0, 12.0), "arms 45 degrees down, elbows 12 forward"),
    "held": (Pose.arms(58.0, 78.0), "forearms forward, for a scarf over them"),
    "arms-down": (Pose.arms(74.0, 10.0), "arms by the sides"),
    "contrapposto": (
        Pose.arms(62.0, 16.0).and_also(_CONTRAPPOSTO),
        "weight on the right leg, left knee bent",
    ),
    "step": (_STEP.and_also(_WALKING), "a step, left foot forward, arms swinging"),
    "salute": (
        Pose.from_rotvecs(
            {
                "spine_3": (6.0, 0.0, 0.0),
                "neck": (8.0, 0.0, 0.0),
                "clavicle_l": (0.0, -14.0, 0.0),
                "shoulder_l": (0.0, -52.0, -22.0),
                "elbow_l": (0.0, -58.0, 0.0),
                "clavicle_r": (0.0, 14.0, 0.0),
                "shoulder_r": (0.0, 52.0, 22.0),
                "elbow_r": (0.0, 58.0, 0.0),
            }
        ),
        "hands together before the chest (作揖)",
    ),
}
"""Poses by name, and what each is for. Where the feet come to is the figure's: `Mannequin.standing`."""


def pose_named(name: str, where: str = "pose") -> Pose:
    """The pose of that name; raises SimCoreError with the names there are."""
    if not isinstance(name, str) or name not in POSES:
        raise SimCoreError(f"{where}: none called {excerpt(name)} – there are {', '.join(POSES)}")
    return POSES[name][0]
