"""What a dressing writes down about itself: versions of what computed it, seconds per stage, and what it keeps on disk
to go on from."""

from __future__ import annotations

import platform
import re
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numba
import numpy as np

from sim_core.cloth import Checkpoint
from sim_core.cloth.run.drape_run import ENGINE_VERSION
from sim_core.errors import FileProblem
from sim_core.garment.dressing.wearing import Trail
from sim_core.garment.garment import Garment
from sim_core.validation.files import read_npz, written_whole

__all__ = ["Clock", "Kept", "forget", "versions"]


def versions() -> dict[str, str]:
    """Of all that decides the bits of a result on one machine; another processor rounds BLAS and sines differently."""
    return {
        "cloth_engine": str(ENGINE_VERSION),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
    }


class Clock:
    """Seconds per stage."""

    def __init__(self) -> None:
        self.laps: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, name: str) -> None:
        """Ends a stage."""
        now = time.perf_counter()
        self.laps[name], self._last = round(now - self._last, 2), now


@dataclass(frozen=True)
class Kept:
    """The files that keep one layer of a dressing: the state of each run, and the garment once it is finished.

    checkpoint: what the dressing was given; nothing is written there, all names begin with its name.
    """

    checkpoint: Checkpoint
    layer: int

    def state(self, number: int) -> Checkpoint:
        """Where a run keeps its state."""
        return replace(self.checkpoint, path=self._beside(str(number)), keep=True)

    def finish(self, garment: Garment, trail: Trail) -> None:
        """Keeps a finished layer and how it moved; what its runs came to is needed no longer."""
        with written_whole(self._beside("trail.npz")) as stream:
            np.savez(stream, **trail.__dict__)
        garment.save(self._beside("npz"))
        _remove(Path(self.checkpoint.path), rf"\.layer{self.layer}\.\d+")

    def finished(self, inputs: str) -> tuple[Garment, Trail] | None:
        """The layer an earlier dressing of the same inputs finished; None where there is none."""
        try:
            garment = Garment.load(self._beside("npz"))
            if garment.provenance.get("inputs") != inputs:
                return None
            names = ("faces", "shares", "frames")
            data = read_npz(self._beside("trail.npz"), names, "a layer's way", "it is dressed anew")
        except FileProblem:
            return None
        return garment, Trail(**data)

    def _beside(self, what: str) -> Path:
        path = Path(self.checkpoint.path)
        return path.with_name(f"{path.name}.layer{self.layer}.{what}")


def forget(checkpoint: Path) -> None:
    """Removes what a dressing kept to go on from `checkpoint`, and no other file."""
    _remove(checkpoint, r"\.layer\d+\.(\d+|trail\.npz|npz)")


def _remove(checkpoint: Path, what: str) -> None:
    """Files whose names are the checkpoint's and `what`, to the letter: it may hold signs that a glob reads."""
    name = re.compile(re.escape(checkpoint.name) + what + r"(\.part)?")
    for file in list(checkpoint.parent.iterdir()) if checkpoint.parent.is_dir() else ():
        if name.fullmatch(file.name):
            file.unlink()
