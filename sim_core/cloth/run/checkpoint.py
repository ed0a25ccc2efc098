"""The state of a run on disk: written whole or not at all, read only by the run it belongs to."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sim_core.cloth.run.certificate import Tally
from sim_core.errors import FileProblem
from sim_core.validation import excerpt, instance_of
from sim_core.validation.files import read_npz

_ARRAYS = ("key", "positions", "velocities", "numbers", "trace", "film", "mode")
_NUMBERS: dict[
    str, type[int] | type[float]
] = {  # of a state, as they stand in `numbers`; then those of its tally
    "frame": int,
    "last_step": float,
    "safety": float,
    "rollbacks": int,
    "substeps": int,
    "fallbacks": int,
    "stretch": float,
    "smoothed": float,
}
_TALLY = ("redone", "zones", "uncertified")


@dataclass
class RunState:
    """All that a run needs to go on with the same bits where it began: positions and velocities (V, 3), step, frame,
    safety, mode."""

    positions: np.ndarray
    velocities: np.ndarray
    frame: int = 0
    last_step: float = 0.0
    safety: float = 1.0
    rollbacks: int = 0
    substeps: int = 0
    fallbacks: int = 0
    stretch: float = 1.0  # the longest an edge has been, as a share of its rest length
    trace: list[tuple[float, float]] = field(default_factory=list)  # displacement p99, max per frame [m]
    seconds: list[float] = field(default_factory=list)  # per frame of this process; not kept
    film: list[np.ndarray] = field(default_factory=list)  # (V, 3) float32 per finished frame
    mode: np.ndarray = field(default_factory=lambda: np.zeros((3, 0)))  # stiffest motion seen so far (3, V)
    tally: Tally = field(default_factory=Tally)  # of the certifier
    smoothed: float = 0.0  # [m] over which a hopeless start was smoothed


@dataclass(frozen=True)
class Checkpoint:
    """A file that keeps the state of a run, rewritten every few seconds.

    keep: leave it behind, finished, for a caller who has more to do. only_own: refuse a state that the run cannot go on
    from, where it would else be written over; a file that is no state at all is always refused.
    """

    path: str | Path
    keep: bool = False
    only_own: bool = False

    def __post_init__(self) -> None:
        for name in ("keep", "only_own"):
            instance_of(f"checkpoint.{name}", getattr(self, name), bool, "True or False is meant")


def run_key(parts: Mapping[str, object]) -> str:
    """A hash of everything a run depends on, by name; arrays by their bytes, the rest by its text.

    Arrays that were computed differ in their last bits from machine to machine, so a run goes on where it began.
    """
    digest = hashlib.sha256()
    for name, part in sorted(parts.items()):
        data = np.ascontiguousarray(part).tobytes() if isinstance(part, np.ndarray) else repr(part).encode()
        digest.update(f"{name} {len(data)}:".encode() + data)
    return digest.hexdigest()


def checkpoint_file(path: str | Path) -> Path:
    """The path, with a folder to write to; raises FileProblem for what is no file or holds something else.

    A state cut off in the midst is no hindrance: it will be written over.
    """
    if not isinstance(path, str | Path) or not str(path) or "\0" in str(path):
        raise FileProblem(f"checkpoint: {excerpt(path)} – give the path of a file")
    file = Path(path)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        if file.is_dir():
            raise FileProblem(f"{file}: this is a folder – name a file")
        with file.open("rb") as stream:
            begin = stream.read(2)
    except FileNotFoundError:
        return file
    except OSError as error:
        raise FileProblem(f"{file}: {error.strerror} – name another file for the checkpoint") from error
    if begin not in (b"", b"PK"):
        raise FileProblem(f"{file}: this is no state of a run – name another file, or remove it")
    return file


def save_checkpoint(path: Path, key: str, state: RunState) -> None:
    """Writes the state beside `path` and renames it over: an interrupt leaves the old or the new one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(path.name + ".part")
    numbers = [getattr(state, name) for name in _NUMBERS] + [getattr(state.tally, name) for name in _TALLY]
    with beside.open("wb") as stream:
        np.savez(
            stream,
            key=np.array(key),
            positions=state.positions,
            velocities=state.velocities,
            numbers=np.array(numbers, float),
            trace=np.array(state.trace, float).reshape(-1, 2),
            mode=state.mode,
            film=np.array(state.film, np.float32).reshape(-1, *state.positions.shape),
        )
        stream.flush()
        os.fsync(stream.fileno())
    beside.replace(path)


def load_checkpoint(path: Path, key: str) -> RunState | None:
    """The state saved at `path`, or None if there is none, it is damaged, or belongs to other inputs."""
    try:
        data = read_npz(path, _ARRAYS, "a checkpoint", "the run begins anew")
        if str(data["key"]) != key:
            return None
        kinds = [*_NUMBERS.values(), *(int for _ in _TALLY)]
        values = [kind(number) for kind, number in zip(kinds, data["numbers"], strict=True)]
        return RunState(
            positions=data["positions"],
            velocities=data["velocities"],
            trace=[(float(p), float(m)) for p, m in data["trace"]],
            film=list(data["film"]),
            mode=data["mode"],
            tally=Tally(**dict(zip(_TALLY, values[len(_NUMBERS) :], strict=True))),
            **dict(zip(_NUMBERS, values, strict=False)),
        )
    except (FileProblem, ValueError, TypeError, OverflowError):
        return None
