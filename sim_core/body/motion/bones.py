"""From points to turns: what each joint of a figure is turned by, when only points on a body are known.

A bone says where it points, not how it is rolled. Its roll comes from what hangs on it: the pelvis's from hips and
spine, the chest's from neck and collar bones or shoulders, an upper arm's and a thigh's from the plane in which elbow
and knee bend; where a limb is nearly straight and the plane is lost, from the foot, or from the roll it had before.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sim_core.body.joints import JOINTS, PARENTS
from sim_core.body.skeleton import Skeleton
from sim_core.errors import SimCoreError

__all__ = ["KINECT", "named_points", "turns_of"]

KINECT = {
    "SpineBase": "pelvis",
    "SpineMid": "spine_3",
    "SpineShoulder": "collar",
    "Neck": "neck",
    "Head": "head",
    **{
        f"{theirs}{side}": f"{ours}_{short}"
        for side, short in (("Left", "l"), ("Right", "r"))
        for theirs, ours in (
            ("Shoulder", "shoulder"),
            ("Elbow", "elbow"),
            ("Wrist", "wrist"),
            ("HandTip", "tip"),
            ("Hip", "hip"),
            ("Knee", "knee"),
            ("Ankle", "ankle"),
            ("Foot", "toe"),
        )
    },
}
"""Points of a Kinect v2 body by what they are called here."""
NEEDED = ("pelvis", "hip_l", "hip_r", "knee_l", "knee_r", "ankle_l", "ankle_r", "shoulder_l", "shoulder_r")
BENT = np.sin(np.radians(8.0))  # of a limb whose plane is known well; less of it counts for less
MOST_ROLL = 100.0  # [degrees] between the plane of a limb and what its roll was thought to be
STEEP = 0.4  # of a foot's length seen from above, below which its yaw is in doubt
OWN = (*JOINTS, "collar", "head", "tip_l", "tip_r")


def named_points(points: np.ndarray, names: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Points (T, 3) [m] by what they are called here: names of Kinect v2 and our own; others are passed over.

    Raises SimCoreError where one is missing without which a figure cannot be posed.
    """
    found = {KINECT.get(name, name): points[:, k] for k, name in enumerate(names)}
    found = {name: values for name, values in found.items() if name in OWN}
    if missing := [name for name in NEEDED if name not in found]:
        theirs = {ours: name for name, ours in KINECT.items()}
        raise SimCoreError(
            f"joints: no {missing[0]} (Kinect: {theirs.get(missing[0], 'none')}) – a figure needs {', '.join(NEEDED)}"
        )
    return found


def rest_points(skeleton: Skeleton) -> dict[str, np.ndarray]:
    """The same points (3,) [m] of a figure in T-pose; of hands and head only the direction counts."""
    rest = dict(zip(JOINTS, skeleton.heads, strict=True))
    rest["collar"] = 0.5 * (rest["clavicle_l"] + rest["clavicle_r"])
    rest["head"] = rest["neck"] + [0.0, 0.1, 0.0]
    for side in "lr":
        rest[f"tip_{side}"] = rest[f"wrist_{side}"] + 0.8 * (rest[f"wrist_{side}"] - rest[f"elbow_{side}"])
    return rest


