"""How far a coarse mesh is from the scan it was made of, both ways, and the cheapest level that is near enough."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim_core.mesh.scan.levels.coarsening import Level
from sim_core.metrics import Surface, sample_surface

__all__ = ["Chosen", "Deviation", "Fine", "chosen_level"]

TRIED = 150_000  # points each way while levels are tried
MEASURED = 600_000  # of the one that is chosen
EACH = 10  # of these to a vertex of the scan, at most


@dataclass(frozen=True)
class Deviation:
    """Two-sided distance [m] between points of one surface and the other: mean and max over both ways, p99 of the worse
    way."""

    mean: float
    p99: float
    max: float

    def as_json(self) -> dict[str, float]:
        return {"mean_m": self.mean, "p99_m": self.p99, "max_m": self.max}


class Fine:
    """A dense surface that coarse ones are measured against: vertices (V, 3) [m], faces (F, 3)."""

    def __init__(self, vertices: np.ndarray, faces: np.ndarray) -> None:
        self.vertices = vertices
        self.surface = Surface(vertices, faces)

    def deviation(self, level: Level, points: int) -> Deviation:
        """Measured at about so many points each way, spread evenly."""
        stride = max(1, len(self.vertices) // points)
        there = Surface(level.vertices, level.faces).distance(self.vertices[::stride])
        back = self.surface.distance(_spread(level, points))
        both = np.concatenate([there, back])
        worse = max(float(np.percentile(way, 99)) for way in (there, back))
        return Deviation(float(both.mean()), worse, float(both.max()))


def _spread(level: Level, points: int) -> np.ndarray:
    """About so many points (N, 3) on the level, its vertices among them."""
    a, b, c = (level.vertices[level.faces[:, k]] for k in range(3))
    area = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
    samples = sample_surface(level.vertices, level.faces, 1.5 * np.sqrt(area / points))
    return samples[:: max(1, len(samples) // points)]


@dataclass(frozen=True)
class Chosen:
    """A level and what it was measured to be; within: whether that is the budget [m]; tried: what was measured."""

    level: Level
    deviation: Deviation
    budget: float
    within: bool
    tried: tuple[dict[str, float], ...]

    def as_json(self) -> dict[str, Any]:
        """As a bake's record keeps it."""
        return {
            "triangles": len(self.level.faces),
            "deviation": self.deviation.as_json(),
            "budget_m": self.budget,
            "within_budget": self.within,
            "tried": list(self.tried),
        }


def chosen_level(
    fine: Fine, levels: Sequence[Level], budget: float, progress: Callable[[float], None] = lambda share: None
) -> Chosen:
    """The coarsest of `levels`, the finest first, whose measured p99 stays within `budget` [m]; the finest where none
    does. Levels are tried on few points by halving, and the chosen one is measured on many; where it fails then, the
    next finer one is taken."""
    tried: dict[int, Deviation] = {}
    low, high = 0, len(levels)  # the finest is taken as it is; `high` fails
    while high - low > 1:
        middle = (low + high) // 2
        tried[middle] = fine.deviation(levels[middle], TRIED)
        low, high = (middle, high) if tried[middle].p99 <= budget else (low, middle)
        progress(0.7 * len(tried) / (1 + np.log2(len(levels))))
    while True:
        found = fine.deviation(levels[low], min(MEASURED, EACH * len(fine.vertices)))
        if found.p99 <= budget or low == 0:
            break
        low -= 1
    progress(1.0)
    told = tuple({"triangles": len(levels[n].faces), "p99_m": d.p99} for n, d in sorted(tried.items()))
    return Chosen(levels[low], found, budget, found.p99 <= budget, told)
