"""The unchanging part of a run, and one frame of it: adaptive step, watchdog, roll-back."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypedDict

import numpy as np

from sim_core.cloth.contact.constraints import Holds
from sim_core.cloth.contact.moving_grid import MovingGrid
from sim_core.cloth.contact.solids import Solid
from sim_core.cloth.run.causes import cause
from sim_core.cloth.run.checkpoint import RunState
from sim_core.cloth.run.smoothing import smoothed
from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.air import Air
from sim_core.cloth.step.engine import IMPLICIT_STEPS, Engine, Stride
from sim_core.cloth.step.frame import FRAME, Contact, Frame, Phase, State, checked_phases, schedule
from sim_core.cloth.step.haste import LATE
from sim_core.cloth.step.kernels.diagnostics import ways
from sim_core.cloth.step.precision import Pace
from sim_core.cloth.step.stability import first_mode, stable_with
from sim_core.errors import SimCoreError
from sim_core.metrics import intersections
from sim_core.validation import coordinates, instance_of, integer, one_of, vector3, vertex_indices

if TYPE_CHECKING:
    from sim_core.cloth.run.certified_run import Certified
    from sim_core.cloth.run.certifier import Mesh

MAX_HALVINGS = 8
AIR_VERSION = 2  # raise when the same air gives other bits: `ENGINE_VERSION` would make every garment stale
SHELL_VERSION = 5  # the same for layers that touch
SURE = 8  # times that the stiffest mode of a run with layers is looked for before its first frame
CONFIRMED = 0.02  # by which the longest edge may differ when half the step is to confirm it
MOST_SUBSTEPS = 50_000  # a frame: beyond, the explicit scheme is not tried
MORE_IMPLICIT = (IMPLICIT_STEPS, 64, 512)  # steps of backward Euler that are tried then, one after the other
MOST_FIXED = 100_000  # substeps of a frame that may be asked for
INTEGRATORS = ("auto", "explicit", "implicit")
_KINDS = {  # of what a run may be given, and the remedy
    "contact": (Contact, "a Contact is meant"),
    "holds": (Holds, "make them with Holds.of"),
    "air": (Air, "an Air is meant, such as Air((4, 0, 1))"),
    "pace": (Pace, 'a Pace is meant, such as Pace("single", 0.9)'),
    "collider": (Solid | MovingGrid, "give a Solid, or moving_mesh() of a closed mesh"),
}


@dataclass(frozen=True)
class Setup:
    """What a run is of; `drape` tells what each is. Raises SimCoreError for what is none."""

    sheet: Sheet
    phases: Sequence[Phase]
    collider: Solid | MovingGrid | None = None
    contact: Contact | None = None
    pins: Sequence[int] = ()
    holds: Holds | None = None
    air: Air | None = None
    down: Sequence[float] = (0.0, -1.0, 0.0)
    substeps: int | None = None
    integrator: str = "auto"
    pace: Pace | None = None
    certify: bool | Mesh = False

    def __post_init__(self) -> None:
        if not any(vector3("down", self.down, "of the way down")):
            raise SimCoreError(
                "down: (0, 0, 0) has no direction – for no gravity give Phase(…, gravity=(0, 0))"
            )
        for name, (kind, remedy) in _KINDS.items():
            if getattr(self, name) is not None:
                instance_of(name, getattr(self, name), kind, remedy)
        if self.substeps is not None:
            integer("substeps", self.substeps, 1, f"1 to {MOST_FIXED} in a frame", most=MOST_FIXED)
        one_of("integrator", self.integrator, INTEGRATORS)
        count = len(self.sheet.rest)
        object.__setattr__(self, "phases", checked_phases(self.phases))
        object.__setattr__(self, "pins", vertex_indices("pins", self.pins, count))
        if self.holds is not None and len(self.holds.same) != count:
            raise SimCoreError(
                f"holds: of {len(self.holds.same)} vertices – the sheet has {count}: Holds.of({count}, …)"
            )
        for phase in self.phases:
            vertex_indices("phase.pins", phase.pins, count)


class Options(TypedDict, total=False):
    """Of a `Setup` what a live cloth takes, too."""

    collider: Solid | MovingGrid | None
    contact: Contact | None
    pins: Sequence[int]
    holds: Holds | None
    air: Air | None
    substeps: int | None
    integrator: str
    pace: Pace | None
    certify: bool | Mesh


class DrapeOptions(Options, total=False):
    """Of a `Setup` all but the sheet and its phases."""

    down: Sequence[float]


class Run:
    """A sheet, what it goes through and what it may touch."""

    def __init__(self, setup: Setup) -> None:
        """Raises SimCoreError where a phase leads a moving body beyond its keys."""
        self.setup, self.sheet = setup, setup.sheet
        contact, material = setup.contact or Contact(), setup.sheet.material
        self.usual = Frame(
            gravity=np.array(setup.down, float),
            damping=float(material.mass_damping),
            friction=float(material.friction),
            speed_limit=float(contact.speed_limit),
            pins=np.array(setup.pins, np.int64),
        )
        self.frames = schedule(setup.phases, self.usual)
        if isinstance(setup.collider, MovingGrid):
            for frame in self.frames:
                setup.collider.between(*frame.body)
        self.engine = Engine(
            setup.sheet, collider=setup.collider, contact=contact, holds=setup.holds, pace=setup.pace
        )
        self.pace = self.engine.pace
        self.certified: Certified | None = None
        none = State(np.zeros((0, 3)), np.zeros((0, 3)))
        self._left = none, none  # what the last frame left, as given out and in band order

    def _certify(self, start: np.ndarray) -> None:
        """From now on every frame is certified; start (V, 3) [m]."""
        from sim_core.cloth.run.certified_run import (
            Certified,  # what only the certifier needs takes half a second
        )

        if self.setup.integrator == "implicit":
            raise SimCoreError("certify: frames are done again by the explicit scheme – take integrator auto")
        solid = self.setup.certify
        self.certified = Certified(self.engine, start, None if isinstance(solid, bool) else solid)

    def begun(self, x: np.ndarray, v: np.ndarray) -> RunState:
        """The state before the first frame, from x, v (V, 3); a hopeless start is smoothed.

        Layers that lie exactly on each other are a little apart then. It is not smoothed where a solid, sewing pairs,
        bounds, images or limits of lengths are: a smooth sheet may lie across them.
        """
        if self.setup.certify is not False:
            self._certify(x)
        engine, holds = self.engine, self.engine.holds
        x = engine.parted(self.frames[0].pins, x)
        held = engine.limited or len(holds.pairs) or len(holds.low) or len(holds.slaves)
        if held or engine.moving or len(engine.packed.kind) or self.certified is not None:
            return RunState(x, v)
        smooth, length = smoothed(self.sheet, x, self.frames[0].pins)
        return RunState(smooth, v, smoothed=length)

    def identity(self) -> dict[str, object]:
        """What decides the bits of the result, beside where it starts."""
        setup, sheet, engine = self.setup, self.sheet, self.engine
        stencil, body, layers = sheet.stencil, engine.moving, engine.shell.thickness > 0.0
        rest = {"rest": sheet.rest, "faces": sheet.faces, "corner": sheet.corner, "mass": sheet.mass}
        forces = {"own": stencil.own, "coupling": stencil.coupling, "bend": stencil.bend}
        solids = {f"solid.{name}": value for name, value in engine.packed._asdict().items()}
        if body:
            solids |= {"body": body.name, "origin": body.origin, "cell": body.cell, "keys": body.count}
            solids["beside"] = body.beside
        looked = self.certified and self.certified.certifier.solid
        return {
            **rest,
            **forces,
            "material": sheet.material,
            "phases": setup.phases,
            "pins": setup.pins,
            "down": self.usual.gravity,
            "air": setup.air and (setup.air, AIR_VERSION),
            "contact": (setup.contact or Contact(), SHELL_VERSION * layers),
            "pace": self.pace,
            "substeps": setup.substeps,
            "integrator": setup.integrator,
            **solids,
            **{f"holds.{name}": value for name, value in engine.holds._asdict().items()},
            "certified": looked is not None,
            **dict(zip(("vertices", "sides"), looked or (), strict=False)),
        }

    def frame(self, state: RunState) -> None:
        """The next frame, by the explicit scheme at 0.7 (or the pace's share) of the stable step of the tangent.

        If it blows up it is rolled back and done with half the step, then by the implicit scheme; where layers touch
        or that does not help either, with half the step again and again.
        """
        frame, air = self.frames[state.frame], self.setup.air
        if air is not None:
            frame = frame._replace(wind=air.over(state.frame * FRAME), press=air.press)
        self.frame_under(state, frame)

    def frame_under(self, state: RunState, frame: Frame) -> None:
        """One frame as it is told; broken off in the midst, it leaves the state as it was."""
        begun = replace(state, tally=replace(state.tally))
        try:
            self._frame(state, frame)
        except BaseException as error:
            for name in ("mode", "safety", "rollbacks", "fallbacks", "tally"):
                setattr(state, name, getattr(begun, name))
            self.engine.forget()  # compiled loops left their lists half written
            if _interrupted(error):
                raise KeyboardInterrupt from error
            raise

    def _frame(self, state: RunState, frame: Frame) -> None:
        engine = self.engine
        begin = self._begin(state)
        start = time.perf_counter()
        if self.setup.integrator == "implicit":
            stride = Stride(self.setup.substeps or IMPLICIT_STEPS, state.last_step)
            end = self._implicit(frame, begin, stride.count)
            if not np.isfinite(end.x).all():
                raise SimCoreError(
                    f"frame {state.frame}: the implicit scheme found no way on – use the explicit"
                )
        else:
            end, stride = self._explicit(state, frame, begin)
        engine.untangle(frame.pins, end)
        count = stride.count
        if self.certified is not None:
            end, count = self.certified.frame(state.tally, frame, begin, end, stride)
        state.seconds.append(time.perf_counter() - start)
        way = np.zeros(end.x.shape[1])
        ways(begin.x, end.x, way)
        state.trace.append((float(np.percentile(way, 99)), float(way.max())))
        state.stretch = max(state.stretch, engine.stretch(end.x))
        state.positions, state.velocities = engine.outward(end.x), engine.outward(end.v)
        self._left = State(state.positions, state.velocities), end
        state.last_step = FRAME / count
        state.frame, state.substeps = state.frame + 1, state.substeps + count

    def _begin(self, state: RunState) -> State:
        """The state (3, V) in band order: what the last frame left, if that is the run's."""
        given, left = self._left
        if given.x is state.positions and given.v is state.velocities:
            return left
        return State(self.engine.inward(state.positions), self.engine.inward(state.velocities))

    def _implicit(self, frame: Frame, begin: State, count: int) -> State:
        end = begin.copy()
        self.engine.advance_implicit(frame, end, count)
        return end

    def _count(self, step: float) -> int:
        """Steps of a frame, of a whole number of impulses of bending, at a largest stable step [s]."""
        slow = self.pace.slow
        return slow * int(np.ceil(FRAME / (slow * self.pace.courant * step)))

    def _gives_in(self, attempt: int, count: int) -> bool:
        """Half the step did not help either, or there would be too many: the implicit scheme's turn, if it may."""
        late = attempt == 1 or (attempt == 0 and count > MOST_SUBSTEPS)
        return late and self.setup.integrator == "auto" and self.engine.shell.thickness == 0.0

    def _paced(self, state: RunState, frame: Frame, begin: State) -> tuple[float, Stride]:
        """The longest step [s] of a frame that begins so, and how it goes at that; the state's mode changes.

        Its usual step is that of a first try after frames that went well (safety 1). Layers repel with the force they
        have at it, however short the steps of a later try are: an impulse for each step would throw the harder, the
        shorter they are.
        """
        engine, pace = self.engine, self.pace
        first = state.mode.shape != begin.x.shape
        mode = first_mode(begin.x.shape[1]) if first else state.mode.copy()
        stable = engine.step(frame.pins, begin.x, mode, first=first)
        if first and engine.shell.thickness > 0.0:
            # Found from nothing it is a percent too soft: at the step after, layers at rest would bear otherwise.
            for _ in range(SURE):
                stable = engine.step(frame.pins, begin.x, mode, first=False)
        guard = pace.guard(stable, engine.bend_omega2)
        if guard > self.sheet.material.stiffness_damping:
            stable = stable_with(stable, guard)
        state.mode = mode
        bounds = min(engine.air_step(frame, begin.v), self._layer_step(frame, begin))
        longest = min(stable, bounds / pace.courant)
        count = self._count(longest)
        return longest, Stride(count, state.last_step, guard, usual=FRAME / count, breaks=True)

    def _explicit(self, state: RunState, frame: Frame, begin: State) -> tuple[State, Stride]:
        """Where one frame leads and how it was gone through; the run's safety, mode and counters change."""
        engine, longest = self.engine, np.inf
        if self.setup.substeps:
            end = begin.copy()
            engine.advance(frame, end, Stride(self.setup.substeps, state.last_step))
            return end, Stride(self.setup.substeps, state.last_step, usual=FRAME / self.setup.substeps)
        (step, stride), gave_in = self._paced(state, frame, begin), False
        for attempt in range(MAX_HALVINGS):
            stride = stride._replace(count=self._count(state.safety * step))
            if stride.count <= MOST_SUBSTEPS:
                end = begin.copy()
                if not engine.advance(frame, end, stride):
                    # What blew up is faster than layers ever were: its speed asks for no more than two halvings.
                    step = min(0.5 * step, max(self._passing(state, end), 0.25 * step))
                    engine.forget()
                    continue
                good = engine.health.good(frame, begin, end)
                if not good and not frame.quiet and np.isfinite(end.x).all():
                    # An edge beyond belief that half the step finds as long is the cloth's own, in a gale say.
                    before, longest = longest, engine.stretch(end.x)
                    good = abs(before / longest - 1) < CONFIRMED
                if good and (engine.took_back or engine.pressed) and not self._uncrossed(begin, end):
                    good = False
                if good:
                    if FRAME / stride.count <= LATE * engine.passing_step(end.v):
                        state.safety = min(1.0, state.safety * 1.1)
                        return end, stride
                    step = min(step, self._passing(state, end))  # faster on the way than layers can bear
                    engine.forget()
                    continue
                engine.forget()
            if not gave_in and self._gives_in(attempt, stride.count):
                gave_in = True
                for count in MORE_IMPLICIT if stride.count > MOST_SUBSTEPS else MORE_IMPLICIT[:1]:
                    end = self._implicit(frame, begin, count)
                    if engine.health.good(frame, begin, end):
                        state.fallbacks += 1
                        return end, stride._replace(count=count)
                    engine.forget()
            state.safety, state.rollbacks = state.safety / 2, state.rollbacks + 1
        why = cause(engine, frame, begin, MOST_SUBSTEPS, self._count(step))
        raise SimCoreError(f"frame {state.frame}: {why}")

    def _uncrossed(self, begin: State, end: State) -> bool:
        """Whether no layer crosses another that did not when the frame began, changed sides, or is pressed through."""
        if self.engine.contact.untangle:  # what passed through is taken out again after the frame
            return True
        if self.engine.pressed or self.engine.swapped(begin, end):
            return False
        before, after = (intersections(state.x.T, self.engine.mesh.faces) for state in (begin, end))
        return after <= before

    def _passing(self, state: RunState, end: State) -> float:
        """Largest stable step [s] whose share that is taken lets no layers pass each other at the speeds of `end`."""
        share = self.pace.courant * state.safety
        return self.engine.passing_step(end.v) / share

    def _layer_step(self, frame: Frame, begin: State) -> float:
        """Largest step [s] in which layers cannot pass each other, at the speeds a frame begins with."""
        if self.engine.shell.thickness == 0.0:
            return np.inf
        v = begin.v.copy()
        index = self.engine.number[frame.led]
        v[:, index] = (frame.places.T - begin.x[:, index]) / FRAME
        return self.engine.passing_step(v)


def _interrupted(error: BaseException | None) -> bool:
    """Whether an interrupt is behind it: compiled code comes back with SystemErrors, one the cause of another."""
    while isinstance(error, SystemError):
        error = error.__cause__
    return isinstance(error, KeyboardInterrupt)


def checked_state(
    sheet: Sheet, positions: np.ndarray, velocities: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """Copies of positions and velocities (V, 3); raises SimCoreError for wrong shapes and what is not finite."""
    instance_of("sheet", sheet, Sheet, "make one with Sheet.of")
    shape = (len(sheet.rest), 3)
    x = coordinates("positions", positions, shape)
    return x, np.zeros(shape) if velocities is None else coordinates("velocities", velocities, shape)
