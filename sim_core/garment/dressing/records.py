"""What a dressing writes down about itself: versions of what computed it, seconds per stage."""

from __future__ import annotations

import platform
import time

import numba
import numpy as np

from sim_core.cloth.run.drape_run import ENGINE_VERSION

__all__ = ["Clock", "versions"]


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
