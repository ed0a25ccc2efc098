"""Random scenes of the published kinds, their runs kept on disk, and how far a run is from another.

A run is kept under `build/cloth-fidelity` by a hash of the scene, the mesh, the setting and the engine's version, so
that an interrupted table goes on where it was.
"""

from __future__ import annotations

import hashlib
import json
import os
import time
from dataclasses import asdict, dataclass, replace
from math import sqrt
from pathlib import Path

import numpy as np

from sim_core.cloth.run import ENGINE_VERSION
from sim_core.cloth.scenes import GRID, PINS, Scene, cases, grid_film, material, scene
from sim_core.cloth.sheet import Material

KEPT = Path(__file__).parents[2] / "build" / "cloth-fidelity"
KINDS = ("hanging", "flag", "teapot")
BUMP = 1e-3  # [m]
_EDGES = (0.008, 0.0113, 0.016, 0.0226, 0.032, 0.0453, 0.064, 0.0905)
EDGES = {
    "hanging": _EDGES,
    "flag": (0.0057, *_EDGES),
    "teapot": _EDGES,
}  # [m]; the first is the reference
FRAMES = {"hanging": 15, "flag": 5, "teapot": 5}  # 0.6, 0.2, 0.2 s: refining still converges


@dataclass(frozen=True)
class Case:
    """A scene: its kind, width and height [m], material as factors of the preset, and pins, wind or place."""

    name: str
    size: tuple[float, float]
    stretch: float
    bend: float
    density: float
    pins: str | None = None
    wind: tuple[float, float, float] | None = None
    place: int = 1

    @property
    def cloth(self) -> Material:
        m = material()
        return replace(
            m, stretch=m.stretch * self.stretch, bend=m.bend * self.bend, density=m.density * self.density
        )

    def on(self, edge: float) -> Scene:
        """The scene on a mesh of about `edge` [m]."""
        count = max(12, round(self.size[0] * self.size[1] * 2 / sqrt(3) / edge**2))
        return scene(
            self.name,
            self.place,
            vertices=count,
            size=self.size,
            wind=self.wind,
            pins=self.pins,
            cloth=self.cloth,
        )

    def told(self) -> str:
        """A line for people."""
        more = self.pins or (f"wind {self.wind}" if self.wind else f"place {self.place}")
        return (
            f"{self.name} {self.size[0]:.2f} x {self.size[1]:.2f} m, {more}, "
            f"stretch x {self.stretch:.2g}, bend x {self.bend:.2g}, density x {self.density:.2g}"
        )


@dataclass(frozen=True)
class Kept:
    """One run: film (T, P, 3) [m] of the grid's points, vertices, processor milliseconds a frame (median), substeps."""

    film: np.ndarray
    vertices: int
    ms: float
    substeps: float


def drawn(rng: np.random.Generator, name: str, pins: str | None = None) -> Case:
    """A random scene of a kind, or a hanging one with such pins."""

    def between(low: float, high: float) -> float:
        return float(np.round(np.exp(rng.uniform(np.log(low), np.log(high))), 3))

    size = (float(np.round(rng.uniform(0.6, 1.5), 2)), float(np.round(rng.uniform(0.6, 1.3), 2)))
    case = Case(name, size, between(0.5, 4), between(0.4, 4), between(0.7, 2))
    if name == "hanging":
        return replace(case, pins=pins or PINS[int(rng.integers(len(PINS)))])
    if name == "flag":
        wind = np.round([rng.uniform(1, 7), rng.uniform(0, 1), rng.uniform(0.3, 2)], 1)
        return replace(case, wind=tuple(wind.tolist()))
    return replace(case, place=1 + int(rng.integers(cases("teapot"))))


def path_of(asked: list) -> Path:
    """Where the run of what was asked is kept."""
    told = json.dumps([ENGINE_VERSION, *asked], sort_keys=True)
    return KEPT / f"{hashlib.sha256(told.encode()).hexdigest()[:24]}.npz"


def load(path: Path) -> dict[str, np.ndarray]:
    """The arrays of a kept run."""
    with np.load(path) as found:
        return dict(found)


def save(path: Path, **arrays: np.ndarray) -> None:
    """Keeps arrays whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_suffix(".part")
    with beside.open("wb") as stream:
        np.savez(stream, **arrays)  # pyright: ignore[reportArgumentType]
    os.replace(beside, path)


def filmed(
    made: Scene, frames: int, integrator: str = "auto", substeps: int | None = None
) -> tuple[np.ndarray, float, float]:
    """Positions (T, V, 3) float32 [m] after each frame, processor milliseconds a frame (median), substeps a frame."""
    film, spent = [], [time.process_time()]

    def heard(_: int, x: np.ndarray) -> None:
        film.append(x)
        spent.append(time.process_time())

    end = made.lasting(frames).drape(integrator=integrator, substeps=substeps, on_frame=heard)
    return np.stack(film), 1e3 * float(np.median(np.diff(spent))), end.substeps / frames


def ran(
    case: Case,
    edge: float,
    frames: int,
    *,
    integrator: str = "auto",
    substeps: int | None = None,
    seed: int | None = None,
) -> Kept:
    """The run of a case for so many frames, from the disk if it is there; seed: of a bump at the start."""
    path = path_of([asdict(case), edge, frames, integrator, substeps, seed, GRID])
    if not path.is_file():
        made = case.on(edge)
        if seed is not None:
            made = bumped(made, case.size, seed)
        film, ms, count = filmed(made, frames, integrator, substeps)
        film = grid_film(made.sheet, case.size, film)
        save(
            path, film=film, vertices=np.array(len(made.positions)), ms=np.array(ms), substeps=np.array(count)
        )
    found = load(path)
    return Kept(found["film"], int(found["vertices"]), float(found["ms"]), float(found["substeps"]))


def bumped(made: Scene, size: tuple[float, float], seed: int) -> Scene:
    """A flag whose start has a smooth seeded bump of about a millimetre."""
    u, v = (made.sheet.rest / size).T
    a, b = np.random.default_rng(seed).normal(size=2)
    bump = BUMP * np.sin(np.pi * u / 2) * (a * np.sin(np.pi * v) + b * np.cos(np.pi * v))
    return replace(made, positions=made.positions + np.outer(bump, [0.0, 0.0, 1.0]))


def training(seed: int = 1) -> list[Case]:
    """The scenes the table is made from: every set of pins six times, 30 flags, 30 teapots."""
    found: list[Case] = []
    for first, (hung, others) in enumerate(((24, 14), (12, 16))):
        rng = np.random.default_rng(seed + 1000 * first)
        found += [drawn(rng, "hanging", PINS[k % len(PINS)]) for k in range(hung)]
        found += [drawn(rng, name) for name in ("flag", "teapot") for _ in range(others)]
    return found
