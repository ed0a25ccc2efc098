"""Who is followed: lengths of the bones, shape of the trunk and how loose it is, measured on frames of themselves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim_core.errors import SimCoreError
from sim_core.track.engine import Body, kabsch
from sim_core.track.skeletons import TrackedSkeleton
from sim_core.validation import finite, numeric_array

__all__ = ["Calibration", "calibrate"]

ROUNDS = 8  # of the trunk's mean shape
QUARTER, USUAL_RECALL = 0.25, 0.3  # [s]
SHORT = 1.5  # of the noise: a bone that seems no longer than this is none
ENOUGH = 1_000  # frames, spread over the motion, for the trunk


@dataclass(frozen=True)
class Calibration:
    """skeleton; lengths (B,) [m] of its bones; rest (J, 3) [m]: a pose with just these lengths, against which
    rotations count; template (K, 3) [m]: the torso's joints at rest about their mean; looseness (K,) [m2]: how much
    each moves within the trunk, as a variance an axis; habit (J, 3) [m]: where each joint mostly is, in the trunk's
    frame; recall (J,) [s] in which it comes back there; noise [m] an axis of a joint, as bones of
    constant length tell it; None: of fewer than 8 frames."""

    skeleton: TrackedSkeleton
    lengths: np.ndarray
    rest: np.ndarray
    template: np.ndarray
    looseness: np.ndarray
    habit: np.ndarray
    recall: np.ndarray
    noise: float | None

    def body(self) -> Body:
        """As the engine takes it."""
        bones, count = self.skeleton.bones, len(self.skeleton.joints)
        incidence, paths = np.zeros((count, len(bones))), np.zeros((count, len(bones)))
        one = np.arange(count)  # for joints that lie in one place
        for (parent, child), length in zip(bones, self.lengths, strict=True):
            one[child] = child if length > 0.0 else one[parent]
        ends = one[bones]
        for number, (parent, child) in enumerate(bones):
            incidence[ends[number, 0], number] -= 1.0
            incidence[ends[number, 1], number] += 1.0
            paths[child] = paths[parent]
            paths[child, number] = 1.0
        torso = np.array(self.skeleton.torso, np.int64)
        return Body(
            np.ascontiguousarray(bones),
            np.ascontiguousarray(ends),
            one,
            np.ascontiguousarray(self.lengths),
            directions(self.rest, bones),
            torso,
            np.ascontiguousarray(self.template),
            np.ascontiguousarray(self.looseness),
            incidence,
            paths,
            np.ascontiguousarray(self.recall),
        )


def directions(joints: np.ndarray, bones: np.ndarray) -> np.ndarray:
    """Unit vectors (B, 3) along bones (B, 2) of joints (J, 3); of those without length: upwards."""
    along = joints[bones[:, 1]] - joints[bones[:, 0]]
    size = np.linalg.norm(along, axis=1)
    out = np.where(size[:, None] > 1e-9, along / np.maximum(size, 1e-9)[:, None], [0.0, 1.0, 0.0])
    return out / np.linalg.norm(out, axis=1)[:, None]


def calibrate(skeleton: TrackedSkeleton, joints: np.ndarray, step: float = 1.0 / 30.0) -> Calibration:
    """Measures who is seen in frames of joints (T, J, 3) [m], NaN where one was not seen, `step` [s] apart; any motion
    will do.

    Noise lengthens a measured bone (a length of L is seen as L2 + 6 sigma2 in the mean square), so its share is taken
    off; outliers are left out by the median. A joint that is never seen gets no bone, and lies at its parent. Raises
    SimCoreError for other shapes, and where no frame shows a joint of the trunk.
    """
    frames = np.array(numeric_array("joints", joints, "joints (T, J, 3) [m]"), float)
    if frames.ndim != 3 or frames.shape[1:] != (len(skeleton.joints), 3) or not len(frames):
        told = f"(T, {len(skeleton.joints)}, 3) of the {skeleton.name} skeleton"
        raise SimCoreError(f"joints: shape {frames.shape} – frames {told} are meant, one or more")
    frames[~np.isfinite(frames).all(2)] = np.nan
    bones = skeleton.bones
    lengths, noise = _lengths(frames, bones)
    shape, looseness = _trunk(frames[:, list(skeleton.torso)], noise or 0.0)
    rest = _rest(skeleton, frames, lengths)
    turn, _ = _fitted(shape, rest[list(skeleton.torso)])
    template = shape @ turn.T
    habit, recall = _habit(skeleton, frames, template, rest, finite("step", step, above=0.0))
    return Calibration(skeleton, lengths, rest, template, looseness, habit, recall, noise)


def _lengths(frames: np.ndarray, bones: np.ndarray) -> tuple[np.ndarray, float | None]:
    """Lengths (B,) [m] and the noise [m] an axis of a joint."""
    seen = np.linalg.norm(frames[:, bones[:, 1]] - frames[:, bones[:, 0]], axis=2)
    lengths, squares, spreads = np.zeros(len(bones)), np.zeros(len(bones)), np.full(len(bones), np.nan)
    for bone, found in enumerate(seen.T):
        known = found[np.isfinite(found)]
        if not len(known):
            continue
        middle = np.median(known)
        near = 1.4826 * np.median(np.abs(known - middle))
        kept = known[np.abs(known - middle) <= 4.0 * near + 1e-12]
        lengths[bone], squares[bone] = middle, np.mean(kept**2)
        if len(kept) >= 8:
            spreads[bone] = np.var(kept)
    known = spreads[np.isfinite(spreads) & (lengths > 0.1)]
    if not len(known):
        return lengths, None
    noise2 = float(np.median(known)) / 2.0
    if noise2 < 1e-8:  # less than a tenth of a millimetre: bones that are what they are
        return lengths, float(np.sqrt(noise2))
    squares = squares - 6.0 * noise2
    return np.where(squares > SHORT**2 * noise2, np.sqrt(np.maximum(squares, 0.0)), 0.0), float(
        np.sqrt(noise2)
    )


def _trunk(frames: np.ndarray, noise: float) -> tuple[np.ndarray, np.ndarray]:
    """The mean shape (K, 3) of the torso's joints (T, K, 3), each frame turned onto it, and what they move in it."""
    whole = frames[np.isfinite(frames).all((1, 2))]
    if not len(whole):  # never all at once: from what is seen of each, as if the trunk stood still
        count = np.isfinite(frames[..., 0]).sum(0)
        if not count.any():
            raise SimCoreError("joints: no frame shows a joint of the trunk – nothing to follow")
        shape = np.nan_to_num(np.nansum(frames, axis=0) / np.maximum(count, 1)[:, None])
        shape[count == 0] = shape[count > 0].mean(0)
        return shape - shape.mean(0), np.full(frames.shape[1], 0.02**2)
    whole = whole[:: -(-len(whole) // ENOUGH)]
    centred = whole - np.median(whole, axis=1, keepdims=True)
    shape = centred[0]
    away = np.zeros(centred.shape)
    for _ in range(ROUNDS if len(whole) > 1 else 1):
        turned = _onto(centred, shape)
        away = turned - np.median(turned, axis=0)
        near = np.linalg.norm(away, axis=2).max(1)
        kept = near <= 3.0 * np.median(near) + 1e-12
        shape = turned[kept].mean(0)
    shape = shape - shape.mean(0)
    loose = (away**2).mean(2)
    if len(whole) < 8:
        return shape, np.full(frames.shape[1], 0.01**2)
    own = (
        np.quantile(loose, 0.9, axis=0) / 2.08
    )  # of a chi-square of three degrees: a ninth in ten is 6.25 / 3
    return shape, np.maximum(own - noise**2, (1e-4) ** 2)


def _habit(
    skeleton: TrackedSkeleton, frames: np.ndarray, template: np.ndarray, rest: np.ndarray, step: float
) -> tuple[np.ndarray, np.ndarray]:
    """The mean place (J, 3) [m] of every joint about the trunk, and how long [s] a joint stays where it is (J,): after
    that time t the correlation of its places is exp(-1/2), as exp(-t2 / 2 recall2) tells it a quarter second later."""
    torso = list(skeleton.torso)
    turn, shift = _fitted(template, rest[torso])
    own, usual = (rest - shift) @ turn, np.full(len(rest), USUAL_RECALL)
    whole = np.isfinite(frames[:, torso]).all((1, 2))
    if not whole.any():
        return own, usual
    middle = frames[:, torso].mean(1, keepdims=True)
    trunk = np.nan_to_num(frames[:, torso] - middle)
    u, _, vh = np.linalg.svd(trunk.transpose(0, 2, 1) @ (template - template.mean(0)))
    vh[np.linalg.det(u @ vh) < 0.0, 2] *= -1.0
    there = (frames - middle) @ (u @ vh) + template.mean(0)
    there[~whole] = np.nan
    seen = np.isfinite(there[..., 0])
    count = np.maximum(seen.sum(0), 1)
    mean = np.where(seen[..., None], there, 0.0).sum(0) / count[:, None]
    mean = np.where(seen.any(0)[:, None], mean, own)
    lag = max(1, round(QUARTER / step))
    if len(frames) >= 2 * lag + 8:
        away = there - mean
        spread = np.where(seen, np.nan_to_num(away**2).sum(2), 0.0).sum(0) / count
        both = seen[lag:] & seen[:-lag]
        product = np.where(both, np.nan_to_num(away[lag:] * away[:-lag]).sum(2), 0.0).sum(0)
        kept = np.clip(product / np.maximum(both.sum(0), 1) / np.maximum(spread, 1e-12), 0.05, 0.995)
        usual = lag * step / np.sqrt(-2.0 * np.log(kept))
    return mean, usual


def _onto(frames: np.ndarray, shape: np.ndarray) -> np.ndarray:
    """Frames (T, K, 3), each moved onto a shape (K, 3)."""
    middle, own = shape.mean(0), frames - frames.mean(1, keepdims=True)
    u, _, vh = np.linalg.svd(own.transpose(0, 2, 1) @ (shape - middle))
    mirrored = np.linalg.det(u @ vh) < 0.0
    vh[mirrored, 2] *= -1.0
    return own @ (u @ vh) + middle


def _fitted(source: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """R (3, 3) and T (3,) from source to target, points (K, 3)."""
    a, b = target.mean(0), source.mean(0)
    turn = kabsch((source - b).T @ (target - a) + 1e-12 * np.eye(3))
    return turn, a - turn @ b


def _rest(skeleton: TrackedSkeleton, frames: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """The first frame that shows most, with just these lengths."""
    seen = np.isfinite(frames).all(2)
    frame = frames[int(np.argmax(seen.sum(1)))]
    out = np.zeros((len(skeleton.joints), 3))
    root = skeleton.root
    known = np.isfinite(frame).all(1)
    out[root] = frame[root] if known[root] else frame[known].mean(0)
    for (parent, child), length in zip(skeleton.bones, lengths, strict=True):
        start = frame[parent] if known[parent] else out[parent]
        along = frame[child] - start if known[child] else np.array([0.0, 1.0, 0.0])
        size = float(np.linalg.norm(along))
        out[child] = out[parent] + length * (along / size if size > 1e-9 else np.array([0.0, 1.0, 0.0]))
    return out
