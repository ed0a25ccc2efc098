"""Scenes that peers run too, and the settings each peer is swept over. A sweep's last two settings are its limit."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sim_core.cloth.scenes import GF_CM, Scene, hang_edge, scene
from sim_core.cloth.step import Pace

GRAVITY = 9.81
UNDAMPED = replace(GF_CM, mass_damping=0.0, stiffness_damping=0.0)


@dataclass(frozen=True)
class Compared:
    """A scene at a time before it becomes chaotic, and the engines that can run it."""

    scene: Scene
    seconds: float
    engines: tuple[str, ...]


def _grid(*settings: tuple, names: tuple[str, ...], **same) -> tuple[dict, ...]:
    return tuple({**dict(zip(names, values, strict=True)), **same} for values in settings)


OURS = {
    "default": Pace(),
    "double, 0.9": Pace(courant=0.9),
    "single, 0.7": Pace("single"),
    "single, 0.9": Pace("single", 0.9),
    "single, 0.95": Pace("single", 0.95),
}
STEPS, ITERATED = ("substeps",), ("substeps", "iterations")
SWEEPS: dict[str, tuple[dict, ...]] = {
    "Newton VBD": _grid(
        *[
            (10, 10),
            (20, 10),
            (40, 5),
            (40, 10),
            (64, 2),
            (80, 5),
            (128, 1),
            (128, 2),
            (160, 1),
            (160, 5),
            (256, 5),
        ],
        names=ITERATED,
    ),
    "Newton Style3D": _grid(
        *[
            (4, 10),
            (8, 10),
            (16, 5),
            (16, 10),
            (24, 6),
            (32, 2),
            (32, 4),
            (32, 5),
            (64, 1),
            (64, 4),
            (128, 4),
            (256, 4),
        ],
        names=ITERATED,
        linear=10,
    ),
    "MuJoCo Euler": _grid(
        (150,), (160,), (208,), (256,), (512,), (1024,), (2048,), names=STEPS, integrator="Euler"
    ),
    "MuJoCo discrete": _grid(
        (4,), (8,), (16,), (32,), (64,), names=STEPS, integrator="discrete", tolerance=1e-6
    ),
    "Blender": _grid((8,), (16,), (20,), (22,), (24,), (32,), (64,), (128,), (256,), (512,), names=STEPS),
}


def compared(name: str, vertices: int | None = None) -> Compared:
    """A scene by name: hang_edge (one side pinned), hanging (two corners) or flag (in the wind), undamped.

    Blender is left out of the flag: its wind presses by another law. vertices: another mesh size than the scene's.
    """
    every = tuple(SWEEPS)
    if name == "hang_edge":
        edge = 0.0134 if vertices is None else float(np.sqrt(2 / np.sqrt(3) / vertices))
        return Compared(hang_edge(edge, seconds=0.2, material=UNDAMPED), 0.2, every)
    if name == "flag":
        return Compared(
            scene("flag", 1, frames=5, vertices=vertices, cloth=UNDAMPED),
            0.2,
            tuple(engine for engine in every if engine != "Blender"),
        )
    made = scene("hanging", 1, frames=10, pins="corners", vertices=vertices, cloth=UNDAMPED)
    return Compared(replace(made, name=name), 0.4, every)


def given(asked: Compared) -> dict[str, Any]:
    """The arrays a peer is handed; SI units."""
    cloth, sheet = asked.scene.sheet.material, asked.scene.sheet
    air = asked.scene.air
    blown = {} if air is None else {"wind": np.array(air.wind), "air": np.float64(air.density * air.drag)}
    return blown | {
        "rest": sheet.rest,
        "faces": sheet.faces,
        "positions": asked.scene.positions,
        "pins": np.asarray(asked.scene.pins, np.int64),
        "mass": sheet.mass,
        "density": np.float64(cloth.density),
        "stretch": np.float64(cloth.stretch),
        "poisson": np.float64(cloth.poisson),
        "bend": np.float64(cloth.bend),
        "gravity": np.float64(GRAVITY),
        "frames": np.int64(round(asked.seconds * 25)),
    }


def told(setting: dict) -> str:
    """A setting in a few characters: substeps x iterations."""
    steps = "x".join(str(setting[key]) for key in ("substeps", "iterations", "linear") if key in setting)
    return steps
