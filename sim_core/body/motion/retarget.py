"""A figure from motion: points or turns of another body become poses of a figure with bones of its own.

Directions are taken over, lengths are the figure's; the root goes as far as its legs are long against the other's.
Feet that stand are found by how they roll (`soles`): what touches the floor of a foot that stands does not move. They
are set down on the floor, roll there without sliding, and the legs follow (`legs`); between stands they go back to
what was seen. Joints beyond their limits are clamped, and told.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import distance_transform_edt, gaussian_filter1d, minimum_filter1d

from sim_core.body.joints import JOINTS, PARENTS, product, unit
from sim_core.body.limits import LIMITS
from sim_core.body.mannequin import Mannequin
from sim_core.body.motion.arms import arms_apart
from sim_core.body.motion.bones import named_points, rest_points, turns_of
from sim_core.body.motion.curves import minimum_jerk, spread
from sim_core.body.motion.legs import Foothold, legs_at, pitched, reach, rotvec_of
from sim_core.body.motion.soles import Sole, sole_of
from sim_core.body.pose import Pose
from sim_core.errors import SimCoreError

__all__ = ["Retargeted", "figure_from"]

SIDES = ("l", "r")
HIGH = 0.03  # [m] above its lowest at which a sole does not stand, however still
LOW = 0.004  # [m] that a sole on the floor may seem above it
TOES = 0.15  # [m] from the ankle at which the speed of a turning foot is taken
STILL = 0.03  # [s] over which speeds are smoothed
SLOW = 0.30  # [m/s] of what touches the floor of a foot that stands, per leg of 0.75 m
STAND = 0.12  # [s] that a foot stands at least
GAP = 0.07  # [s] for which it may seem not to
EASE = 0.20  # [s] in which a foot goes over from where it was set to where it was seen
LEG = 0.75  # [m]
STRIDE = 1.4  # [s] within which a foot is on the floor once
CLEAR = 0.012  # [m] that a swinging sole is above the floor at least
CLEAR_IN = 0.035  # [s] in which it comes to be
SMOOTH = 0.08  # [s] over which a root is lowered and a heel lifted
LIFTS = 6  # times that heels are lifted at most


@dataclass(frozen=True)
class Retargeted:
    """poses: of every frame; scale: the figure's legs against the other body's; clamped: joint -> most degrees by which
    it was turned beyond its limits, and in how many frames; stands: share of the frames in which the left foot and the
    right stand; missed [m]: most that a foot was out of reach; raised: by how many degrees the left arm and the right
    were held away from the trunk at most; cramped [m]: how much of the room asked for is missing there all the same."""

    poses: tuple[Pose, ...]
    scale: float
    clamped: dict[str, tuple[float, int]]
    stands: tuple[float, float]
    missed: float
    raised: tuple[float, float] = (0.0, 0.0)
    cramped: float = 0.0


def figure_from(
    figure: Mannequin,
    points: np.ndarray,
    names: tuple[str, ...],
    *,
    rate: float,
    rest: np.ndarray | None = None,
    turns: Mapping[str, np.ndarray] | None = None,
    plant: bool = True,
    room: float = 0.0,
) -> Retargeted:
    """Poses of a figure that moves as points (T, J, 3) [m] with y up and `names` (J,) do, `rate` frames a second.

    names: of Kinect v2 or of our own joints (also collar, head, tip_l, tip_r), others are passed over; rest (J, 3) [m]:
    the same body in T-pose facing +z, without it the figure's own proportions are taken; turns: rotations (T, 3, 3) of
    joints by our names against that T-pose, in the world, where they are known better than by points; plant: whether
    feet that stand are held; room [m]: kept between arms and trunk or thighs, for layers of cloth that the tracked body
    did not wear (0: as seen). Raises SimCoreError naming frame and joint for what is not finite, and what is missing.
    """
    points = _checked(points, names, rate)
    own = named_points(points, tuple(names))
    skeleton = figure.skeleton
    at_rest = rest_points(skeleton)
    if rest is not None:
        at_rest |= {
            name: place[0] for name, place in named_points(np.asarray(rest, float)[None], names).items()
        }
    local = turns_of(skeleton, own, at_rest)
    if turns:
        local = _with_turns(local, turns)
    scale = _legs(dict(zip(JOINTS, skeleton.heads[:, None], strict=True))) / _legs(own)
    clamped: dict[str, tuple[float, int]] = {}
    poses = _poses(local, scale * own["pelvis"] - skeleton.heads[0], clamped)
    poses, raised, cramped = arms_apart(figure, poses, room, rate)
    stands, missed = (0.0, 0.0), 0.0
    if plant:
        poses, stands, missed = _planted(figure, poses, rate)
    kept = [_clamped(pose, clamped) for pose in poses]
    return Retargeted(tuple(kept), scale, clamped, stands, missed, raised, cramped)


def _checked(points: np.ndarray, names: tuple[str, ...], rate: float) -> np.ndarray:
    points = np.asarray(points, float)
    if points.ndim != 3 or points.shape[1:] != (len(names), 3) or not len(points):
        raise SimCoreError(
            f"joints: {points.shape} – expected (T, {len(names)}, 3), T at least 1: a point a name"
        )
    if not np.isfinite(rate) or rate <= 0.0:
        raise SimCoreError(f"rate: {rate} – give frames a second, above 0")
    lost = np.argwhere(~np.isfinite(points).all(2))
    if len(lost):
        frame, joint = lost[0]
        raise SimCoreError(
            f"joints: {names[joint]} in frame {frame} is not finite ({len(lost)} in all) – fill lost points first"
        )
    return points


def _with_turns(local: np.ndarray, turns: Mapping[str, np.ndarray]) -> np.ndarray:
    """The joints' rotations with some of them known in the world."""
    world = np.zeros_like(local)
    out = local.copy()
    for joint, parent in enumerate(PARENTS):
        above = world[:, parent] if parent >= 0 else np.eye(3)[None]
        if JOINTS[joint] in turns:
            out[:, joint] = np.swapaxes(above, 1, 2) @ np.asarray(turns[JOINTS[joint]], float)
        world[:, joint] = above @ out[:, joint]
    return out


