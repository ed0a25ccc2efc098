"""One run of a cloth scene by our engine with given settings, and distances between runs; what the benches share."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass, replace

import numpy as np

from sim_core.cloth.phases import FRAME
from sim_core.cloth.precision import Pace
from sim_core.cloth.scenes import Scene


@dataclass(frozen=True)
class Timed:
    """positions (V, 3) [m] after `seconds` simulated, median and least wall milliseconds a frame, substeps a frame."""

    positions: np.ndarray
    ms: float
    best_ms: float
    cpu_ms: float
    substeps: float
    fallbacks: int
    stretch: float


def simulate(
    scene: Scene,
    seconds: float,
    *,
    substeps: int | None = None,
    integrator: str = "explicit",
    undamped: bool = False,
    pace: Pace | None = None,
) -> Timed:
    """Runs `scene` for so many simulated seconds; undamped: without mass damping, as peers are compared."""
    frames = max(1, round(seconds / FRAME))
    made = scene.lasting(frames)
    if undamped:
        made = replace(made, phases=tuple(replace(p, damping=0.0) for p in made.phases))
    begin = time.process_time()
    end = made.drape(substeps=substeps, integrator=integrator, pace=pace or Pace(courant=scene.courant))
    cpu = (time.process_time() - begin) / frames
    ms = 1e3 * statistics.median(end.frame_seconds)
    best = 1e3 * min(end.frame_seconds)
    return Timed(end.positions, ms, best, 1e3 * cpu, end.substeps / frames, end.fallbacks, end.worst_stretch)


def distance(a: np.ndarray, b: np.ndarray) -> dict[str, float]:
    """Mean, 99 % and largest distance [mm] of vertices (V, 3) from their places."""
    gap = 1e3 * np.linalg.norm(a - b, axis=1)
    return {"mean": float(gap.mean()), "p99": float(np.percentile(gap, 99)), "max": float(gap.max())}
