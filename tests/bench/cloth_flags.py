"""Statistics of a flag after its chaotic horizon, where distances of vertices say nothing.

A run is watched at a grid of material points from 0.5 to 6.5 s. Mean shape, fluctuation about it, kinetic energy and
the free corner's frequency of whole runs are compared: of four seeds (a smooth bump of a millimetre at the start) on
one mesh with an ensemble of the same seeds on the two finest meshes. What runs of the same mesh differ in alone is
chance: Student's t says what of a difference it explains, at 95 % for all four statistics together.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from cloth_cases import Case, ran
from scipy.stats import t as student

from sim_core.cloth.step import FRAME

BEGIN, LAST = 12, 164  # frames: 0.5 to 6.5 s
SEEDS = (0, 1, 2, 3)
DOUBT = 0.05  # of calling meshes different that are not
FINE = (0.016, 0.0226)  # [m] edges of the ensemble
COARSE = (0.0269, 0.032, 0.0453, 0.064)  # [m] edges of which the table says if their statistics agree
SHARE = (
    0.25  # what may differ: mean shape, of the fluctuation; the others of themselves, or what chance explains
)


@dataclass(frozen=True)
class Watched:
    """What R runs do after 0.5 s.

    Mean shape (R, P, 3) and fluctuation (R, P) [m], energy (R,) [m2/s2], frequency (R,) [Hz].
    """

    shape: np.ndarray
    swing: np.ndarray
    energy: np.ndarray
    frequency: np.ndarray


def watched(case: Case, edges: Sequence[float]) -> Watched:
    """The runs of all seeds on the meshes of these edges [m]."""
    films = [ran(case, edge, LAST, seed=seed).film[BEGIN:].astype(float) for edge in edges for seed in SEEDS]
    shapes = np.stack([film.mean(0) for film in films])
    swings = [np.sqrt(((f - m) ** 2).sum(2).mean(0)) for f, m in zip(films, shapes, strict=True)]
    energies = [0.5 * ((np.diff(f, axis=0) / FRAME) ** 2).sum(2).mean() for f in films]
    return Watched(
        shapes, np.stack(swings), np.array(energies), np.array([_frequency(f[:, -1, 2]) for f in films])
    )


def chance(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Standard error of the difference of the means of two groups of runs (R, ...), from their pooled variance."""
    inner = sum(((x - x.mean(0)) ** 2).sum(0) for x in (a, b)) / (len(a) + len(b) - 2)
    return np.sqrt(inner * (1 / len(a) + 1 / len(b)))


def chance_times(a: int, b: int) -> float:
    """Standard errors up to which chance explains a difference of two groups of so many runs, in each of four tests."""
    return float(student.ppf(1 - DOUBT / 4 / 2, a + b - 2))


def _frequency(motion: np.ndarray) -> float:
    """Power-weighted mean frequency [Hz] of a motion (T,), tapered, its mean taken off."""
    power = np.abs(np.fft.rfft((motion - motion.mean()) * np.hanning(len(motion)))) ** 2
    return float((power * np.fft.rfftfreq(len(motion), FRAME)).sum() / max(power.sum(), 1e-30))


def compared(case: Case, edge: float) -> dict[str, Any]:
    """What a mesh differs in from the finest beyond chance: mean shape and fluctuation [mm], energy and frequency.

    Beyond chance: the mean square of the standard error is taken off that of the difference. `agree`: the mean shape
    is within SHARE of the fluctuation, and fluctuation, energy and frequency are within SHARE of the finest's; or
    chance explains the difference.
    """
    others = [fine for fine in FINE if abs(fine / edge - 1) > 0.05]  # a mesh is not compared with itself
    coarse, fine = watched(case, (edge,)), watched(case, others)
    times = chance_times(len(coarse.energy), len(fine.energy))

    def beyond(a: np.ndarray, b: np.ndarray) -> tuple[float, float]:
        many = a.shape[1]
        gap, due = ((a.mean(0) - b.mean(0)) ** 2).sum() / many, (chance(a, b) ** 2).sum() / many
        return 1e3 * float(np.sqrt(max(0.0, gap - due))), 1e3 * float(np.sqrt(due))

    def agree(a: np.ndarray, b: np.ndarray) -> bool:
        return bool(abs(a.mean() - b.mean()) <= max(SHARE * b.mean(), times * chance(a, b)))

    (shape, due), (swing, swing_due) = beyond(coarse.shape, fine.shape), beyond(coarse.swing, fine.swing)
    whole = 1e3 * float(fine.swing.mean())
    kept = all(
        gap <= SHARE * whole or gap**2 + due**2 <= (times * due) ** 2
        for gap, due in ((shape, due), (swing, swing_due))
    )
    return {
        "edge_mm": 1e3 * edge,
        "shape_mm": shape,
        "swing_mm": swing,
        "whole_swing_mm": whole,
        "chance_mm": due,
        "energy": float(coarse.energy.mean() / fine.energy.mean()),
        "frequency": float(coarse.frequency.mean() / fine.frequency.mean()),
        "agree": kept and agree(coarse.energy, fine.energy) and agree(coarse.frequency, fine.frequency),
    }


def told(found: dict[str, Any]) -> str:
    """A line for people."""
    return json.dumps({k: round(v, 2) if isinstance(v, float) else v for k, v in found.items()})