def _legs(points: Mapping[str, np.ndarray]) -> float:
    """How long the legs are (T-median) [m]."""
    length = 0.0
    for side in SIDES:
        hip, knee, ankle = (points[f"{name}_{side}"] for name in ("hip", "knee", "ankle"))
        length += float(np.median(np.linalg.norm(knee - hip, axis=1) + np.linalg.norm(ankle - knee, axis=1)))
    if not length > 0.0:
        raise SimCoreError("joints: legs without length – give hips, knees and ankles")
    return 0.5 * length


def _poses(local: np.ndarray, way: np.ndarray, clamped: dict[str, tuple[float, int]]) -> list[Pose]:
    vectors = rotvec_of(local)
    out = []
    for row in range(len(local)):
        pose = Pose.from_rotvecs(
            {joint: vectors[row, k].tolist() for k, joint in enumerate(JOINTS)}, way[row].tolist()
        )
        out.append(_clamped(pose, clamped))
    return out


def _clamped(pose: Pose, clamped: dict[str, tuple[float, int]]) -> Pose:
    """The pose with its joints within their limits; adds to `clamped` which were not."""
    fixed: dict[str, list[float]] = {}
    for joint, _ in pose.turns:
        vector = np.array(pose.vector(joint))
        low, high = np.array(LIMITS[joint]).T
        ways = [vector]
        if (size := float(np.linalg.norm(vector))) > 0.0:
            ways.append(vector * (1.0 - 360.0 / size))
        nearest = min(ways, key=lambda v: float(np.linalg.norm(v - np.clip(v, low, high))))
        within = np.clip(nearest, low, high)
        beyond = float(np.abs(within - nearest).max())
        if beyond > 1e-6:
            fixed[joint] = within.tolist()
            most, count = clamped.get(joint, (0.0, 0))
            clamped[joint] = max(most, beyond), count + 1
    return pose.and_also(Pose.from_rotvecs(fixed)) if fixed else pose


