"""Feet that step: where each stands, how it rolls and swings, and how the root goes on over the foot that stands.

Angles alone make a figure skate. Here the joint curves say how the legs swing; the root goes by the foot that stands
(in double support by both, the weight passing smoothly from one to the other), a standing foot rolls without sliding
(`soles`), a swinging one goes by its curves, joined to where it stood and will stand without a jump in place, speed or
acceleration; the legs then follow by two-bone inverse kinematics (`legs`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d, maximum_filter1d
from scipy.optimize import linprog

from sim_core.body.joints import JOINTS
from sim_core.body.limits import LIMITS
from sim_core.body.mannequin import Mannequin
from sim_core.body.motion.curves import minimum_jerk
from sim_core.body.motion.legs import Foothold, legs_at, pitched, reach
from sim_core.body.motion.soles import Sole, sole_of
from sim_core.body.pose import Pose
from sim_core.errors import SimCoreError

__all__ = ["Footing", "Steps"]

FINE = 480  # samples of a period
HARMONICS = 2  # of the root's way forward and up that are kept: more of them would tremble
SIDES = ("l", "r")
HALF = {"l": 0.0, "r": 0.5}  # of the period after which the side's foot strikes
ROLL = 0.14  # of a period in which a foot that lay flat comes to roll as its curves have it
SURGE = 0.12  # most that the root's speed differs from its mean: more of it rocks (Inman et al., Human Walking, 1981)
RISE, FALL = 0.3, 0.25  # shares of a swing in which a foot rises, and in which it comes down
SPARE = 0.002  # [m] that a leg could still stretch
SHIFTS = np.arange(-5, 6) * 0.01  # [m] by which feet are tried further forward
SAMPLES = np.arange(120) / 120  # shares at which legs must reach
DIP = 0.006  # [m] of a wave a step by which the root is lower where legs are far apart
LIFTS = 10  # times that heels are lifted at most
ROOM = 0.5  # [degrees] that an ankle keeps from its limit
MISSED = 5e-4  # [m] by which a foot may be missed


@dataclass(frozen=True)
class Steps:
    """How feet step. off: share of the period for which a foot stands, from its strike; flat: shares between which it
    lies flat; width [m] between the ankles; lift [m] of a swinging sole; toe_out, turn [degrees]: of each foot, and of
    the whole figure to its left, on the spot, in a period."""

    off: float = 0.62
    flat: tuple[float, float] = (0.12, 0.36)
    width: float = 0.16
    lift: float = 0.035
    toe_out: float = 5.0
    turn: float = 0.0

    def __post_init__(self) -> None:
        if not 0.5 < self.off < 0.9:
            raise SimCoreError(
                f"off: {self.off:g} – one foot stands always: give more than 0.5 and less than 0.9"
            )
        if not 0.0 < self.flat[0] < self.flat[1] < self.off:
            raise SimCoreError(
                f"flat: {list(self.flat)} – give two shares that rise between 0 and off = {self.off:g}"
            )


@dataclass(frozen=True)
class _Foot:
    """One foot: its raw way from the root (x, y, z) in the figure's own heading, its pitch [rad], where it stands."""

    sole: Sole
    raw: CubicSpline
    pitch: CubicSpline
    stands: np.ndarray  # (2,) x and z [m] of its first stand, from the root's place at the stand's middle