def turns_of(
    skeleton: Skeleton, points: Mapping[str, np.ndarray], rest: Mapping[str, np.ndarray]
) -> np.ndarray:
    """Rotations (T, 21, 3, 3) of the joints against their parents, from points (T, 3) by name.

    rest: the points (3,) of the same body in T-pose, against which it turns; points that are left out keep their joint
    still.
    """
    count = len(points["pelvis"])
    world = np.tile(np.eye(3), (count, len(JOINTS), 1, 1))
    at = {name: k for k, name in enumerate(JOINTS)}
    upward = [name for name in ("spine_1", "spine_2", "spine_3", "collar", "neck") if name in points][:1]
    world[:, at["pelvis"]] = _fit(points, rest, "pelvis", ("hip_l", "hip_r", *upward))
    chest = ["neck", "clavicle_l", "clavicle_r"]
    if not set(chest) <= set(points):
        chest = ["neck", "collar", "shoulder_l", "shoulder_r"]
    origin = "spine_3" if "spine_3" in points else "pelvis"
    world[:, at["spine_3"]] = _fit(points, rest, origin, tuple(chest))
    _spread_spine(world, at, points, rest)
    world[:, at["neck"]] = _swung(world[:, at["spine_3"]], points, rest, "neck", "head")
    for side in "lr":
        _arm(world, at, points, rest, side)
        _leg(world, at, points, rest, side)
    local = world.copy()
    for joint, parent in enumerate(PARENTS):
        if parent >= 0:
            local[:, joint] = np.swapaxes(world[:, parent], 1, 2) @ world[:, joint]
    return local


def _fit(
    points: Mapping[str, np.ndarray], rest: Mapping[str, np.ndarray], origin: str, others: tuple[str, ...]
) -> np.ndarray:
    """Rotations (T, 3, 3) that take directions at rest best to those seen (Kabsch), each direction counting alike."""
    names = [name for name in others if name in points and name in rest]
    here = np.stack([points[name] - points[origin] for name in names], axis=1)
    there = np.stack([rest[name] - rest[origin] for name in names])
    here = here / np.maximum(np.linalg.norm(here, axis=2, keepdims=True), 1e-9)
    there = there / np.linalg.norm(there, axis=1, keepdims=True)
    u, _, vt = np.linalg.svd(np.einsum("tni,nj->tij", here, there))
    mirror = np.sign(np.linalg.det(u @ vt))
    u[:, :, 2] *= mirror[:, None]
    return u @ vt


def _spread_spine(
    world: np.ndarray, at: Mapping[str, int], points: Mapping[str, np.ndarray], rest: Mapping[str, np.ndarray]
) -> None:
    """The lower two joints of the spine: their bones where they are seen, and the turn between pelvis and chest shared
    evenly."""
    pelvis, chest = world[:, at["pelvis"]], world[:, at["spine_3"]]
    whole = _rotvec(np.swapaxes(pelvis, 1, 2) @ chest)
    for number, (name, end) in enumerate((("spine_1", "spine_2"), ("spine_2", "spine_3")), 1):
        world[:, at[name]] = pelvis @ _matrix(whole * number / 3.0)
        if {"spine_1", "spine_2"} <= set(points):
            world[:, at[name]] = _aligned(
                world[:, at[name]], rest[end] - rest[name], points[end] - points[name]
            )


def _swung(
    parent: np.ndarray,
    points: Mapping[str, np.ndarray],
    rest: Mapping[str, np.ndarray],
    begin: str,
    end: str,
) -> np.ndarray:
    """The parent's rotation, turned the shortest way until the bone points as it is seen to."""
    if begin not in points or end not in points:
        return parent
    return _aligned(parent, rest[end] - rest[begin], points[end] - points[begin])


def _arm(
    world: np.ndarray,
    at: Mapping[str, int],
    points: Mapping[str, np.ndarray],
    rest: Mapping[str, np.ndarray],
    side: str,
) -> None:
    collar, shoulder, elbow, wrist, tip = (
        f"{n}_{side}" for n in ("clavicle", "shoulder", "elbow", "wrist", "tip")
    )
    world[:, at[collar]] = _swung(world[:, at["spine_3"]], points, rest, collar, shoulder)
    parent = world[:, at[collar]]
    if elbow not in points or wrist not in points:
        for name in (shoulder, elbow, wrist):
            world[:, at[name]] = parent
        return
    bones = (points[elbow] - points[shoulder], points[wrist] - points[elbow])
    bend = np.array([0.0, -1.0, 0.0]) if side == "l" else np.array([0.0, 1.0, 0.0])
    at_rest = (rest[elbow] - rest[shoulder], rest[wrist] - rest[elbow])
    upper = _hinged(parent, at_rest, bend, bones, None)
    world[:, at[shoulder]] = upper
    fore = _aligned(upper, at_rest[1], bones[1])
    world[:, at[elbow]] = fore
    world[:, at[wrist]] = _swung(fore, points, rest, wrist, tip) if tip in points else fore