@dataclass
class _Track:
    """One foot through all frames (T,): its ankle (T, 3) as seen or its place (T, 3) wanted, pitch, yaw, hinge (T, 3).

    place: x and z of the ankle less what it went by rolling, and the sole's height above the floor.
    """

    sole: Sole
    ankle: np.ndarray
    pitch: np.ndarray
    yaw: np.ndarray
    hinge: np.ndarray
    place: np.ndarray

    @property
    def placed(self) -> np.ndarray:
        """The ankle (T, 3) that its place, pitch and yaw make."""
        way = np.asarray(self.sole.way(self.pitch))
        height = np.asarray(self.sole.height(self.pitch)) + self.place[:, 2]
        x = self.place[:, 0] + way * np.sin(self.yaw)
        return np.stack([x, height, self.place[:, 1] + way * np.cos(self.yaw)], axis=1)

    @property
    def rolled(self) -> np.ndarray:
        """x and z (T, 2) of the ankle, less what it went by rolling."""
        way = np.asarray(self.sole.way(self.pitch))
        return self.ankle[:, [0, 2]] - way[:, None] * np.stack([np.sin(self.yaw), np.cos(self.yaw)], axis=1)

    @property
    def above(self) -> np.ndarray:
        """How far (T,) the sole is above the floor."""
        return self.ankle[:, 1] - np.asarray(self.sole.height(self.pitch))


def _planted(
    figure: Mannequin, poses: list[Pose], rate: float
) -> tuple[list[Pose], tuple[float, float], float]:
    """Poses whose feet stand on the floor y = 0 and do not slide while they do."""
    feet = _tracks(figure, poses)
    floor = _lowest(np.minimum(feet["l"].above, feet["r"].above), rate)
    poses = [pose.shifted(y=-float(down)) for pose, down in zip(poses, floor, strict=True)]
    for foot in feet.values():
        foot.ankle[:, 1] -= floor
    legs = reach(figure.skeleton, "l")
    stands = {side: _stands(foot, rate, SLOW * legs / LEG) for side, foot in feet.items()}
    goals = {side: _goals(foot, stands[side], rate) for side, foot in feet.items()}
    poses = _within_reach(figure, poses, goals, rate)
    for _ in range(LIFTS):
        out, missed, stiff = _legged(figure, poses, goals)
        if not any(values.any() for values in stiff.values()):
            break
        for side, goal in goals.items():  # an ankle that cannot bend further lifts its heel
            goal.pitch += np.radians(spread(stiff[side], SMOOTH * rate))
            left, right = (
                spread(np.maximum(sign * stiff[f"yaw_{side}"], 0.0), SMOOTH * rate) for sign in (1, -1)
            )
            goal.hinge = _yawed(goal.hinge, left - right)  # one that cannot turn further turns the knee along
        tilt = spread(
            stiff["hips"], SMOOTH * rate
        )  # and a thigh that cannot go further back takes the pelvis along
        poses = [_tilted(pose, float(angle)) for pose, angle in zip(poses, tilt, strict=True)]
        poses = _within_reach(figure, poses, goals, rate)
    return out, (float(stands["l"].mean()), float(stands["r"].mean())), missed


