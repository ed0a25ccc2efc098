"""The state after a pass, kept in a file, so that an interrupted bake goes on where it was."""

from __future__ import annotations

import hashlib
import os
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hall_app.light.lamps import SpotRows
from hall_app.light.model import Sampling, Surfaces

__all__ = ["State", "key_of", "load", "save"]

VERSION = 2  # raise it when what is computed changes

Singles = NDArray[np.float32]


@dataclass
class State:
    """What a pass leaves: its number, light by slot (S, 3), error (H, W, 3), points found inside (M,), tally."""

    done: int
    light: Singles
    error: Singles
    inside: NDArray[np.bool_]
    tally: NDArray[np.int64]
    seconds: float
    cpu: float


def key_of(surfaces: Surfaces, rows: SpotRows, sampling: Sampling, options: tuple[float, ...]) -> str:
    """Hash of all that decides about the result."""
    names = ("vertices", "faces", "chart", "chart_uv", "density", "albedo", "emission", "two_sided")
    digest = hashlib.sha256(repr((VERSION, sampling, options)).encode())
    for array in (*(getattr(surfaces, name) for name in names), *rows):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def load(path: Path | None, key: str) -> State | None:
    """The state kept in `path`, None where there is none, it is damaged or belongs to another bake."""
    if path is None or not Path(path).is_file():
        return None
    try:
        with np.load(path) as kept:
            if str(kept["key"]) != key:
                return None
            done, seconds, cpu = kept["numbers"]
            return State(
                int(done),
                kept["light"],
                kept["error"],
                kept["inside"],
                kept["tally"],
                float(seconds),
                float(cpu),
            )
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None


def save(path: Path | None, key: str, state: State) -> None:
    """Write the state whole or not at all."""
    if path is None:
        return
    part = Path(f"{path}.part")
    part.parent.mkdir(parents=True, exist_ok=True)
    with part.open("wb") as file:
        numbers = np.array([state.done, state.seconds, state.cpu])
        np.savez(
            file, key=key, numbers=numbers, light=state.light, error=state.error, inside=state.inside,
            tally=state.tally,
        )  # fmt: skip
    os.replace(part, path)
