"""One run of a cloth scene by our engine with given settings, and distances between runs; what the benches share."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass, replace

import numpy as np

from sim_core.cloth.scenes import Scene
from sim_core.cloth.step import FRAME, Pace


@dataclass(frozen=True)
class Timed:
    """positions (V, 3) [m] after `seconds` simulated, processor ms of every frame, median wall ms, substeps a frame."""

    positions: np.ndarray
    frames_ms: tuple[float, ...]
    wall_ms: float
    substeps: float
    fallbacks: int
    stretch: float

    @property
    def ms(self) -> float:
        """Median processor milliseconds of a frame."""
        return statistics.median(self.frames_ms)


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
    spent: list[float] = []

    def heard(_: int, __: np.ndarray) -> None:
        spent.append(time.process_time())

    pace = pace or Pace(courant=scene.courant)
    end = made.drape(substeps=substeps, integrator=integrator, pace=pace, on_frame=heard)
    # The first frame also makes the engine and is no frame as the others are, unless it is the only one.
    frames_ms = tuple(1e3 * np.diff(spent)) or tuple(1e3 * s for s in end.frame_seconds)
    wall = 1e3 * statistics.median(end.frame_seconds)
    return Timed(end.positions, frames_ms, wall, end.substeps / frames, end.fallbacks, end.worst_stretch)


def distance(a: np.ndarray, b: np.ndarray) -> dict[str, float]:
    """Mean, 99 % and largest distance [mm] of vertices (V, 3) from their places."""
    gap = 1e3 * np.linalg.norm(a - b, axis=1)
    return {"mean": float(gap.mean()), "p99": float(np.percentile(gap, 99)), "max": float(gap.max())}
