"""Runs a sheet through phases of gravity, damping and friction, frame by frame, and can be interrupted."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Unpack

import numpy as np

from sim_core.cloth.run.adaptive_run import DrapeOptions, Run, Setup, checked_state
from sim_core.cloth.run.certificate import Certificate
from sim_core.cloth.run.checkpoint import (
    Checkpoint,
    RunState,
    checkpoint_file,
    load_checkpoint,
    run_key,
    save_checkpoint,
)
from sim_core.cloth.sheet.sheet import Sheet
from sim_core.cloth.step.frame import Frame, Phase
from sim_core.errors import FileProblem
from sim_core.validation import optional_callable

ENGINE_VERSION = (
    12  # raise when equal inputs give other bits on one machine: old checkpoints are then left alone
)
RESTED = 8  # frames in a row below a phase's rest, after which it ends: one of them alone may be chance
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
    velocities: np.ndarray | None = None,
    progress: Progress | None = None,
    on_frame: OnFrame | None = None,
    checkpoint: str | Path | Checkpoint | None = None,
    **options: Unpack[DrapeOptions],
) -> Drape:
    """Simulates `sheet` from positions, velocities (V, 3) [m, m/s] through `phases`; frames last 1/25 s.

    on_frame(index, positions (V, 3) float32) hears every frame; after a resume the earlier ones are replayed.
    checkpoint: a file that is rewritten every few seconds, or a `Checkpoint`; a run resumed from it on the same machine
    gives the same bits.

    options, all of which may be left out:
    collider: a Solid, or a MovingGrid whose keys the phases name; contact: how the cloth touches it and itself.
    pins: vertices held throughout; holds: sewing pairs, bounds, images, limits of lengths.
    air: what blows, and brakes; None costs nothing.
    down: the way in which a phase's gravity is counted.
    substeps: a fixed number per frame instead of the adaptive one (for convergence studies; no watchdog).
    integrator: "explicit", "implicit" (backward Euler, substeps steps a frame or 8), or "auto": explicit, with the
    implicit scheme for frames that would blow up.
    pace: precision of the loop and share of the stable step that is taken (None: double, 0.7).
    certify: look, every frame, whether anything passed through the cloth, by continuous collision detection (needs
    ipctk), and do the frame again where it did; or the mesh, vertices (S, 3) [m] and faces, of a still collider to
    be looked at as well. The start must be free of intersections.

    positions that are no sheet, points thrown about, are smoothed into one before the first frame, unless a solid or
    holds are there (`smoothing.py`; `Drape.smoothed` tells).
    Raises SimCoreError on bad input or when the step had to be halved 8 times in one frame.
    """
    start = time.perf_counter()
    x, v = checked_state(sheet, positions, velocities)
    for name, function in (("progress", progress), ("on_frame", on_frame)):
        optional_callable(name, function)
    place = checkpoint if isinstance(checkpoint, Checkpoint) or checkpoint is None else Checkpoint(checkpoint)
    file = place and checkpoint_file(place.path)
    run = Run(Setup(sheet, phases, **options))
    begun = run.begun(x, v)
    begin = {
        "engine": ENGINE_VERSION,
        "positions": begun.positions,
        "velocities": v,
        "film": on_frame is not None,
    }
    key = run_key(begin | run.identity())
    found = load_checkpoint(file, key) if file else None
    if file and place and place.only_own and not found and file.exists():
        raise FileProblem(
            f"{file}: no state of this run (other settings, an older engine, or damaged) – "
            "name another file, or remove it"
        )
    state = found or begun
    _run_frames(run, state, _Hooks(progress, on_frame, file, key))
    if file and place and place.keep:
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
    saved, frames = time.perf_counter(), run.frames
    try:
        while state.frame < len(frames):
            number = frames[state.frame].phase
            phase = run.setup.phases[number]
            if hooks.progress:
                hooks.progress(state.frame / len(frames), phase.label)
            run.frame(state)
            if phase.rest is not None and _rested(state, frames, phase.rest):
                state.frame = _end_of(frames, state.frame, number)
            hooks.heard(state)
            if hooks.checkpoint and time.perf_counter() - saved > CHECKPOINT_SECONDS:
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
        positions=state.positions,
        velocities=state.velocities,
        frames=len(state.trace),
        substeps=state.substeps,
        rollbacks=state.rollbacks,
        seconds=seconds,
        rest_p99=p99,
        rest_max=most,
        trace=tuple(state.trace),
        fallbacks=state.fallbacks,
        worst_stretch=state.stretch,
        frame_seconds=tuple(state.seconds),
        certificate=found,
        smoothed=state.smoothed,
    )


def _rested(state: RunState, frames: list[Frame], rest: float) -> bool:
    """Whether the last frames of the phase that is on have all moved less than `rest` [m, p99]."""
    last = frames[state.frame - RESTED : state.frame] if state.frame >= RESTED else []
    calm = all(p99 < rest for p99, _ in state.trace[-RESTED:])
    return calm and bool(last) and last[0].phase == last[-1].phase


def _end_of(frames: list[Frame], index: int, phase: int) -> int:
    while index < len(frames) and frames[index].phase == phase:
        index += 1
    return index