def _legged(
    figure: Mannequin, poses: list[Pose], goals: Mapping[str, _Track]
) -> tuple[list[Pose], float, dict[str, np.ndarray]]:
    """Poses with their feet where they are wanted, what the furthest is missed by [m], and by how many degrees (T,)
    each ankle would have to bend up, or turn either way, further than it goes, and a hip back."""
    out, missed = [], 0.0
    stiff = {name: np.zeros(len(poses)) for name in (*SIDES, "yaw_l", "yaw_r", "hips")}
    places = {side: goal.placed for side, goal in goals.items()}
    for row, pose in enumerate(poses):
        holds = {
            side: Foothold(
                places[side][row], pitched(float(goal.yaw[row]), float(goal.pitch[row])), goal.hinge[row]
            )
            for side, goal in goals.items()
        }
        legged, off = legs_at(figure.skeleton, pose, holds)
        for side in SIDES:
            ankle = f"ankle_{side}"
            up, yaw, _ = legged.vector(ankle)
            stiff[side][row] = max(0.0, LIMITS[ankle][0][0] - up)
            stiff[f"yaw_{side}"][row] = yaw - np.clip(yaw, *LIMITS[ankle][1])
            back = legged.vector(f"hip_{side}")[0] - LIMITS[f"hip_{side}"][0][1]
            stiff["hips"][row] = max(stiff["hips"][row], back)
        out.append(legged)
        missed = max(missed, off)
    return out, missed, stiff


def _tilted(pose: Pose, angle: float) -> Pose:
    """The pelvis tilted forward by degrees, the spine above it as it was."""
    if angle == 0.0:
        return pose
    forth, back = (
        np.array(Pose.from_rotvecs({"pelvis": (a, 0.0, 0.0)}).turn("pelvis")) for a in (angle, -angle)
    )
    turns = dict(pose.turns) | {
        "pelvis": unit(product(np.array(pose.turn("pelvis")), forth)),
        "spine_1": unit(product(back, np.array(pose.turn("spine_1")))),
    }
    return Pose(tuple((joint, turns[joint]) for joint in JOINTS if joint in turns), pose.shift)


