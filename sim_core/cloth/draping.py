"""Runs a sheet through phases of gravity, damping and friction, frame by frame, and can be interrupted."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sim_core.cloth.checkpoint import RunState, load_checkpoint, run_key, save_checkpoint
from sim_core.cloth.collider import Packed, Solid
from sim_core.cloth.contact import contact_samples
from sim_core.cloth.forces import energies, stable_step
from sim_core.cloth.holding import Holds
from sim_core.cloth.moving import MovingGrid
from sim_core.cloth.phases import FRAME, Contact, Moment, Phase, schedule
from sim_core.cloth.repulsion import Shell
from sim_core.cloth.sheet import Sheet, Stencil
from sim_core.cloth.stepping import Surroundings, advance
from sim_core.errors import SimCoreError

ENGINE_VERSION = 1  # raise when equal inputs give other bits: old checkpoints are then left alone
_NOTHING = Packed(np.zeros(0, np.int64), np.zeros((0, 20)), np.zeros((2, 2, 2)))
_MAX_HALVINGS = 8
CHECKPOINT_SECONDS = 5.0  # between two writes of a checkpoint

Progress = Callable[[float, str], None]
OnFrame = Callable[[int, np.ndarray], None]


@dataclass(frozen=True)
class Drape:
    """A finished run: positions, velocities (V, 3), frames, substeps, seconds, rest displacement per frame [m]."""

    positions: np.ndarray
    velocities: np.ndarray
    frames: int
    substeps: int
    rollbacks: int
    seconds: float
    rest_p99: float
    rest_max: float
    trace: tuple[tuple[float, float], ...] = field(repr=False)


def drape(
    sheet: Sheet,
    positions: np.ndarray,
    phases: Sequence[Phase],
    *,
    collider: Solid | MovingGrid | None = None,
    contact: Contact | None = None,
    pins: Sequence[int] = (),
    holds: Holds | None = None,
    down: Sequence[float] = (0.0, -1.0, 0.0),
    substeps: int | None = None,
    velocities: np.ndarray | None = None,
    progress: Progress | None = None,
    on_frame: OnFrame | None = None,
    checkpoint: Path | None = None,
    checkpoint_seconds: float | None = None,
    keep: bool = False,
) -> Drape:
    """Simulates `sheet` from positions (V, 3) [m] through `phases`; frames last 1/25 s.

    substeps: a fixed number per frame instead of the adaptive one (for convergence studies; no watchdog).
    on_frame(index, positions (V, 3) float32) hears every frame; after a resume the earlier ones are replayed.
    checkpoint: a file that is rewritten every few seconds; a run resumed from it gives the same bits. keep: leave
    it behind, finished, for a caller who has more to do.
    Raises SimCoreError on bad input or when the step had to be halved 8 times in one frame.
    """
    start = time.perf_counter()
    x, v = _checked_state(sheet, positions, velocities)
    run = _Run(sheet, phases, collider, contact or Contact(), pins, holds, np.asarray(down, float), substeps)
    key = run_key(
        (ENGINE_VERSION, sheet.rest, sheet.faces, sheet.material, x, v, *run.identity(), on_frame is None)
    )
    state = (load_checkpoint(checkpoint, key) if checkpoint else None) or RunState(x, v)
    pause = CHECKPOINT_SECONDS if checkpoint_seconds is None else checkpoint_seconds
    _run_frames(run, state, _Hooks(progress, on_frame, checkpoint, key, pause))
    if checkpoint and keep:
        save_checkpoint(checkpoint, key, state)
    elif checkpoint:
        checkpoint.unlink(missing_ok=True)
    return _result(state, time.perf_counter() - start)


@dataclass(frozen=True)
class _Hooks:
    """Who hears of the frames, and where they are kept."""

    progress: Progress | None
    on_frame: OnFrame | None
    checkpoint: Path | None
    key: str
    pause: float

    def heard(self, state: RunState) -> None:
        """Hands the last frame on; kept for the film if the run may be interrupted."""
        if self.on_frame:
            frame = state.positions.astype(np.float32)
            if self.checkpoint:
                state.film.append(frame)
            self.on_frame(len(state.trace) - 1, frame)


def _run_frames(run: _Run, state: RunState, hooks: _Hooks) -> None:
    """All frames that are left; on any interrupt the state goes to the checkpoint first."""
    if hooks.on_frame:
        for index, frame in enumerate(state.film):
            hooks.on_frame(index, frame)
    saved, moments = time.perf_counter(), schedule(run.phases)
    try:
        while state.frame < len(moments):
            now = moments[state.frame]
            if hooks.progress:
                hooks.progress(state.frame / len(moments), now.phase.label)
            run.frame(state, now)
            if now.phase.rest is not None and state.trace[-1][0] < now.phase.rest:
                state.frame = _end_of(moments, state.frame, now.phase)
            hooks.heard(state)
            if hooks.checkpoint and time.perf_counter() - saved > hooks.pause:
                save_checkpoint(hooks.checkpoint, hooks.key, state)
                saved = time.perf_counter()
    except BaseException:
        if hooks.checkpoint:
            save_checkpoint(hooks.checkpoint, hooks.key, state)
        raise


def _result(state: RunState, seconds: float) -> Drape:
    p99, most = state.trace[-1] if state.trace else (0.0, 0.0)
    return Drape(
        state.positions,
        state.velocities,
        len(state.trace),
        state.substeps,
        state.rollbacks,
        seconds,
        p99,
        most,
        tuple(state.trace),
    )


def _end_of(moments: list[Moment], frame: int, phase: Phase) -> int:
    while frame < len(moments) and moments[frame].phase is phase:
        frame += 1
    return frame


def _checked_state(sheet: Sheet, x: np.ndarray, v: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    shape = (len(sheet.rest), 3)
    x = np.array(x, float, order="C")
    v = np.zeros(shape) if v is None else np.array(v, float, order="C")
    for name, array in (("positions", x), ("velocities", v)):
        if array.shape != shape:
            raise SimCoreError(f"{name}: shape {array.shape} – the sheet needs {shape}")
        if not np.isfinite(array).all():
            raise SimCoreError(
                f"{name}: vertex {np.flatnonzero(~np.isfinite(array).all(1))[0]} is not finite"
            )
    return x, v


class _Run:
    """The unchanging part of a run, and one frame of it."""

    def __init__(
        self,
        sheet: Sheet,
        phases: Sequence[Phase],
        collider: Solid | MovingGrid | None,
        contact: Contact,
        pins: Sequence[int],
        holds: Holds | None,
        down: np.ndarray,
        substeps: int | None,
    ) -> None:
        if not phases or any(not (np.isfinite(p.seconds) and p.seconds > 0) for p in phases):
            raise SimCoreError("phases: each needs a finite duration above 0 s, and there must be one")
        self.sheet, self.phases, self.contact, self.fixed = sheet, tuple(phases), contact, substeps
        self.pins = np.asarray(pins, np.int64)
        self.holds = holds or Holds.of(len(sheet.rest))
        self._pinned: dict[tuple[int, ...], Stencil] = {}
        self.moving = collider if isinstance(collider, MovingGrid) else None
        self.packed = collider.packed() if isinstance(collider, Solid) else _NOTHING
        vertices, middles = contact_samples(sheet.edges, sheet.faces, len(sheet.rest))
        image = np.zeros(len(sheet.rest), bool)
        image[self.holds.slaves[:, 0]] = True
        self.vertices = vertices[~image[vertices[:, 0]]]
        self.middles = middles[~image[middles].any(1)]
        self.down = down
        c = contact
        self.shell = Shell(
            float(c.thickness), float(c.skin), float(c.spring), float(c.self_friction), int(c.every)
        )

    def identity(self) -> tuple[object, ...]:
        """What, beside sheet and start, decides the bits of the result."""
        moving = self.moving and (self.moving.name, self.moving.origin, self.moving.cell, self.moving.count)
        return (
            self.phases,
            self.contact,
            self.pins,
            self.down,
            self.fixed,
            moving,
            *self.packed,
            *self.holds,
        )

    def stencil(self, phase: Phase) -> Stencil:
        """The sheet's stencil with the phase's pins."""
        if phase.pins not in self._pinned:
            pins = np.unique(np.concatenate([self.pins, np.asarray(phase.pins, np.int64)]))
            self._pinned[phase.pins] = self.sheet.pinned(pins)
        return self._pinned[phase.pins]

    def frame(self, state: RunState, now: Moment) -> None:
        """One frame at 0.7 of the stable step of the current tangent; rolled back and halved if it blows up."""
        before_x = state.positions
        for _ in range(_MAX_HALVINGS):
            x, v = before_x.copy(), state.velocities.copy()
            count = self.fixed or self._substeps(now.phase, x, state.safety)
            self._advance(state, now, x, v, count)
            if self.fixed or self._healthy(state, now, x, v):
                break
            state.safety, state.rollbacks = state.safety / 2, state.rollbacks + 1
        else:
            raise SimCoreError(
                f"frame {state.frame}: unstable even at 1/{2**_MAX_HALVINGS} of the stable step"
            )
        step = np.sqrt(((x - before_x) ** 2).sum(1))
        state.trace.append((float(np.percentile(step, 99)), float(step.max())))
        state.positions, state.velocities, state.last_step = x, v, FRAME / count
        state.frame, state.substeps = state.frame + 1, state.substeps + count
        state.safety = min(1.0, state.safety * 1.1)

    def _substeps(self, phase: Phase, x: np.ndarray, safety: float) -> int:
        step = 0.7 * safety * stable_step(self.stencil(phase), x, self.sheet.material.stiffness_damping)
        if not np.isfinite(step) or step <= 0:
            raise SimCoreError("positions: no stable step – edges of zero length or a non-finite state")
        return int(np.ceil(FRAME / step))

    def _advance(self, state: RunState, now: Moment, x: np.ndarray, v: np.ndarray, count: int) -> None:
        material, c, phase = self.sheet.material, self.contact, now.phase
        packed, body = self.moving.packed(*now.body) if self.moving else (self.packed, (0.0, 0.0))
        around = Surroundings(
            self.down * now.gravity,
            float(material.mass_damping if phase.damping is None else phase.damping),
            float(material.stiffness_damping),
            float(material.friction if phase.friction is None else phase.friction),
            float(c.clearance),
            float(c.sample_clearance),
            float(c.cap),
            float(c.speed_limit if phase.speed_limit is None else phase.speed_limit),
            now.sewing,
            body,
        )
        args = (
            self.stencil(phase),
            self.sheet.rest,
            self.sheet.faces,
            packed,
            self.vertices,
            self.middles,
            self.holds,
            self.shell,
            around,
        )
        advance(*args, x, v, state.last_step, FRAME / count, count)

    def _healthy(self, state: RunState, now: Moment, x: np.ndarray, v: np.ndarray) -> bool:
        """Finite, and no more energy than before (contact may add a little: it lifts and separates).

        Where sewing or a moving body does work, no edge may be twice its length instead.
        """
        if not (np.isfinite(x).all() and np.isfinite(v).all()):
            return False
        stencil, gravity = self.stencil(now.phase), now.gravity
        if now.sewing[0] != now.sewing[1] or now.body[0] != now.body[1]:
            side2 = ((x[stencil.edges[:, 0]] - x[stencil.edges[:, 1]]) ** 2).sum(1)
            return bool((side2 < 4 * stencil.length2).all())

        def energy(px: np.ndarray, pv: np.ndarray) -> tuple[float, float]:
            stored = sum(energies(stencil, px, pv))
            return stored, -gravity * float(self.sheet.mass @ (px @ self.down))

        (stored, height), (stored_after, height_after) = (
            energy(state.positions, state.velocities),
            energy(x, v),
        )
        weight = float(self.sheet.mass.sum()) * max(gravity, 1.0)
        return stored_after <= 1.5 * stored + max(height - height_after, 0.0) + 0.02 * weight
