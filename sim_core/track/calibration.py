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
UNKNOWN_BEND, LEAST_BEND = 0.01, 1e-4  # [m] that a joint moves within the trunk
FEW = 8  # frames, or more, tell a spread
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
    torso = list(skeleton.torso)
    if not np.isfinite(frames[:, torso]).any():
        raise SimCoreError("joints: no frame shows a joint of the trunk – nothing to follow")
    rest = _rest(skeleton, frames, lengths)
    shape, looseness = _trunk(frames[:, torso], rest[torso], noise or 0.0)
    turn, _ = _fitted(shape, rest[torso])
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
        if len(kept) >= FEW:
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


def _trunk(frames: np.ndarray, begin: np.ndarray, noise: float) -> tuple[np.ndarray, np.ndarray]:
    """The mean shape (K, 3) of the torso's joints (T, K, 3), each frame turned onto it by what is seen of it, and how
    loose each is in it; begin (K, 3): a shape to begin with."""
    frames = frames[:: -(-len(frames) // ENOUGH)]
    shape, unknown = begin - begin.mean(0), np.full(len(begin), UNKNOWN_BEND**2)
    turns, shifts, known = _fits(shape, frames)
    if not known.any():
        return shape, unknown
    for _ in range(ROUNDS if known.sum() > 1 else 1):
        turns, shifts, known = _fits(shape, frames)
        own = ((frames - shifts[:, None]) @ turns)[known]
        away = np.nan_to_num(own - np.nanmedian(_seen_once(own, shape), axis=0))
        near = np.linalg.norm(away, axis=2).max(1)
        kept = own[near <= 3.0 * np.median(near) + 1e-12]
        count = np.isfinite(kept[..., :1]).sum(0)
        shape = np.where(count > 0, np.nan_to_num(kept).sum(0) / np.maximum(count, 1), shape)
        shape = shape - shape.mean(0)
    if known.sum() < FEW:
        return shape, unknown
    loose = np.where(np.isfinite(own[..., 0]), (away**2).mean(2), np.nan)
    tail = (
        np.nanquantile(_seen_once(loose, unknown), 0.9, axis=0) / 2.08
    )  # a tenth of a chi-square lies above 6.25 / 3
    return shape, np.maximum(tail - noise**2, LEAST_BEND**2)


def _seen_once(values: np.ndarray, instead: np.ndarray) -> np.ndarray:
    """Values (T, K, ...) with a first frame more for those that no frame shows."""
    never = np.isnan(values).all(0)
    return np.concatenate([np.where(never, instead, np.nan)[None], values])


def _fits(shape: np.ndarray, frames: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rotations (T, 3, 3) and shifts (T, 3) from a shape (K, 3) to frames (T, K, 3), by the joints that are seen; and
    whether these, three or more, can tell it (T,)."""
    seen = np.asarray(np.isfinite(frames).all(2))
    share = seen / np.maximum(seen.sum(1), 1)[:, None]
    there = np.where(seen[..., None], frames, 0.0)
    middle, centre = (share[:, None] @ there)[:, 0], share @ shape
    own = (shape - centre[:, None]) * share[..., None]
    u, spread, vh = np.linalg.svd(own.transpose(0, 2, 1) @ (there - middle[:, None]))
    turns = (u @ vh).transpose(0, 2, 1)
    mirrored = np.linalg.det(turns) < 0.0
    vh[mirrored, 2] *= -1.0
    turns = (u @ vh).transpose(0, 2, 1)
    known = (seen.sum(1) >= 3) & (spread[:, 1] > 1e-3 * spread[:, 0])
    return turns, middle - (turns @ centre[..., None])[..., 0], known


def _habit(
    skeleton: TrackedSkeleton, frames: np.ndarray, template: np.ndarray, rest: np.ndarray, step: float
) -> tuple[np.ndarray, np.ndarray]:
    """The mean place (J, 3) [m] of every joint about the trunk, and how long [s] a joint stays where it is (J,): after
    that time t the correlation of its places is exp(-1/2), as exp(-t2 / 2 recall2) tells it a quarter second later."""
    torso = list(skeleton.torso)
    turn, shift = _fitted(template, rest[torso])
    own, usual = (rest - shift) @ turn, np.full(len(rest), USUAL_RECALL)
    turns, shifts, known = _fits(template, frames[:, torso])
    there = (frames - shifts[:, None]) @ turns
    there[~known] = np.nan
    seen = np.asarray(np.isfinite(there[..., 0]))
    count = np.maximum(seen.sum(0), 1)
    mean = np.where(seen[..., None], there, 0.0).sum(0) / count[:, None]
    mean = np.where(np.asarray(seen.any(0))[:, None], mean, own)
    lag = max(1, round(QUARTER / step))
    if len(frames) >= 2 * lag + FEW:
        away = there - mean
        spread = np.where(seen, np.nan_to_num(away**2).sum(2), 0.0).sum(0) / count
        both = seen[lag:] & seen[:-lag]
        product = np.where(both, np.nan_to_num(away[lag:] * away[:-lag]).sum(2), 0.0).sum(0)
        kept = np.clip(product / np.maximum(both.sum(0), 1) / np.maximum(spread, 1e-12), 0.05, 0.995)
        usual = np.where(both.any(0), lag * step / np.sqrt(-2.0 * np.log(kept)), usual)
    return mean, usual


def _fitted(source: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """R (3, 3) and T (3,) from source to target, points (K, 3)."""
    a, b = target.mean(0), source.mean(0)
    turn = kabsch((source - b).T @ (target - a) + 1e-12 * np.eye(3))
    return turn, a - turn @ b


def _rest(skeleton: TrackedSkeleton, frames: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """The first frame that shows most, with just these lengths."""
    seen = np.asarray(np.isfinite(frames).all(2))
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