def _leg(
    world: np.ndarray,
    at: Mapping[str, int],
    points: Mapping[str, np.ndarray],
    rest: Mapping[str, np.ndarray],
    side: str,
) -> None:
    hip, knee, ankle, toe = (f"{n}_{side}" for n in ("hip", "knee", "ankle", "toe"))
    parent = world[:, at["pelvis"]]
    bones = (points[knee] - points[hip], points[ankle] - points[knee])
    foot = points[toe] - points[ankle] if toe in points else None
    at_rest = (rest[knee] - rest[hip], rest[ankle] - rest[knee])
    thigh = _hinged(parent, at_rest, np.array([1.0, 0.0, 0.0]), bones, foot)
    world[:, at[hip]] = thigh
    shank = _aligned(thigh, at_rest[1], bones[1])
    world[:, at[knee]] = shank
    ahead = np.cross(shank[:, :, 0], [0.0, 1.0, 0.0])
    turned = _unrolled(
        (rest[toe] - rest[ankle]) if foot is not None else np.array([0.0, 0.0, 1.0]), foot, ahead
    )
    world[:, at[ankle]] = world[:, at[toe]] = turned


def _unrolled(bone: np.ndarray, seen: np.ndarray | None, ahead: np.ndarray) -> np.ndarray:
    """Rotations (T, 3, 3) of a foot whose bone at rest (3,) points as it is seen (T, 3), not rolled over its edge.

    Where it points up or down, which says nothing of its yaw, it faces ahead (T, 3), as the shank does; and it lies
    flat where it is not seen.
    """
    d0 = bone / np.linalg.norm(bone)
    zero, yaw = np.zeros(len(ahead)), np.arctan2(ahead[:, 0], ahead[:, 2])
    pitch = zero
    if seen is not None:
        d = seen / np.maximum(np.linalg.norm(seen, axis=1, keepdims=True), 1e-12)
        pitch = np.arcsin(np.clip(-d[:, 1] / np.hypot(d0[1], d0[2]), -1.0, 1.0)) + np.arctan2(d0[1], d0[2])
        forth = np.sin(pitch) * d0[1] + np.cos(pitch) * d0[2]
        own = np.arctan2(d[:, 0], d[:, 2]) - np.arctan2(d0[0], forth)
        # The foot's own yaw counts in full where half of it is seen from above, and less where it is steep.
        share = np.minimum(1.0, (np.hypot(d[:, 0], d[:, 2]) / STEEP) ** 2)
        yaw = yaw + share * (np.mod(own - yaw + np.pi, 2.0 * np.pi) - np.pi)
    about_y = _matrix(np.degrees(np.stack([zero, yaw, zero], axis=1)))
    return about_y @ _matrix(np.degrees(np.stack([pitch, zero, zero], axis=1)))


