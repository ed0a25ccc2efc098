"""What a moving figure does: how far planted feet slide, how deep they go into the floor, how near limbs come, and
whether a loop closes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from sim_core.body.joints import JOINTS
from sim_core.body.mannequin import Mannequin
from sim_core.body.motion.loop import Loop
from sim_core.body.motion.soles import sole_of
from sim_core.body.pose import Pose
from sim_core.body.skinning import SKINS
from sim_core.metrics import FAR, surface_distance, winding

__all__ = ["Clearances", "Ground", "Seam", "clearances", "ground", "seam"]

LOW = 0.5  # [m] below which a joint is where what hangs on it may reach the floor
TOUCHES = 0.003  # [m] above the floor a point of a sole touches it
NEAR = 0.08  # [m] beyond which a clearance is not told further
EDGE = 0.012  # [m] that the middle of a face may be away from where it is nearest
WITHIN = 0.5  # windings of a point within a limb
STEP = 1e-4  # [s] by which speeds and accelerations at a seam are taken
LIMBS = {
    "left hand": ("wrist_l",),
    "right hand": ("wrist_r",),
    "left forearm": ("elbow_l",),
    "right forearm": ("elbow_r",),
    "trunk and legs": ("pelvis", "spine_1", "spine_2", "spine_3", "hip_l", "hip_r", "knee_l", "knee_r"),
    "left leg": ("hip_l", "knee_l", "ankle_l", "toe_l"),
    "right leg": ("hip_r", "knee_r", "ankle_r", "toe_r"),
    "left arm": ("elbow_l", "wrist_l"),
    "right arm": ("elbow_r", "wrist_r"),
}
PAIRS = (
    ("left hand", "trunk and legs"),
    ("right hand", "trunk and legs"),
    ("left forearm", "trunk and legs"),
    ("right forearm", "trunk and legs"),
    ("left leg", "right leg"),
    ("left arm", "right arm"),
)
APART = 0.12  # [m] below the crotch that thighs are one limb each: above they are one body


@dataclass(frozen=True)
class Ground:
    """How feet meet the floor y = 0. slide [m]: furthest that a point of a sole goes along the floor while it touches
    it, of the left foot and of the right; deepest [m]: below the floor, of the whole figure; planted: share of the
    frames in which a foot touches, left and right."""

    slide: tuple[float, float]
    deepest: float
    planted: tuple[float, float]


@dataclass(frozen=True)
class Clearances:
    """Least signed distance [m] between limbs by pair, at most 0.08, below nought where one is within the other; and
    the frame of each."""

    least: dict[str, float]
    frame: dict[str, int]


@dataclass(frozen=True)
class Seam:
    """What jumps where a loop begins again, of all joints: place [m], speed [m/s], acceleration [m/s2]."""

    place: float
    speed: float
    acceleration: float


def ground(figure: Mannequin, poses: Sequence[Pose], up: float = TOUCHES) -> Ground:
    """How feet of poses with their root travelling meet the floor; up [m]: how near a point is that touches it."""
    soles = [sole_of(figure, side).vertices for side in "lr"]
    kept: dict[bytes, np.ndarray] = {}
    frames = np.zeros((len(poses), sum(map(len, soles)), 3))
    deepest = 0.0
    for row, pose in enumerate(poses):
        low = figure.skeleton.joints(pose)[:, 1] < LOW
        if low.tobytes() not in kept:
            kept[low.tobytes()] = np.flatnonzero(figure.weights[:, low].sum(1) > 0.0)
        points = _posed(figure, np.concatenate([*soles, kept[low.tobytes()]]), pose)
        frames[row] = points[: frames.shape[1]]
        deepest = max(deepest, -float(points[:, 1].min()))
    slides, planted = [], []
    for points in np.split(frames, [len(soles[0])], axis=1):
        touches = points[..., 1] <= up
        slides.append(_furthest(points[..., [0, 2]], touches))
        planted.append(float(touches.any(1).mean()))
    return Ground((slides[0], slides[1]), deepest, (planted[0], planted[1]))


def _posed(figure: Mannequin, vertices: np.ndarray, pose: Pose) -> np.ndarray:
    """Some vertices (N,) of the posed figure, (N, 3) [m]: what is far from the floor need not be posed."""
    return SKINS[figure.skin](figure.vertices[vertices], figure.weights[vertices], figure.skeleton, pose)


def _furthest(points: np.ndarray, touches: np.ndarray) -> float:
    """How far (T, N, 2) goes at most from where it came to touch, while it touches (T, N)."""
    since, most = points[0].copy(), 0.0
    for before, now, place in zip(touches[:-1], touches[1:], points[1:], strict=True):
        since[now & ~before] = place[now & ~before]
        kept = now & before
        if kept.any():
            most = max(most, float(np.linalg.norm(place[kept] - since[kept], axis=1).max()))
    return most


def clearances(figure: Mannequin, poses: Sequence[Pose]) -> Clearances:
    """How near hands and forearms come to trunk and legs, leg to leg and arm to arm, of the posed meshes."""
    limbs = {name: _limb(figure, name) for name in LIMBS}
    least = {" – ".join(pair): NEAR for pair in PAIRS}
    frame = dict.fromkeys(least, -1)
    for number, pose in enumerate(poses):
        vertices = figure.posed(pose)
        for first, second in PAIRS:
            key = f"{first} – {second}"
            found = min(
                _distance(vertices, limbs[first], limbs[second], least[key]),
                _distance(vertices, limbs[second], limbs[first], least[key])
                if "trunk" not in second
                else NEAR,
            )
            if found < least[key]:
                least[key], frame[key] = found, number
    return Clearances(least, frame)


def _limb(figure: Mannequin, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (N,) and faces (F, 3) that are of a limb alone."""
    joints = [JOINTS.index(joint) for joint in LIMBS[name]]
    own = figure.weights[:, joints].sum(1) > WITHIN
    if name.endswith("leg"):
        own &= figure.vertices[:, 1] < figure.marks["crotch"][1] - APART
    return np.flatnonzero(own), figure.faces[own[figure.faces].all(1)]


