"""How far a relaxation is, told on stderr while it runs: large figures take minutes."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

import numpy as np

__all__ = ["progress_report"]

FIRST = 2.0  # seconds before anything is told: most weaves are done by then
EVERY, EVERY_LINE = 0.5, 10.0  # seconds, on a terminal and into a file


@contextmanager
def progress_report(name: str, *, first: float = FIRST, every: float | None = None) -> Iterator[np.ndarray]:
    """Gives the (2,) float64 that `relax_particles` writes steps and residual to, and tells them from another thread.

    first, every: seconds before the first and between two reports; `every` depends on whether stderr is a terminal.
    """
    stream = sys.stderr
    watch, done = np.zeros(2), threading.Event()
    pause = every or (EVERY if stream.isatty() else EVERY_LINE)
    teller = threading.Thread(target=_tell, args=(stream, name, watch, done, first, pause), daemon=True)
    teller.start()
    try:
        yield watch
    finally:
        done.set()
        teller.join()


def _tell(
    stream: TextIO, name: str, watch: np.ndarray, done: threading.Event, first: float, pause: float
) -> None:
    terminal, told, wait = stream.isatty(), False, first
    while not done.wait(wait):
        wait, told = pause, True
        line = "stage A" if not watch[0] else f"stage B, step {watch[0]:.0f}, residual {watch[1]:.1e}"
        stream.write(f"\r{name}: {line}\x1b[K" if terminal else f"{name}: {line}\n")
        stream.flush()
    if terminal and told:
        stream.write("\r\x1b[K")
        stream.flush()
