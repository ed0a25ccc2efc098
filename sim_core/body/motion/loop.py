"""Motions that repeat: curves and keyed poses over a period, feet on the floor, closing without a jump."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from sim_core.body.joints import JOINTS, product
from sim_core.body.mannequin import Mannequin
from sim_core.body.motion.curves import ROOT, Curve, minimum_jerk
from sim_core.body.motion.keys import RATE
from sim_core.body.motion.legs import Foothold, legs_at
from sim_core.body.motion.steps import MISSED, Footing, Steps
from sim_core.body.pose import T_POSE, Pose
from sim_core.errors import SimCoreError

__all__ = ["Key", "Loop"]


@dataclass(frozen=True)
class Key:
    """A pose that is reached `seconds` after its move began; the move begins `early` [s] before the one before ends."""

    seconds: float
    pose: Pose
    early: float = 0.0


@dataclass(frozen=True)
class Loop:
    """A motion that repeats every `period` [s]: a base pose or poses keyed over the period, curves on top of them.

    keys: gone through with minimum jerk, the last leading back to where the first began; curves turn a joint after its
    base or keyed turn; steps: how feet step (None: they stand where the base pose has them, flat); rounds: periods
    until the figure is as it was, facing and all; lead [s]: in which a wearer comes into it from where it stands.
    Raises SimCoreError for what cannot be played.
    """

    name: str
    period: float
    base: Pose = T_POSE
    curves: tuple[Curve, ...] = ()
    keys: tuple[Key, ...] = ()
    steps: Steps | None = None
    rounds: int = 1
    lead: float = 1.0
    title: Mapping[str, str] = field(default_factory=dict, compare=False)

    def __post_init__(self) -> None:
        if self.keys and self.steps is not None:
            raise SimCoreError("steps: feet of keyed poses stand – give [[curve]] tables, or leave steps out")
        if self.steps is not None and (self.steps.turn * self.rounds) % 360.0:
            raise SimCoreError(
                f"rounds: {self.rounds} times {self.steps.turn:g} degrees is no whole turn – the figure would not "
                "face as before"
            )

    @property
    def seconds(self) -> float:
        """How long it takes until the figure is as it was."""
        return self.period * self.rounds

    def times(self, rate: float = RATE) -> np.ndarray:
        """Times (T,) [s] of the frames of one whole loop, the last the first of the next; their rate is the nearest
        one that divides the loop."""
        count = max(1, round(self.seconds * rate))
        return np.arange(count + 1) * (self.seconds / count)

    def poses(
        self, figure: Mannequin, *, rate: float = RATE, in_place: bool = False, loops: int = 1
    ) -> tuple[Pose, ...]:
        """The figure's poses at `times(rate)`, `loops` of them; the root goes on, or in_place: stays.

        Raises SimCoreError, naming time and joint, where a joint would be turned beyond its limit or a foot is out of
        reach.
        """
        times = self.times(rate)
        steps = [times[-1] * k + times[1 if k else 0 :] for k in range(loops)]
        return self.at(figure, np.concatenate(steps), in_place=in_place)

    def at(self, figure: Mannequin, times: np.ndarray, *, in_place: bool = False) -> tuple[Pose, ...]:
        """The figure's poses at any times (T,) [s]; errors as `poses` has them."""
        out, footing = [], self._footing(figure)
        for time in times:
            if footing is not None:
                pose = footing.pose(float(time) / self.period, in_place=in_place)
            else:
                pose = self._standing(figure, float(time))
            pose.check(f"motion {self.name} at {float(time):.2f} s")
            out.append(pose)
        return tuple(out)

    def stride(self, figure: Mannequin) -> float:
        """How far [m] the figure goes in a period."""
        footing = self._footing(figure)
        return 0.0 if footing is None else footing.stride

    def course(self, start: Pose, figure: Mannequin) -> tuple[Pose, ...]:
        """A wearer's poses at the begin and at the end of every frame of 1/25 s: from where it stands into the motion,
        then one whole loop in place."""
        played = self.poses(figure, in_place=True)
        count = max(1, round(self.lead * RATE))
        led = [start.towards(played[0], float(minimum_jerk(k / count))) for k in range(count)]
        for pose in led:
            pose.check(f"motion {self.name}: lead")
        return (*led, *played)

    def raw(self, share: float) -> Pose:
        """The pose of keys and curves after so many periods, wherever the feet are."""
        pose = self._keyed((share % 1.0) * self.period) if self.keys else self.base
        turns = {joint: np.array(turn) for joint, turn in pose.turns}
        way = np.array(pose.shift)
        for curve in self.curves:
            for joint, vector in curve.turns(share).items():
                if joint == ROOT:
                    way = way + vector
                    continue
                own = np.array(Pose.from_rotvecs({joint: vector}).turn(joint))
                turns[joint] = product(own, turns[joint]) if joint in turns else own
        kept = tuple((joint, _unit(turns[joint])) for joint in JOINTS if joint in turns)
        return Pose(kept, (float(way[0]), float(way[1]), float(way[2])))

    @cached_property
    def _moves(self) -> tuple[tuple[float, float, dict[str, np.ndarray], np.ndarray], ...]:
        """Of each key: when its move begins [s], how long it takes, by what rotation vectors [degrees] and way [m]."""
        moves, time, before = [], 0.0, self.keys[-1].pose
        for number, key in enumerate(self.keys):
            begin = time - (key.early if number else 0.0)
            joints = dict.fromkeys([*dict(before.turns), *dict(key.pose.turns)])
            turned = {j: np.subtract(key.pose.vector(j), before.vector(j)) for j in joints}
            moves.append((begin, key.seconds, turned, np.subtract(key.pose.shift, before.shift)))
            time, before = begin + key.seconds, key.pose
        return tuple(moves)

    def _keyed(self, time: float) -> Pose:
        """Poses gone through one after the other, moves that overlap added: nothing stops where the next begins
        early."""
        first = self.keys[-1].pose
        vectors = {joint: np.array(first.vector(joint)) for joint, _ in first.turns}
        way = np.array(first.shift)
        for begin, seconds, turned, gone in self._moves:
            share = float(minimum_jerk((time - begin) / seconds))
            for joint, vector in turned.items():
                vectors[joint] = vectors.get(joint, np.zeros(3)) + share * vector
            way = way + share * gone
        return Pose.from_rotvecs({joint: vector.tolist() for joint, vector in vectors.items()}, way.tolist())

    def _footing(self, figure: Mannequin) -> Footing | None:
        return None if self.steps is None else _footing(self, _Worn(figure.digest(), figure))

    def _standing(self, figure: Mannequin, time: float) -> Pose:
        """Keys and curves, the legs bent until both feet are where the base pose has them."""
        pose = self.raw(time / self.period)
        skeleton = figure.skeleton
        turns, shifts = skeleton.moves(self.base)
        feet = {}
        for side in "lr":
            k = JOINTS.index(f"ankle_{side}")
            feet[side] = Foothold(turns[k] @ skeleton.heads[k] + shifts[k], turns[k])
        legged, missed = legs_at(skeleton, pose, feet)
        if missed > MISSED:
            raise SimCoreError(
                f"motion {self.name} at {time:.2f} s: a foot is {1000 * missed:.1f} mm out of reach – give the key a "
                "lower shift"
            )
        return legged

    def table(self) -> dict[str, Any]:
        """What decides the motion, as plain values."""
        return {"name": self.name, "period": self.period, "rounds": self.rounds, "what": repr(self)}


@dataclass(frozen=True)
class _Worn:
    """A figure that compares by its digest, so that what was found for it is kept."""

    digest: str
    figure: Mannequin = field(compare=False)


@lru_cache(maxsize=16)
def _footing(loop: Loop, worn: _Worn) -> Footing:
    return Footing(loop.steps or Steps(), worn.figure, loop.raw)


def _unit(q: np.ndarray) -> tuple[float, float, float, float]:
    w, x, y, z = (q / np.copysign(np.linalg.norm(q), q[0])).tolist()
    return w, x + 0.0, y + 0.0, z + 0.0
