"""The unchanging part of a run, and one frame of it: adaptive step, watchdog, roll-back."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sim_core.cloth.contact.constraints import Holds
from sim_core.cloth.contact.moving_grid import MovingGrid
from sim_core.cloth.contact.solids import Solid
from sim_core.cloth.run.checkpoint import RunState
from sim_core.cloth.run.smoothing import smoothed
from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.air import Air
from sim_core.cloth.step.conditions import Conditions
from sim_core.cloth.step.engine import IMPLICIT_STEPS, Engine
from sim_core.cloth.step.kernels.diagnostics import ways
from sim_core.cloth.step.phases import FRAME, Contact, Moment, Phase, checked_phases, schedule
from sim_core.cloth.step.precision import Pace
from sim_core.cloth.step.stability import first_mode, passing_step, stable_with
from sim_core.errors import SimCoreError
from sim_core.validation import coordinates, of_kind, one_of, vertex_numbers, whole

if TYPE_CHECKING:
    from sim_core.cloth.run.certified_run import Certified
    from sim_core.cloth.run.certifier import Mesh

MAX_HALVINGS = 8
AIR_VERSION = 2  # raise when the same air gives other bits: `ENGINE_VERSION` would make every garment stale
SHELL_VERSION = 3  # the same for layers that touch
CONFIRMED = 0.02  # by which the longest edge may differ when half the step is to confirm it
LATE = 2.0  # times that step, beyond which a frame whose layers became faster is done again
MOST_SUBSTEPS = 50_000  # a frame: beyond, the explicit scheme is not tried
MOST_FIXED = 100_000  # substeps of a frame that may be asked for
INTEGRATORS = ("auto", "explicit", "implicit")
_KINDS = {  # of what a run may be given, and the remedy
    "contact": (Contact, "a Contact is meant"),
    "holds": (Holds, "make them with Holds.of"),
    "air": (Air, "an Air is meant, such as Air((4, 0, 1))"),
    "pace": (Pace, 'a Pace is meant, such as Pace("single", 0.9)'),
    "collider": (Solid | MovingGrid, "give a Solid, or moving_mesh() of a closed mesh"),
}


class _Step(NamedTuple):
    """What a frame is done with: the longest step [s], least stiffness damping [s] and the usual step [s].

    The usual step is that of a first try after frames that went well (safety 1). Layers repel with the force they have
    at it, however short the steps of a later try are: an impulse for each step would throw the harder, the shorter
    they are.
    """

    longest: float
    guard: float
    usual: float


class Run:
    """A sheet, what it goes through and what it may touch."""

    def __init__(
        self,
        sheet: Sheet,
        phases: Sequence[Phase],
        collider: Solid | MovingGrid | None,
        contact: Contact | None,
        pins: Sequence[int],
        holds: Holds | None,
        *,
        air: Air | None,
        down: Sequence[float],
        substeps: int | None,
        integrator: str,
        pace: Pace | None = None,
    ) -> None:
        for name, value, (kind, remedy) in zip(
            _KINDS, (contact, holds, air, pace, collider), _KINDS.values(), strict=True
        ):
            if value is not None:
                of_kind(name, value, kind, remedy)
        if substeps is not None:
            whole("substeps", substeps, 1, f"1 to {MOST_FIXED} in a frame", most=MOST_FIXED)
        one_of("integrator", integrator, INTEGRATORS)
        self.sheet, self.phases, self.fixed, self.air = sheet, checked_phases(phases), substeps, air
        self.down, self.integrator, count = np.array(down, float), integrator, len(sheet.rest)
        self.pins = vertex_numbers("pins", pins, count)
        if holds is not None and len(holds.same) != count:
            raise SimCoreError(
                f"holds: of {len(holds.same)} vertices – the sheet has {count}: Holds.of({count}, …)"
            )
        for phase in self.phases:
            vertex_numbers("phase.pins", phase.pins, count)
        if isinstance(collider, MovingGrid):
            for moment in schedule(self.phases):
                collider.between(*moment.body)
        self.engine = Engine(sheet, collider=collider, contact=contact, holds=holds, pace=pace)
        self.pace = self.engine.pace
        self.certified: Certified | None = None
        none = np.zeros((0, 3))
        self._left = (none, none), (none, none)  # what the last frame left, as given out and in band order
        self._given = (contact or Contact(), holds or Holds.of(len(sheet.rest)))

    def certify(self, start: np.ndarray, solid: bool | Mesh) -> None:
        """From now on every frame is certified; start (V, 3) [m], solid: the mesh of a still collider, or True."""
        from sim_core.cloth.run.certified_run import (
            Certified,  # what only the certifier needs takes half a second
        )

        if self.integrator == "implicit":
            raise SimCoreError("certify: frames are done again by the explicit scheme – take integrator auto")
        self.certified = Certified(self.engine, start, None if solid is True else solid)  # type: ignore[arg-type]

    def begun(self, x: np.ndarray, v: np.ndarray) -> RunState:
        """The state before the first frame, from x, v (V, 3); a hopeless start is smoothed.

        Not where a solid, sewing pairs, bounds, images or limits of lengths are: a smooth sheet may lie across them.
        """
        engine, holds = self.engine, self.engine.holds
        held = engine.limited or len(holds.pairs) or len(holds.low) or len(holds.slaves)
        if held or engine.moving or len(engine.packed.kind) or self.certified is not None:
            return RunState(x, v)
        smooth, length = smoothed(self.sheet, x, self._pinned(self.phases[0]))
        return RunState(smooth, v, smoothed=length)

    def identity(self) -> tuple[object, ...]:
        """What, beside sheet and start, decides the bits of the result."""
        body = self.engine.moving
        moving = body and body.identity()
        contact, holds = self._given
        settings = (self.phases, contact, self.pins, self.air, self.down, self.fixed, self.integrator, moving)
        settings += () if self.air is None else (AIR_VERSION,)
        settings += () if self.pace == Pace() else (self.pace,)
        settings += () if self.engine.shell.thickness == 0.0 else (SHELL_VERSION,)
        looked = () if self.certified is None else self.certified.certifier.solid
        return (*settings, *self.engine.packed, *holds, self.certified is not None, *looked)

    def _pinned(self, phase: Phase) -> tuple[int, ...]:
        return tuple(sorted({*self.pins, *phase.pins}))

    def frame(self, state: RunState, now: Moment) -> None:
        """One frame, by the explicit scheme at 0.7 (or the pace's share) of the stable step of the current tangent.

        If it blows up it is rolled back and done with half the step, then by the implicit scheme; where layers touch
        or that does not help either, with half the step again and again.
        """
        self.frame_under(state, self._conditions(now, state.frame), self._pinned(now.phase))

    def frame_under(self, state: RunState, under: Conditions, pins: tuple[int, ...]) -> None:
        """One frame under the given conditions; broken off in the midst, it leaves the state as it was."""
        begun = replace(state, tally=replace(state.tally))
        try:
            self._frame(state, under, pins)
        except BaseException as error:
            for name in ("mode", "safety", "rollbacks", "fallbacks", "tally"):
                setattr(state, name, getattr(begun, name))
            if _interrupted(error):
                raise KeyboardInterrupt from error
            raise

    def _frame(self, state: RunState, under: Conditions, pins: tuple[int, ...]) -> None:
        engine = self.engine
        begin = self._begin(state)
        start = time.perf_counter()
        if self.integrator == "implicit":
            count = self.fixed or IMPLICIT_STEPS
            x, v = self._implicit(under, pins, begin, count)
            usual = 0.0
            if not np.isfinite(x).all():
                raise SimCoreError(
                    f"frame {state.frame}: the implicit scheme found no way on – use the explicit"
                )
        else:
            x, v, count, usual = self._explicit(state, under, pins, begin)
        engine.untangle(pins, x, v)
        if self.certified is not None:
            last = state.last_step
            x, v, count = self.certified.frame(state.tally, under, pins, begin, (x, v), last, count, usual)
        state.seconds.append(time.perf_counter() - start)
        way = np.zeros(x.shape[1])
        ways(begin[0], x, way)
        state.trace.append((float(np.percentile(way, 99)), float(way.max())))
        state.stretch = max(state.stretch, engine.stretch(x))
        state.positions, state.velocities = engine.outward(x), engine.outward(v)
        self._left = (state.positions, state.velocities), (x, v)
        state.last_step = FRAME / count
        state.frame, state.substeps = state.frame + 1, state.substeps + count

    def _begin(self, state: RunState) -> tuple[np.ndarray, np.ndarray]:
        """Positions and velocities (3, V) in band order: those the last frame left, if they are the state's."""
        given, arrays = self._left
        if given[0] is state.positions and given[1] is state.velocities:
            return arrays
        return self.engine.inward(state.positions), self.engine.inward(state.velocities)

    def _implicit(
        self, under: Conditions, pins: tuple[int, ...], begin: tuple[np.ndarray, np.ndarray], count: int
    ) -> tuple[np.ndarray, np.ndarray]:
        x, v = begin[0].copy(), begin[1].copy()
        self.engine.advance_implicit(under, pins, x, v, count)
        return x, v

    def _count(self, step: float) -> int:
        """Steps of a frame, of a whole number of impulses of bending, at a largest stable step [s]."""
        slow = self.pace.slow
        return slow * int(np.ceil(FRAME / (slow * self.pace.courant * step)))

    def _gives_in(self, attempt: int, count: int) -> bool:
        """Half the step did not help either, or there would be too many: the implicit scheme's turn, if it may."""
        late = attempt == 1 or (attempt == 0 and count > MOST_SUBSTEPS)
        return late and self.integrator == "auto" and self.engine.shell.thickness == 0.0

    def _paced(
        self, state: RunState, under: Conditions, pins: tuple[int, ...], begin: tuple[np.ndarray, np.ndarray]
    ) -> _Step:
        """The step of a frame that begins so; the state's mode changes."""
        engine, pace = self.engine, self.pace
        first = state.mode.shape != begin[0].shape
        mode = first_mode(begin[0].shape[1]) if first else state.mode.copy()
        stable = engine.step(pins, begin[0], mode, first=first)
        guard = pace.guard(stable, engine.bend_omega2)
        if guard > self.sheet.material.stiffness_damping:
            stable = stable_with(stable, guard)
        state.mode = mode
        bounds = min(engine.air_step(under, begin[1]), self._layer_step(under, begin))
        longest = min(stable, bounds / pace.courant)
        return _Step(longest, guard, FRAME / self._count(longest))

    def _explicit(
        self,
        state: RunState,
        under: Conditions,
        pins: tuple[int, ...],
        begin: tuple[np.ndarray, np.ndarray],
    ) -> tuple[np.ndarray, np.ndarray, int, float]:
        """Positions, velocities (3, V), steps and usual step [s] of one frame; safety, mode and counters change."""
        engine, longest = self.engine, np.inf
        if self.fixed:
            x, v = begin[0].copy(), begin[1].copy()
            engine.advance(under, pins, x, v, state.last_step, self.fixed)
            return x, v, self.fixed, FRAME / self.fixed
        step, guard, usual = self._paced(state, under, pins, begin)
        for attempt in range(MAX_HALVINGS):
            count = self._count(state.safety * step)
            if count <= MOST_SUBSTEPS:
                x, v = begin[0].copy(), begin[1].copy()
                engine.advance(under, pins, x, v, state.last_step, count, guard, usual=usual)
                good = engine.health.good(under, begin, (x, v))
                if not good and not under.quiet and np.isfinite(x).all():
                    # An edge beyond belief that half the step finds as long is the cloth's own, in a gale say.
                    before, longest = longest, engine.stretch(x)
                    good = abs(before / longest - 1) < CONFIRMED
                if good:
                    late = passing_step(engine.shell.thickness, v)
                    if FRAME / count <= LATE * late:
                        state.safety = min(1.0, state.safety * 1.1)
                        return x, v, count, usual
                    step = min(step, late / self.pace.courant)  # faster on the way than layers can bear
                    engine.forget()
                    continue
                engine.forget()
            if self._gives_in(attempt, count):
                x, v = self._implicit(under, pins, begin, IMPLICIT_STEPS)
                if engine.health.good(under, begin, (x, v)):
                    state.fallbacks += 1
                    return x, v, IMPLICIT_STEPS, usual
                engine.forget()
            state.safety, state.rollbacks = state.safety / 2, state.rollbacks + 1
        raise SimCoreError(f"frame {state.frame}: unstable even at 1/{2**MAX_HALVINGS} of the stable step")

    def _layer_step(self, under: Conditions, begin: tuple[np.ndarray, np.ndarray]) -> float:
        """Largest step [s] in which layers cannot pass each other, at the speeds a frame begins with."""
        if self.engine.shell.thickness == 0.0:
            return np.inf
        v = begin[1].copy()
        index = self.engine.number[under.led[0]]
        v[:, index] = (under.led[1].T - begin[0][:, index]) / FRAME
        return passing_step(self.engine.shell.thickness, v)

    def _conditions(self, now: Moment, frame: int) -> Conditions:
        material, phase = self.sheet.material, now.phase
        wind, press = self.engine.air(self.air, frame * FRAME)
        limit = self._given[0].speed_limit if phase.speed_limit is None else phase.speed_limit
        return Conditions(
            gravity=self.down * now.gravity,
            damping=material.mass_damping if phase.damping is None else phase.damping,
            friction=material.friction if phase.friction is None else phase.friction,
            speed_limit=limit,
            sewing=now.sewing,
            body=now.body,
            wind=wind,
            press=press,
        )


def _interrupted(error: BaseException | None) -> bool:
    """Whether an interrupt is behind it: compiled code comes back with SystemErrors, one the cause of another."""
    while isinstance(error, SystemError):
        error = error.__cause__
    return isinstance(error, KeyboardInterrupt)


def checked_state(
    sheet: Sheet, positions: np.ndarray, velocities: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """Copies of positions and velocities (V, 3); raises SimCoreError for wrong shapes and what is not finite."""
    of_kind("sheet", sheet, Sheet, "make one with Sheet.of")
    shape = (len(sheet.rest), 3)
    x = coordinates("positions", positions, shape)
    return x, np.zeros(shape) if velocities is None else coordinates("velocities", velocities, shape)