def _yawed(vectors: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Vectors (T, 3) turned about the upright by angles (T,) [degrees]."""
    cosine, sine = np.cos(np.radians(angles)), np.sin(np.radians(angles))
    x, y, z = vectors.T
    return np.stack([cosine * x + sine * z, y, cosine * z - sine * x], axis=1)


def _tracks(figure: Mannequin, poses: list[Pose]) -> dict[str, _Track]:
    skeleton, count = figure.skeleton, len(poses)
    feet = {
        side: _Track(
            sole_of(figure, side),
            np.zeros((count, 3)),
            np.zeros(count),
            np.zeros(count),
            np.zeros((count, 3)),
            np.zeros((count, 3)),
        )
        for side in SIDES
    }
    for row, pose in enumerate(poses):
        turns, shifts = skeleton.moves(pose)
        for side, foot in feet.items():
            k = JOINTS.index(f"ankle_{side}")
            foot.ankle[row] = turns[k] @ skeleton.heads[k] + shifts[k]
            x, y, z = turns[k][:, 2]
            foot.pitch[row], foot.yaw[row] = np.arctan2(-y, np.hypot(x, z)), np.arctan2(x, z)
            foot.hinge[row] = turns[JOINTS.index(f"hip_{side}")][:, 0]
    for foot in feet.values():
        foot.yaw = np.unwrap(foot.yaw)
        foot.pitch = np.clip(foot.pitch, -1.3, 1.3)
    return feet


def _stands(foot: _Track, rate: float, slow: float) -> np.ndarray:
    """In which frames (T,) the foot stands: low, and what touches the floor of it nearly still."""
    above = foot.above - _lowest(foot.above, rate)
    if len(foot.pitch) < 3:
        return above < HIGH
    places = gaussian_filter1d(
        np.column_stack([foot.rolled, above, TOES * foot.yaw]), STILL * rate, axis=0, mode="nearest"
    )
    speed = np.linalg.norm(np.gradient(places, axis=0), axis=1) * rate
    found = speed / slow + np.maximum(above - LOW, 0.0) / HIGH < 1.0
    found = _without(found, ~found, round(GAP * rate), True)
    return _without(found, found, round(STAND * rate), False)


def _lowest(above: np.ndarray, rate: float) -> np.ndarray:
    """The height (T,) of the floor under a foot, as it comes down on it every now and then: captured floors lean."""
    wide = max(3, round(STRIDE * rate))
    lowest = minimum_filter1d(gaussian_filter1d(above, STILL * rate, mode="nearest"), wide, mode="nearest")
    return gaussian_filter1d(lowest, 0.25 * wide, mode="nearest")


def _without(found: np.ndarray, kind: np.ndarray, least: int, becomes: bool) -> np.ndarray:
    """Runs of a kind (T,) shorter than `least` frames become the other."""
    out = found.copy()
    for begin, end in _runs(kind):
        inner = begin > 0 and end < len(found)
        if end - begin < least and (inner or not becomes):
            out[begin:end] = becomes
    return out


def _runs(kind: np.ndarray) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.r_[False, kind, False]))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _goals(foot: _Track, stands: np.ndarray, rate: float) -> _Track:
    """Where the foot is wanted: set down while it stands, as seen half-way between two stands."""
    runs, count = _runs(stands), len(stands)
    rolled, above = foot.rolled, foot.above
    wanted = np.column_stack([rolled, above, foot.yaw])  # x, z, height of the sole, yaw
    moved, share = np.zeros_like(wanted), np.zeros(count)
    for number, (begin, end) in enumerate(runs):
        place = wanted[begin:end].mean(0)
        place[2] = 0.0
        moved[begin:end], share[begin:end] = place - wanted[begin:end], 1.0
        before = runs[number - 1][1] if number else 0
        after = runs[number + 1][0] if number + 1 < len(runs) else count
        for rows, edge in ((range(before, begin), begin), (range(end, after), end - 1)):
            span = max(1.0, min(EASE * rate, 0.5 * len(rows) if 0 < before or after < count else len(rows)))
            for row in rows:
                fade = 1.0 - float(minimum_jerk(abs(row - edge) / (span + 1.0)))
                moved[row] += fade * (place - wanted[edge])
    wanted = wanted + moved
    # Frames to a stand, or to an end of what is known.
    free = np.asarray(distance_transform_edt(np.pad(~stands, 1)))[1:-1]
    clear = np.asarray(minimum_jerk(free / (CLEAR_IN * rate)))
    wanted[:, 2] = np.where(stands, 0.0, np.maximum(wanted[:, 2], CLEAR * clear))
    # What is not yet clear of the floor, or no longer, hardly goes along it: a captured foot may start with a jerk.
    for begin, end in runs:
        for rows, edge in ((range(begin - 1, -1, -1), begin), (range(end, count), end - 1)):
            for row in rows:
                if clear[row] >= 1.0 or stands[row]:
                    break
                wanted[row, [0, 1, 3]] += (1.0 - clear[row]) * (wanted[edge] - wanted[row])[[0, 1, 3]]
    return _Track(foot.sole, foot.ankle, foot.pitch.copy(), wanted[:, 3], foot.hinge, wanted[:, :3])


def _within_reach(
    figure: Mannequin, poses: list[Pose], goals: Mapping[str, _Track], rate: float
) -> list[Pose]:
    """The root lowered, smoothly, where a foot would be out of reach."""
    skeleton = figure.skeleton
    need = np.zeros(len(poses))
    places = {side: goal.placed for side, goal in goals.items()}
    for row, pose in enumerate(poses):
        joints = skeleton.joints(pose)
        for side in SIDES:
            way = places[side][row] - joints[JOINTS.index(f"hip_{side}")]
            longest = reach(skeleton, side)
            left = longest**2 - float(way[0] ** 2 + way[2] ** 2)
            need[row] = max(need[row], -float(way[1]) - (left**0.5 if left > 0.0 else 0.0))
    if need.max() <= 0.0:
        return poses
    lower = spread(need, SMOOTH * rate)
    return [pose.shifted(y=-float(down)) for pose, down in zip(poses, lower, strict=True)]
