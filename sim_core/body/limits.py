"""How far each joint of a figure turns, and one clear error where a pose asks for more.

A rotation is measured by its rotation vector: the axis it turns about, as it lies at rest, times the angle. Its three
parts [degrees] are the clinical angles where a joint moves in one plane, have no gimbal lock, and change sign as
mirrored joints do. Of a figure in T-pose, palms down, left side:

    x > 0   spine bent forward; thigh back, shank back, toes down;        arm and hand rolled forward
    y > 0   trunk turned to its left; leg turned outward;                 arm swung back
    z > 0   trunk bent to its right; leg out to its side; foot rolled in; arm raised

Ranges of elbow, shoulder, hip, knee and ankle: Soucie et al., Haemophilia 17 (2011) 500-507, ages 20 to 44 (hip 130
forward and 18 back, knee 140, foot 14 up and 60 down, elbow 145-150, forearm 80-90 each way). The others: handbook of
the American Academy of Orthopaedic Surgeons as compared by Boone and Azen, J. Bone Joint Surg. 61-A (1979) 756-759
(wrist 80 and 70, 20 and 30; hip 45 out, 30 in, 45 turned; neck 45, 45, 60; trunk 80 forward, 25 back, 35, 45).
The spine's are shared by its three joints, the forearm's roll by elbow and wrist. An arm is stopped by the trunk of a
shop figure 85 degrees below horizontal.
"""

from __future__ import annotations

import math

from sim_core.body.joints import JOINTS
from sim_core.errors import SimCoreError

__all__ = ["LIMITS", "check_limits"]

Range = tuple[float, float]
Vector = tuple[float, float, float]
SLACK = 1e-6  # [degrees] of rounding

_LEFT: dict[str, tuple[Range, Range, Range]] = {
    "pelvis": ((-180.0, 180.0), (-180.0, 180.0), (-180.0, 180.0)),  # the way the whole figure faces
    "spine_1": ((-10.0, 28.0), (-10.0, 10.0), (-13.0, 13.0)),
    "spine_2": ((-10.0, 28.0), (-15.0, 15.0), (-13.0, 13.0)),
    "spine_3": ((-10.0, 28.0), (-20.0, 20.0), (-13.0, 13.0)),
    "neck": ((-45.0, 45.0), (-60.0, 60.0), (-45.0, 45.0)),
    "clavicle": ((-30.0, 30.0), (-30.0, 25.0), (-10.0, 30.0)),
    "shoulder": ((-90.0, 90.0), (-130.0, 45.0), (-85.0, 90.0)),
    "elbow": ((-45.0, 45.0), (-145.0, 2.0), (-5.0, 5.0)),
    "wrist": ((-45.0, 45.0), (-20.0, 30.0), (-80.0, 70.0)),
    "hip": ((-130.0, 18.0), (-45.0, 45.0), (-30.0, 45.0)),
    "knee": ((-2.0, 140.0), (-10.0, 10.0), (-5.0, 5.0)),
    "ankle": ((-14.0, 60.0), (-20.0, 20.0), (-20.0, 35.0)),
    "toe": ((-70.0, 40.0), (-5.0, 5.0), (-5.0, 5.0)),
}


def _of(joint: str) -> tuple[Range, Range, Range]:
    """The left side's ranges, mirrored for the right."""
    if joint in _LEFT:
        return _LEFT[joint]
    x, y, z = _LEFT[joint[:-2]]
    return (x, y, z) if joint.endswith("_l") else (x, (-y[1], -y[0]), (-z[1], -z[0]))


LIMITS: dict[str, tuple[Range, Range, Range]] = {joint: _of(joint) for joint in JOINTS}
"""Least and most [degrees] of the rotation vector's x, y and z, of every joint."""


def check_limits(joint: str, vector: Vector, where: str = "pose") -> None:
    """Raises SimCoreError, naming joint, angle and limit, for a rotation vector [degrees] no body can do.

    A turn is within its limits if it is so one way round or the other: a shoulder's ranges have corners beyond 180.
    """
    if not (axis := _beyond(joint, vector)) or not _beyond(joint, _other_way(vector)):
        return
    low, high = LIMITS[joint]["xyz".index(axis)]
    angle = vector["xyz".index(axis)]
    raise SimCoreError(f"{where}: {joint} turned {angle:.1f} degrees about {axis} – give {low:g} to {high:g}")


def _beyond(joint: str, vector: Vector) -> str:
    """The first axis about which the joint is turned too far, "" for none."""
    for axis, angle, (low, high) in zip("xyz", vector, LIMITS[joint], strict=True):
        if not low - SLACK <= angle <= high + SLACK:
            return axis
    return ""


def _other_way(vector: Vector) -> Vector:
    """The same rotation the other way round."""
    x, y, z = vector
    share = 1.0 - 360.0 / (math.hypot(x, y, z) or 1.0)
    return x * share, y * share, z * share