def _distance(
    vertices: np.ndarray,
    limb: tuple[np.ndarray, np.ndarray],
    other: tuple[np.ndarray, np.ndarray],
    least: float,
) -> float:
    """Least signed distance of a limb's vertices to another limb's faces, `least` where all are further."""
    points, faces = vertices[limb[0]], other[1]
    corners = vertices[faces]
    room = max(least, 0.0) + EDGE
    low, high = corners.min((0, 1)) - room, corners.max((0, 1)) + room
    points = points[((points >= low) & (points <= high)).all(1)]
    if not len(points):
        return least
    centres, normals = corners.mean(1), np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    away, nearest = KDTree(centres).query(points)
    behind = ((points - centres[nearest]) * normals[nearest]).sum(1) < 0.0
    chosen = (away < room) | behind
    if not chosen.any():
        return least
    points, behind = points[chosen], behind[chosen]
    signed = surface_distance(points, vertices, faces, limit=FAR)
    doubtful = np.flatnonzero(behind)
    inside = doubtful[winding(points[doubtful], vertices, faces) > WITHIN]
    signed[inside] = -signed[inside]
    return float(min(least, signed.min()))


def seam(figure: Mannequin, loop: Loop) -> Seam:
    """Whether a loop closes: joints just before and just behind the end of a loop, held in place."""
    around = np.array([-3, -2, -1, 0, 1, 2, 3]) * STEP
    before = _joints(figure, loop, loop.seconds + around[:4])
    after = _joints(figure, loop, around[3:])
    place = np.abs(before[3] - after[0]).max()
    speed = np.abs(_slope(before[::-1], -STEP) - _slope(after, STEP)).max()
    bend = np.abs(_bend(before[::-1]) - _bend(after)).max() / STEP**2
    return Seam(float(place), float(speed), float(bend))


def _joints(figure: Mannequin, loop: Loop, times: np.ndarray) -> np.ndarray:
    return np.stack([figure.skeleton.joints(pose) for pose in loop.at(figure, times, in_place=True)])


def _slope(values: np.ndarray, step: float) -> np.ndarray:
    """The speed at the first of four values, to third order."""
    return (-11 * values[0] + 18 * values[1] - 9 * values[2] + 2 * values[3]) / (6 * step)


def _bend(values: np.ndarray) -> np.ndarray:
    """The second difference at the first of four values, to second order."""
    return 2 * values[0] - 5 * values[1] + 4 * values[2] - values[3]