def _hinged(
    parent: np.ndarray,
    rest: tuple[np.ndarray, np.ndarray],
    hinge: np.ndarray,
    bones: tuple[np.ndarray, np.ndarray],
    foot: np.ndarray | None,
) -> np.ndarray:
    """Rotations (T, 3, 3) of an upper bone, rolled until the lower one is reached by bending about the hinge alone.

    rest: both bones, and the hinge's axis, in T-pose; bones: both (T, 3) as seen; foot (T, 3): points where the knee
    does. Where the limb is nearly straight its plane says little: the hinge is square to the foot, or rolls as it did
    in the frame before.
    """
    u0, v0 = (bone / np.linalg.norm(bone) for bone in rest)
    upper = _along(bones[0], parent @ u0)
    lower = _along(bones[1], upper)
    swung = _aligned(parent, u0, upper)
    cosine = np.clip((upper * lower).sum(1), -1.0, 1.0)
    bent = _matrix(np.degrees(_bend(u0, v0, hinge, cosine))[:, None] * hinge) @ v0
    local, seen = np.cross(u0, bent), np.cross(upper, lower)
    sine = np.linalg.norm(seen, axis=1)
    clear = np.minimum(1.0, (np.linalg.norm(local, axis=1) / BENT) ** 2) * (sine > 1e-6)
    out, before = np.zeros_like(parent), None
    for row in range(len(upper)):
        if foot is not None and np.linalg.norm(np.cross(foot[row], lower[row])) > 0.2 * np.linalg.norm(
            foot[row]
        ):
            there = np.cross(foot[row], lower[row])
        elif before is not None:
            there = before @ hinge
        else:
            there = swung[row] @ hinge
        guess = _axes(upper[row : row + 1], there[None])[0] @ _axes(u0[None], hinge[None])[0].T
        if guess[:, 2] @ swung[row][:, 2] < 0.0 and foot is None:
            guess = swung[row]
        if clear[row] > 0.0:
            plane = (
                _axes(upper[row : row + 1], seen[row : row + 1])[0]
                @ _axes(u0[None], local[row : row + 1])[0].T
            )
            roll = _rotvec((plane @ guess.T)[None])[0]
            if (
                np.linalg.norm(roll) < MOST_ROLL
            ):  # a knee seen bent backward, by noise, says nothing of its plane
                guess = _matrix(clear[row] * roll[None])[0] @ guess
        out[row] = before = guess
    return out


def _along(bones: np.ndarray, instead: np.ndarray) -> np.ndarray:
    """Directions (T, 3) of bones; of those without length, which some bodies have, the ones given instead."""
    length = np.linalg.norm(bones, axis=1, keepdims=True)
    return np.where(length > 1e-9, bones / np.maximum(length, 1e-9), instead)


def _bend(u: np.ndarray, v: np.ndarray, hinge: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """Angles (T,) [rad] about the hinge by which v is turned where it has that cosine (T,) with u, bent forward."""
    flat = v - (v @ hinge) * hinge
    p, q, r = u @ flat, u @ np.cross(hinge, flat), (v @ hinge) * (u @ hinge)
    return np.arctan2(q, p) + np.arccos(np.clip((cosine - r) / np.hypot(p, q), -1.0, 1.0))


def _axes(along: np.ndarray, hinge: np.ndarray) -> np.ndarray:
    """Axes (T, 3, 3) in columns: along the bone, the hinge squared to it, and their cross product."""
    a = along / np.linalg.norm(along, axis=1, keepdims=True)
    b = hinge - (hinge * a).sum(1, keepdims=True) * a
    size = np.linalg.norm(b, axis=1, keepdims=True)
    if (size < 1e-9).any():  # a hinge along the bone says nothing: any across
        b = np.where(size < 1e-9, np.cross(a, np.eye(3)[np.abs(a).argmin(1)]), b)
        size = np.linalg.norm(b, axis=1, keepdims=True)
    b = b / size
    return np.stack([a, b, np.cross(a, b)], axis=2)


def _aligned(turn: np.ndarray, bone: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Rotations (T, 3, 3), turned on the shortest way until a bone at rest (3,) points as it is seen (T, 3)."""
    there = seen / np.maximum(np.linalg.norm(seen, axis=1, keepdims=True), 1e-12)
    here = turn @ (bone / np.linalg.norm(bone))
    axis = np.cross(here, there)
    sine, cosine = np.linalg.norm(axis, axis=1), (here * there).sum(1)
    angle = np.arctan2(sine, cosine)
    return _matrix(np.degrees(axis * (angle / np.maximum(sine, 1e-12))[:, None])) @ turn


def _rotvec(turns: np.ndarray) -> np.ndarray:
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(turns).as_rotvec(degrees=True)


def _matrix(vectors: np.ndarray) -> np.ndarray:
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(vectors, degrees=True).as_matrix()
