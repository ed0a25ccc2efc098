"""Runs a sheet through phases of gravity, damping and friction, frame by frame, and can be interrupted."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sim_core.cloth.contact.constraints import Holds
from sim_core.cloth.contact.moving_grid import MovingGrid
from sim_core.cloth.contact.solids import Solid
from sim_core.cloth.run.adaptive_run import Run, checked_state
from sim_core.cloth.run.certificate import Certificate
from sim_core.cloth.run.checkpoint import RunState, checkpoint_file, load_checkpoint, run_key, save_checkpoint
from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.air import Air
from sim_core.cloth.step.phases import FRAME, Contact, Moment, Phase, schedule
from sim_core.cloth.step.precision import Pace
from sim_core.errors import FileProblem, SimCoreError
from sim_core.validation import called, finite, triple

if TYPE_CHECKING:
    from sim_core.cloth.run.certifier import Mesh

__all__ = ["ENGINE_VERSION", "FRAME", "Contact", "Drape", "OnFrame", "Phase", "Progress", "drape"]

ENGINE_VERSION = (
    4  # raise when equal inputs give other bits on one machine: old checkpoints are then left alone
)
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
    fallbacks: int = 0  # frames that were rolled back and done by the implicit scheme
    worst_stretch: float = (
        1.0  # longest an edge has been at the end of a frame, as a share of its rest length
    )
    frame_seconds: tuple[float, ...] = field(default=(), repr=False)  # what each frame of this process took
    certificate: Certificate | None = None  # of a run under the certifier
    smoothed: float = 0.0  # [m] over which a hopeless start was smoothed first; 0: it began where it was put


def drape(
    sheet: Sheet,
    positions: np.ndarray,
    phases: Sequence[Phase],
    *,
    collider: Solid | MovingGrid | None = None,
    contact: Contact | None = None,
    pins: Sequence[int] = (),
    holds: Holds | None = None,
    air: Air | None = None,
    down: Sequence[float] = (0.0, -1.0, 0.0),
    substeps: int | None = None,
    integrator: str = "auto",
    pace: Pace | None = None,
    velocities: np.ndarray | None = None,
    progress: Progress | None = None,
    on_frame: OnFrame | None = None,
    checkpoint: str | Path | None = None,
    checkpoint_seconds: float | None = None,
    keep: bool = False,
    only_own: bool = False,
    certify: bool | Mesh = False,
) -> Drape:
    """Simulates `sheet` from positions (V, 3) [m] through `phases`; frames last 1/25 s.

    substeps: a fixed number per frame instead of the adaptive one (for convergence studies; no watchdog).
    integrator: "explicit", "implicit" (backward Euler, substeps steps a frame or 8), or "auto": explicit, with the
    implicit scheme for frames that would blow up.
    down: the way in which a phase's gravity is counted.
    pace: precision of the loop and share of the stable step that is taken (None: double, 0.7).
    air: what blows, and brakes; None costs nothing.
    positions that are no sheet, points thrown about, are smoothed into one before the first frame, unless a solid or
    holds are there (`smoothing.py`; `Drape.smoothed` tells).
    on_frame(index, positions (V, 3) float32) hears every frame; after a resume the earlier ones are replayed.
    checkpoint: a file that is rewritten every few seconds; a run resumed from it on the same machine gives the same
    bits. keep: leave it behind, finished, for a caller who has more to do. only_own: refuse a state that this run
    cannot go on from, where it would else be written over; a file that is no state at all is always refused.
    certify: look, every frame, whether anything passed through the cloth, by continuous collision detection (needs
    ipctk), and do the frame again where it did; or the mesh, vertices (S, 3) [m] and faces, of a still collider to
    be looked at as well. The start must be free of intersections.
    Raises SimCoreError on bad input or when the step had to be halved 8 times in one frame.
    """
    start = time.perf_counter()
    x, v = checked_state(sheet, positions, velocities)
    if not any(triple("down", down, "of the way down")):
        raise SimCoreError("down: (0, 0, 0) has no direction – for no gravity give Phase(…, gravity=(0, 0))")
    for name, function in (("progress", progress), ("on_frame", on_frame)):
        called(name, function)
    pause = CHECKPOINT_SECONDS
    if checkpoint_seconds is not None:
        pause = finite("checkpoint_seconds", checkpoint_seconds, least=0)
    file = None if checkpoint is None else checkpoint_file(checkpoint)
    run = Run(
        sheet,
        phases,
        collider,
        contact,
        pins,
        holds,
        air=air,
        down=down,
        substeps=substeps,
        integrator=integrator,
        pace=pace,
    )
    if certify is not False:
        run.certify(x, certify)
    begun = run.begun(x, v)
    x = begun.positions
    key = run_key(
        (ENGINE_VERSION, sheet.rest, sheet.faces, sheet.material, x, v, *run.identity(), on_frame is None)
        + (sheet.mass, sheet.corner, sheet.stencil.own, sheet.stencil.coupling, sheet.stencil.bend)
    )
    found = load_checkpoint(file, key) if file else None
    if file and only_own and not found and file.exists():
        raise FileProblem(
            f"{file}: no state of this run (other settings, an older engine, or damaged) – "
            "name another file, or remove it"
        )
    state = found or begun
    _run_frames(run, state, _Hooks(progress, on_frame, file, key, pause))
    if file and keep:
        save_checkpoint(file, key, state)
    elif file:
        file.unlink(missing_ok=True)
    return _result(run, state, time.perf_counter() - start)


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
            with np.errstate(over="ignore"):  # too few substeps were asked for: their places may be beyond it
                frame = state.positions.astype(np.float32)
            if self.checkpoint:
                state.film.append(frame)
            self.on_frame(len(state.trace) - 1, frame)


def _run_frames(run: Run, state: RunState, hooks: _Hooks) -> None:
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


def _result(run: Run, state: RunState, seconds: float) -> Drape:
    looked = run.certified
    found = looked and looked.certificate(state.tally, len(state.trace), state.positions)
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
        state.fallbacks,
        state.stretch,
        tuple(state.seconds),
        found,
        state.smoothed,
    )


def _end_of(moments: list[Moment], frame: int, phase: Phase) -> int:
    while frame < len(moments) and moments[frame].phase is phase:
        frame += 1
    return frame
