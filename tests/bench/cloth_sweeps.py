"""Scenes that peers run too, and the settings each peer is swept over. A sweep's last two settings are its limit."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from cloth_folded import folded

from sim_core.cloth import Capsule
from sim_core.cloth.scenes import GF_CM, Scene, hang_edge, scene
from sim_core.cloth.step import Pace

GRAVITY = 9.81
UNDAMPED = replace(GF_CM, mass_damping=0.0, stiffness_damping=0.0)
SILK = replace(
    UNDAMPED, stretch=1000.0
)  # [N/m] the softest at which no edge of the scenes grows by more than 3 %
SILK_VERTICES = 800
LONGEST = 240.0  # [s] of processor that a run of a peer may take
Sweeps = dict[str, tuple[dict, ...]]


def _grid(*settings: tuple, names: tuple[str, ...], **same) -> tuple[dict, ...]:
    return tuple({**dict(zip(names, values, strict=True)), **same} for values in settings)


@dataclass(frozen=True)
class Own:
    """A setting of ours: pace, and the substeps between two looks at what layers do."""

    pace: Pace
    every: int = 1


OURS = {
    "default": Own(Pace()),
    "double, 0.9": Own(Pace(courant=0.9)),
    "single, 0.7": Own(Pace("single")),
    "single, 0.9": Own(Pace("single", 0.9)),
    "single, 0.95": Own(Pace("single", 0.95)),
}
OURS_LAYERED = {
    "default": Own(Pace()),
    "double, 0.9": Own(Pace(courant=0.9)),
    "layers every 4 steps": Own(Pace(), 4),
    "layers every 8 steps": Own(Pace(), 8),
    "single, 0.95, layers every 8 steps": Own(Pace("single", 0.95), 8),
    "single, 0.95, layers every 16 steps": Own(Pace("single", 0.95), 16),
}
STEPS, ITERATED = ("substeps",), ("substeps", "iterations")
SWEEPS: Sweeps = {
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
SILK_SWEEPS: Sweeps = {
    "Newton VBD": _grid(
        *[(10, 5), (20, 5), (40, 2), (40, 5), (80, 2), (40, 10), (80, 5), (80, 10), (160, 5), (160, 10)],
        names=ITERATED,
    ),
    "Newton Style3D": _grid(
        *[(16, 10), (32, 4), (64, 4), (64, 10), (128, 4), (128, 10)], names=ITERATED, linear=10
    ),
    "MuJoCo Euler": _grid((416,), (512,), (640,), (1024,), (2048,), (4096,), names=STEPS, integrator="Euler"),
    "MuJoCo discrete": _grid(
        (8,), (16,), (32,), (64,), (128,), names=STEPS, integrator="discrete", tolerance=1e-6
    ),
    "Blender": _grid((16,), (20,), (24,), (32,), (64,), (128,), (256,), (512,), names=STEPS),
}
PASSED = ("substeps", "passes")
LAYER_SWEEPS: Sweeps = {
    "Newton VBD": _grid((20, 10), (64, 5), (128, 5), (256, 2), (256, 4), names=ITERATED),
    "Newton Style3D": _grid(
        *[(16, 5), (32, 2), (32, 4), (64, 2), (64, 4), (128, 2), (128, 4), (256, 4)],
        names=ITERATED,
        linear=10,
    ),
    "MuJoCo Euler": _grid((320,), (400,), names=STEPS, integrator="Euler"),
    "MuJoCo discrete": _grid(
        (8,), (12,), (16,), (24,), (32,), (64,), (128,), names=STEPS, integrator="discrete", tolerance=1e-6
    ),
    "MuJoCo discrete, passive contact": _grid(
        (16,), (32,), (64,), names=STEPS, integrator="discrete", tolerance=1e-6, passive=True
    ),
    "Blender": _grid(*[(16, 2), (24, 2), (32, 2), (64, 2), (64, 8), (128, 2), (256, 2)], names=PASSED),
}
PUBLISHED = ("hang_edge", "hanging", "flag")
NAMES = (*PUBLISHED, "folded", *(f"{name}_silk" for name in PUBLISHED))
ENGINES = tuple(dict.fromkeys([*SWEEPS, *SILK_SWEEPS, *LAYER_SWEEPS]))


@dataclass(frozen=True)
class Compared:
    """A scene until before it becomes chaotic, the engines that can run it, and the settings of peers and of us.

    whole: errors are those of the frame in which they are largest, not of the last one. steps: ours up to our limit.
    """

    scene: Scene
    seconds: float
    engines: tuple[str, ...]
    sweeps: Sweeps
    ours: dict[str, Own]
    steps: tuple[int, ...] = (256, 512, 1024, 2048)
    whole: bool = False


def _bare(name: str, vertices: int | None, sweeps: Sweeps, cloth: Any, steps: tuple[int, ...]) -> Compared:
    """hang_edge (one side pinned), hanging (two corners) or flag (in the wind), undamped.

    Blender is left out of the flag: its wind presses by another law.
    """
    every, rest = tuple(sweeps), {"sweeps": sweeps, "ours": OURS, "steps": steps}
    if name == "hang_edge":
        edge = 0.0134 if vertices is None else float(np.sqrt(2 / np.sqrt(3) / vertices))
        return Compared(hang_edge(edge, seconds=0.2, material=cloth), 0.2, every, **rest)
    if name == "flag":
        made = scene("flag", 1, frames=5, vertices=vertices, cloth=cloth)
        return Compared(made, 0.2, tuple(engine for engine in every if engine != "Blender"), **rest)
    made = scene("hanging", 1, frames=10, pins="corners", vertices=vertices, cloth=cloth)
    return Compared(made, 0.4, every, **rest)


def compared(name: str, vertices: int | None = None) -> Compared:
    """A scene by name: hang_edge, hanging or flag, each with `_silk` of a woven silk's stiffness as well, or folded.

    vertices: another mesh size than the scene's.
    """
    if name == "folded":
        edge = 0.01 if vertices is None else float(np.sqrt(0.05 * 2 / np.sqrt(3) / vertices))
        made, layered = folded(edge), (512, 1024, 2048)
        return Compared(made, 1.0, tuple(LAYER_SWEEPS), LAYER_SWEEPS, OURS_LAYERED, layered, whole=True)
    plain = name.removesuffix("_silk")
    if plain == name:
        found = _bare(name, vertices, SWEEPS, UNDAMPED, (256, 512, 1024, 2048))
    else:
        found = _bare(plain, vertices or SILK_VERTICES, SILK_SWEEPS, SILK, (512, 1024, 2048, 4096))
    return replace(found, scene=replace(found.scene, name=name))


def layered(asked: Compared) -> dict[str, Any]:
    """What a peer is told of layers and of the bar; nothing where there are none."""
    contact, bar = asked.scene.contact, asked.scene.collider
    if contact is None or not isinstance(bar, Capsule):
        return {}
    cloth = asked.scene.sheet.material
    return {
        "bar": np.array([bar.start, bar.end]),
        "bar_radius": np.float64(bar.radius),
        "clearance": np.float64(contact.clearance),
        "thickness": np.float64(contact.thickness),
        "damping": np.float64(cloth.mass_damping),
        "stiffness_damping": np.float64(cloth.stiffness_damping),
        "film": np.int64(asked.whole),
        "longest": np.float64(LONGEST),
    }


def given(asked: Compared) -> dict[str, Any]:
    """The arrays a peer is handed; SI units."""
    cloth, sheet = asked.scene.sheet.material, asked.scene.sheet
    air = asked.scene.air
    blown = {} if air is None else {"wind": np.array(air.wind), "air": np.float64(air.density * air.drag)}
    return (
        blown
        | layered(asked)
        | {
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
    )


def told(setting: dict) -> str:
    """A setting in a few characters: substeps x iterations."""
    steps = "x".join(
        str(setting[key]) for key in ("substeps", "iterations", "linear", "passes") if key in setting
    )
    return steps