class Footing:
    """A figure's steps, found once; `pose(raw, share)` sets its feet down at any time.

    raw(share): the pose of the curves after so many periods, its root in place. stride [m]: way of a period.
    """

    def __init__(self, steps: Steps, figure: Mannequin, raw: Callable[[float], Pose]) -> None:
        self._steps, self._figure, self._raw = steps, figure, raw
        shares = np.arange(FINE + 1) / FINE
        ways, pitches = self._sampled(shares)
        soles = {side: sole_of(figure, side) for side in SIDES}
        pitch = {side: _periodic(shares, self._levelled(side, shares, pitches[side])) for side in SIDES}
        along, up = np.zeros(FINE + 1), np.zeros(FINE + 1)
        for side in SIDES:
            p, weight = pitch[side](shares), self._weight(side, shares)
            speed = np.gradient(_wrapped(soles[side].way(p) - ways[side][:, 2]), 1.0 / FINE)[1:-1]
            along += weight * speed
            up += weight * (soles[side].height(p) - ways[side][:, 1])
        mean = 0.0 if steps.turn else float(along[:-1].mean())
        self.stride = mean
        sway = _smooth(_integral(along[:-1]))
        surge = float(np.abs(np.gradient(sway, 1.0 / FINE)).max())
        kept = 0.0 if steps.turn else min(1.0, SURGE * abs(mean) / max(surge, 1e-9))
        self._along = _periodic(shares, np.r_[sway, sway[0]] * kept)
        rise = _smooth(up[:-1])
        self._up = _periodic(shares, np.r_[rise, rise[0]])
        self._feet: dict[str, _Foot] = {}
        for side in SIDES:
            foot = _Foot(soles[side], _periodic(shares, ways[side]), pitch[side], np.zeros(2))
            self._feet[side] = foot
            inside = np.linspace(0.0, steps.off, 61) + HALF[side]
            way = np.array([self._along_at(s) + float(foot.raw(s)[2]) for s in inside])
            middle = float((way - foot.sole.way(foot.pitch(inside))).mean())
            sign = 1.0 if side == "l" else -1.0
            stands = np.array([sign * steps.width / 2, middle - mean * (HALF[side] + steps.off / 2)])
            self._feet[side] = _Foot(foot.sole, foot.raw, foot.pitch, stands)
        self._shift, self._lower = 0.0, np.zeros(3)
        self._settle()
        for _ in range(LIFTS):
            if not self._lift_heels():
                break

    def pose(self, share: float, *, in_place: bool = False) -> Pose:
        """The pose after so many periods; in_place: without the way that the figure goes on, its sway kept."""
        pose, missed = self._set(share)
        if missed > MISSED:
            raise SimCoreError(
                f"steps: a foot is {1000 * missed:.1f} mm out of reach after {share % 1.0:.0%} of the period – give "
                "hip curves of smaller scale"
            )
        return pose.shifted(z=-self.stride * share) if in_place else pose

    def holds(self, side: str, share: float) -> Foothold:
        """Where a foot is after so many periods."""
        since = share - HALF[side]
        number = np.floor(since)
        s, steps, foot = since - number, self._steps, self._feet[side]
        pitch = float(foot.pitch(share))
        if s <= steps.off:
            ankle, yaw = self._standing(side, float(number), share)
            return Foothold(ankle, pitched(yaw, pitch))
        off, strike = number + HALF[side] + steps.off, number + HALF[side] + 1.0
        begin, end = self._apart(side, float(number), off), self._apart(side, float(number) + 1.0, strike)
        apart = _joined((s - steps.off) / (1.0 - steps.off), begin, end, 1.0 - steps.off)
        free = self._free(side, share) + apart
        t = (s - steps.off) / (1.0 - steps.off)
        lift = steps.lift * float(minimum_jerk(t / RISE) * minimum_jerk((1.0 - t) / FALL))
        ankle = np.array([free[0], float(foot.sole.height(pitch)) + lift, free[1]])
        return Foothold(ankle, pitched(float(free[2]), pitch))

    def _set(self, share: float) -> tuple[Pose, float]:
        pelvis = self._figure.heads[0]
        raw = self._raw(share)
        place = self._root(share, raw)
        pose = Pose(raw.turns, (0.0, 0.0, 0.0)).facing(self._steps.turn * share)
        pose = pose.shifted(*(place - [pelvis[0], pelvis[1], pelvis[2]]))
        return legs_at(self._figure.skeleton, pose, {side: self.holds(side, share) for side in SIDES})

    def _sampled(self, shares: np.ndarray) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Ankles (S, 3) [m] from the root and pitches (S,) [rad] of the feet, of the curves alone."""
        skeleton = self._figure.skeleton
        ways = {side: np.zeros((len(shares), 3)) for side in SIDES}
        pitches = {side: np.zeros(len(shares)) for side in SIDES}
        for row, share in enumerate(shares):
            turns, shifts = skeleton.moves(Pose(self._raw(float(share)).turns))
            for side in SIDES:
                k = JOINTS.index(f"ankle_{side}")
                ways[side][row] = turns[k] @ skeleton.heads[k] + shifts[k] - skeleton.heads[0]
                toe = turns[k][:, 2]
                pitches[side][row] = np.arctan2(-toe[1], np.hypot(toe[0], toe[2]))
        return ways, pitches

    def _levelled(self, side: str, shares: np.ndarray, pitch: np.ndarray) -> np.ndarray:
        """The pitch, nought while the foot lies flat."""
        first, last = self._steps.flat
        s = (shares - HALF[side]) % 1.0
        kept = 1.0 - minimum_jerk(s / first) * minimum_jerk((last + ROLL - s) / ROLL)
        return pitch * kept

    def _weight(self, side: str, shares: np.ndarray) -> np.ndarray:
        """How much of the figure stands on a foot."""
        s, both = (shares - HALF[side]) % 1.0, self._steps.off - 0.5
        return minimum_jerk(s / both) * minimum_jerk((self._steps.off - s) / both)

    def _along_at(self, share: float) -> float:
        return self.stride * share + float(self._along(share))

    def _root(self, share: float, raw: Pose) -> np.ndarray:
        """The pelvis (3,) [m]."""
        turn = np.radians(self._steps.turn * share)
        side, ahead = raw.shift[0], raw.shift[2] + float(self._along(share))
        c, s = np.cos(turn), np.sin(turn)
        up = float(self._up(share)) + raw.shift[1] - float(_waves(share) @ self._lower)
        return np.array([c * side + s * ahead, up, c * ahead - s * side + self.stride * share])

    def _stand(self, side: str, number: float) -> tuple[np.ndarray, float]:
        """x and z (2,) [m] of the ankle of a foot that lies flat, and its yaw [rad], in its stand of that number."""
        middle = number + HALF[side] + self._steps.off / 2
        turn = np.radians(self._steps.turn * middle)
        c, s = np.cos(turn), np.sin(turn)
        x, z = self._feet[side].stands + [0.0, self._shift]
        out = np.radians(self._steps.toe_out) * (1.0 if side == "l" else -1.0)
        return np.array([c * x + s * z, c * z - s * x + self.stride * middle]), turn + out

    def _standing(self, side: str, number: float, share: float) -> tuple[np.ndarray, float]:
        """The ankle (3,) [m] of a foot that stands, rolled, and its yaw [rad]."""
        (x, z), yaw = self._stand(side, number)
        foot = self._feet[side]
        pitch = float(foot.pitch(share))
        way, height = float(foot.sole.way(pitch)), float(foot.sole.height(pitch))
        return np.array([x + way * np.sin(yaw), height, z + way * np.cos(yaw)]), yaw

    def _free(self, side: str, share: float) -> np.ndarray:
        """x, z [m] and yaw [rad] (3,) of the ankle by the curves alone."""
        turn = np.radians(self._steps.turn * share)
        sign = 1.0 if side == "l" else -1.0
        ahead = float(self._feet[side].raw(share)[2]) + float(self._along(share))
        c, s, x = np.cos(turn), np.sin(turn), sign * self._steps.width / 2
        yaw = turn + sign * np.radians(self._steps.toe_out)
        return np.array([c * x + s * ahead, c * ahead - s * x + self.stride * share, yaw])

    def _apart(self, side: str, number: float, share: float) -> np.ndarray:
        """By how much a foot that stands is away from its curves: value, speed and acceleration (3, 3) a period."""
        h = 0.5 / FINE

        def away(at: float) -> np.ndarray:
            ankle, yaw = self._standing(side, number, at)
            return np.array([ankle[0], ankle[2], yaw]) - self._free(side, at)

        before, here, after = away(share - h), away(share), away(share + h)
        return np.stack([here, (after - before) / (2 * h), (after - 2 * here + before) / (h * h)])

    def _settle(self) -> None:
        """Shifts the feet under the figure and lowers its root, least of all, until every leg reaches its foot."""
        best: tuple[float, float, np.ndarray] | None = None
        for shift in SHIFTS if self.stride else (0.0,):
            self._shift = shift
            need = self._too_high()
            bounds = [(None, None), (-DIP, DIP), (-DIP, DIP)]
            waves = np.stack([_waves(share) for share in SAMPLES])
            found = linprog([1.0, 0.0, 0.0], A_ub=-waves, b_ub=-need, bounds=bounds)
            if best is None or found.x[0] < best[0]:
                best = float(found.x[0]), shift, found.x
        assert best is not None
        self._shift, self._lower = best[1], best[2] if best[2].any() and best[0] > 0.0 else np.zeros(3)

    def _lift_heels(self) -> bool:
        """Lifts heels where an ankle would have to bend up further than it goes, and says whether it did."""
        stiff = {side: np.zeros(len(SAMPLES)) for side in SIDES}
        for row, share in enumerate(SAMPLES):
            pose = self._set(float(share))[0]
            for side in SIDES:
                most = LIMITS[f"ankle_{side}"][0][0] + ROOM
                stiff[side][row] = max(0.0, most - pose.vector(f"ankle_{side}")[0])
        if not any(values.any() for values in stiff.values()):
            return False
        shares = np.arange(FINE + 1) / FINE
        for side, foot in self._feet.items():
            spread = gaussian_filter1d(maximum_filter1d(stiff[side], 9, mode="wrap"), 3.0, mode="wrap")
            more = _periodic(np.r_[SAMPLES, 1.0], np.r_[spread, spread[0]])
            pitch = _periodic(shares, foot.pitch(shares) + np.radians(more(shares)))
            self._feet[side] = _Foot(foot.sole, foot.raw, pitch, foot.stands)
        return True

    def _too_high(self) -> np.ndarray:
        """By how much [m] the root would have to be lower at SAMPLES for both legs to reach their feet."""
        skeleton = self._figure.skeleton
        longest = {side: reach(skeleton, side) - SPARE for side in SIDES}
        need = np.zeros(len(SAMPLES))
        for row, share in enumerate(SAMPLES):
            raw = self._raw(float(share))
            pose = Pose(raw.turns).facing(self._steps.turn * float(share))
            pose = pose.shifted(*(self._root(float(share), raw) - self._figure.heads[0]))
            joints = skeleton.joints(pose)
            lower = []
            for side in SIDES:
                way = self.holds(side, float(share)).ankle - joints[JOINTS.index(f"hip_{side}")]
                flat = float(np.hypot(way[0], way[2]))
                if flat >= longest[side]:
                    raise SimCoreError(
                        "steps: the feet are further apart than legs – give hip curves of smaller scale"
                    )
                lower.append(-float(way[1]) - float(np.sqrt(longest[side] ** 2 - flat**2)))
            need[row] = max(lower)
        return need + _waves(SAMPLES).T @ self._lower


def _waves(share: float | np.ndarray) -> np.ndarray:
    """One and the two waves (3,) of a step: what lowers a root smoothly."""
    angle = 4.0 * np.pi * np.asarray(share)
    return np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)])


def _wrapped(values: np.ndarray) -> np.ndarray:
    """One more sample on each side of a period whose last sample is its first, a net way kept."""
    whole = values[-1] - values[0]
    return np.r_[values[-2] - whole, values, values[1] + whole]


def _periodic(shares: np.ndarray, values: np.ndarray) -> CubicSpline:
    values = values.copy()
    values[-1] = values[0]
    return CubicSpline(shares, values, bc_type="periodic")


def _integral(speed: np.ndarray) -> np.ndarray:
    """The periodic part of a way (S,) from its speed a period."""
    whole = np.fft.rfft(speed)
    order = np.arange(len(whole))
    whole[0] = 0.0
    whole[1:] /= 2j * np.pi * order[1:]
    return np.fft.irfft(whole, len(speed))


def _smooth(values: np.ndarray) -> np.ndarray:
    """The first harmonics of a period (S,)."""
    whole = np.fft.rfft(values)
    whole[HARMONICS + 1 :] = 0.0
    return np.fft.irfft(whole, len(values))


def _joined(t: float, begin: np.ndarray, end: np.ndarray, length: float) -> np.ndarray:
    """The quintic at t from 0 to 1 through value, speed and acceleration (3, n) at both ends, those a unit `length`."""
    p0, v0, a0 = begin[0], begin[1] * length, begin[2] * length**2
    p1, v1, a1 = end[0], end[1] * length, end[2] * length**2
    d = p1 - p0 - v0 - 0.5 * a0
    dv, da = v1 - v0 - a0, a1 - a0
    c3, c4, c5 = 10 * d - 4 * dv + 0.5 * da, -15 * d + 7 * dv - da, 6 * d - 3 * dv + 0.5 * da
    return p0 + t * (v0 + t * (0.5 * a0 + t * (c3 + t * (c4 + t * c5))))
