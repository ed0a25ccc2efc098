"""Every public name of the cloth room, given odd values one argument at a time: taken, or refused in one line."""

import math
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sim_core import cloth
from sim_core.cloth import (
    Air,
    Alternative,
    Box,
    Capsule,
    Checkpoint,
    Contact,
    Cylinder,
    GridSdf,
    HalfSpace,
    Holds,
    Live,
    Material,
    MovingGrid,
    Pace,
    Phase,
    Sheet,
    Union,
    choose,
    drape,
    field_of,
    moving_mesh,
    scene,
)
from sim_core.cloth.scenes import GF_CM, equilateral_sheet
from sim_core.errors import SimCoreError

REST, FACES = equilateral_sheet(0.2, 0.2, 0.1)
COUNT = len(REST)
SHEET = Sheet.of(REST, FACES, GF_CM)
FLAT = np.column_stack([REST[:, 0], np.zeros(COUNT), REST[:, 1]])
PYRAMID = 0.1 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
SIDES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
BALL = Capsule((0, -1, 0), (0, -1, 0), 0.05)
FRAME = 0.04

# What a person gets wrong: a forgotten value, words, no number, the wrong sign, size, kind, length or shape.
ODD: dict[str, object] = {
    "None": None,
    "text": "abc",
    "NaN": math.nan,
    "infinite": math.inf,
    "huge": 1e300,
    "negative": -1,
    "zero": 0,
    "broken": 2.5,
    "true": True,
    "empty": [],
    "ragged": [[1, 2], [3]],
    "NaNs": (math.nan,) * 3,
    "two": (1.0, math.inf),
    "broken ones": [3.7],
    "negative ones": [-1, -2],
    "far ones": [10**12],
    "flat": np.zeros((2, 2)),
    "nothing of three": np.zeros((0, 3)),
}

PHASE = {
    "seconds": FRAME,
    "gravity": (9.81, 9.81),
    "damping": 1.0,
    "friction": 0.3,
    "label": "a",
    "speed_limit": 9.0,
}
PHASE |= {"rest": 1e-3, "pins": (), "sewing": (0.0, 0.0), "body": None}
CONTACT = {name: getattr(Contact(thickness=0.003), name) for name in Contact.__dataclass_fields__}
MATERIAL = {name: getattr(GF_CM, name) for name in Material.__dataclass_fields__}
AIR = {"wind": (4.0, 0.0, 1.0), "density": 1.2, "drag": 1.0, "gusts": 0.2, "gust_seconds": 1.0, "seed": 0}
WOVEN = SimpleNamespace(
    density=0.1, stretch_warp=50, stretch_weft=50, shear=9, poisson=0, bend_warp=0, bend_weft=0, friction=1
)
FIELD = {
    "vertices": PYRAMID,
    "faces": SIDES,
    "cell": 0.02,
    "band": 0.05,
    "exact": None,
    "hulls": (),
    "box": None,
}
CHOOSE = {
    "name": "flag",
    "error_mm": 50.0,
    "case": 1,
    "size": (1, 1),
    "pins": None,
    "wind": (4, 0, 1),
    "cloth": GF_CM,
    "alternatives": (),
}
ALTERNATIVE = {"name": "other", "vertices": 99, "error_mm": 1.0, "ms": 2.0}
SCENE = {
    "name": "flag",
    "case": 1,
    "frames": 1,
    "vertices": 40,
    "size": (1, 1),
    "wind": (4, 0, 1),
    "pins": None,
}
SCENE |= {"cloth": GF_CM}
HOLDS = {
    "count": COUNT,
    "pairs": [[0, 1]],
    "positions": FLAT,
    "low": np.full(COUNT, -1.0),
    "high": np.full(COUNT, 1.0),
}
HOLDS |= {"slaves": np.zeros((0, 2), int), "limit": (0.5, 0.5)}
DRAPE = {
    "sheet": SHEET,
    "positions": FLAT,
    "phases": [Phase(FRAME)],
    "collider": BALL,
    "contact": Contact(),
    "pins": [0],
}
DRAPE |= {"holds": Holds.of(COUNT), "air": Air(), "down": (0, -1, 0), "substeps": 20, "integrator": "auto"}
DRAPE |= {"pace": Pace(), "velocities": 0 * FLAT, "progress": None, "on_frame": None, "checkpoint": None}
DRAPE |= {"certify": False}
LIVE = {
    k: DRAPE[k]
    for k in ("sheet", "positions", "collider", "contact", "pins", "air", "integrator", "substeps")
}
LIVE |= {"pace": Pace(), "certify": False, "gravity": (0, -9.81, 0), "damping": 1.0}
STEP = {"wind": (1, 0, 0), "pins": [0], "targets": FLAT[:1], "pulls": ([3], [[0, 0, 0.1]]), "body": 0.0}
GRID = {"origin": (0, 0, 0), "cell": 0.1, "values": np.ones((2, 2, 2))}


def run(**more: Any) -> None:
    drape(**dict[str, Any](DRAPE | {"substeps": None} | more))


def moving(**given: Any) -> None:
    run(collider=MovingGrid(**given), phases=[Phase(FRAME, body=(0, 1))])


def stepped(**given: Any) -> None:
    Live(SHEET, FLAT).step(**given)


def checked_grid(values: np.ndarray) -> Callable[[int], np.ndarray]:
    return lambda _: values


TWO_KEYS: dict[str, Any] = {
    "origin": (0, 0, 0),
    "cell": 0.1,
    "count": 2,
    "key": checked_grid(np.ones((2, 2, 2))),
}


PUBLIC: dict[str, tuple[Callable[..., object], dict[str, Any]]] = {
    "Air": (lambda **given: run(air=Air(**given)), AIR),
    "Air.at": (lambda **given: Air(**AIR).at(**given), {"seconds": 1.0}),
    "Air.blowing": (lambda **given: Air(**AIR).blowing(**given), {"wind": (1, 0, 0)}),
    "Box": (
        lambda **given: run(collider=Box(**given)),
        {"centre": (0, 0, 0), "size": (1, 1, 1), "rounding": 0.1, "yaw": 0.1},
    ),
    "Capsule": (
        lambda **given: run(collider=Capsule(**given)),
        {"start": (0, 0, 0), "end": (1, 0, 0), "radius": 0.1},
    ),
    "Checkpoint": (
        lambda **given: run(checkpoint=Checkpoint(**given)),
        {"path": "run.npz", "keep": False, "only_own": False},
    ),
    "Contact": (lambda **given: run(contact=Contact(**given)), CONTACT),
    "Cylinder": (
        lambda **given: run(collider=Cylinder(**given)),
        {"start": (0, 0, 0), "end": (1, 0, 0), "radius": 0.1, "rounding": 0.01},
    ),
    "GridSdf": (lambda **given: run(collider=GridSdf(**given)), GRID),
    "GridSdf.sample": (GridSdf.sample, {"solid": BALL, "low": (-1, -1, -1), "high": (1, 1, 1), "cell": 0.5}),
    "HalfSpace": (
        lambda **given: run(collider=HalfSpace(**given)),
        {"point": (0, 0, 0), "normal": (0, 1, 0)},
    ),
    "Holds": (lambda **given: run(holds=Holds.of(**given)), HOLDS),
    "Live": (Live, LIVE),
    "Live.step": (stepped, STEP),
    "Material": (lambda **given: run(sheet=Sheet.of(REST, FACES, Material(**given))), MATERIAL),
    "Material.of": (Material.of, {"parameters": WOVEN, "mass_damping": 0.5, "stiffness_damping": 0.0}),
    "MovingGrid": (
        moving,
        TWO_KEYS | {"name": "a", "surface": None},
    ),
    "MovingGrid, its keys": (
        lambda key: moving(origin=(0, 0, 0), cell=0.1, count=2, key=checked_grid(key)),
        {"key": np.ones((2, 2, 2))},
    ),
    "MovingGrid, its surface": (
        lambda **given: moving(**TWO_KEYS, surface=lambda _: tuple(given.values())),
        {"nearest": np.zeros((2, 2, 2), np.int32), "corners": np.eye(3)[None]},
    ),
    "MovingGrid, its surface as a whole": (
        lambda surface: moving(**TWO_KEYS, surface=lambda _: surface),
        {"surface": (np.zeros((2, 2, 2), np.int32), np.eye(3)[None])},
    ),
    "Pace": (lambda **given: run(pace=Pace(**given)), {"precision": "single", "courant": 0.7}),
    "Phase": (lambda **given: run(phases=[Phase(**given)]), PHASE),
    "Scene": (scene("hanging", vertices=40, frames=1).lasting, {"frames": 1}),
    "Scene.gusty": (scene("flag", vertices=40, frames=1).gusty, {"gusts": 0.1, "seed": 1}),
    "Scene.layered": (scene("hanging", vertices=40, frames=1).layered, {"layers": 0.003}),
    "Sheet": (Sheet.of, {"rest": REST, "faces": FACES, "material": GF_CM}),
    "Sheet.of_corners": (
        Sheet.of_corners,
        {"corner": REST[FACES], "faces": FACES, "materials": [GF_CM], "kind": np.zeros(len(FACES), int)},
    ),
    "Solid": (BALL.distance, {"points": FLAT}),
    "Union": (lambda **given: run(collider=Union(**given)), {"parts": (BALL, HalfSpace())}),
    "Alternative": (Alternative, ALTERNATIVE),
    "choose": (choose, CHOOSE),
    "drape": (drape, DRAPE),
    "field_of": (field_of, FIELD),
    "moving_mesh": (moving_mesh, {"positions": PYRAMID[None], "faces": SIDES, "cell": 0.02, "band": 0.05}),
    "scene": (scene, SCENE),
}
MADE = {"Certificate", "Choice", "DistanceField", "Drape"}  # by the room itself, for its callers to read
CALLBACKS = ("key", "progress", "on_frame", "surface")
SAID = {  # what an argument is also known by
    "name": ("scene",),
    "error_mm": ("error ",),
    "materials": ("material",),
    "rest": ("faces",),
    "density": ("no stable step",),
}


def names(argument: str, text: str) -> bool:
    """Whether a message speaks of the argument, or of what the caller knows it by."""
    return any(
        word in text.replace("_", " ") for word in (argument.replace("_", " "), *SAID.get(argument, ()))
    )


def test_every_public_name_is_tried() -> None:
    assert {name.split(".")[0].split(",")[0] for name in PUBLIC} | MADE == set(cloth.__all__)


@pytest.mark.parametrize("name", PUBLIC)
def test_odd_values_are_taken_or_refused_in_one_line_that_names_them(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # a checkpoint may be named
    function, good = PUBLIC[name]
    bad = []
    for argument in good:
        for word, value in ODD.items():
            if argument in CALLBACKS and callable(value):  # what it does is its maker's
                continue
            try:
                function(**good | {argument: value})
            except SimCoreError as error:
                text = str(error)
                if text.startswith("frame 0: ") and (
                    "inside the collider" in text or "no step is short" in text
                ):
                    continue  # what was taken makes a cloth begin within a solid, say, or holds it where it cannot be
                if "\n" in text or len(text) > 250 or not names(argument, text):
                    bad.append(f"{argument} = {word}: {text!r}")
            except Exception as error:
                bad.append(f"{argument} = {word}: {type(error).__name__} {error}")
    assert not bad, "\n" + "\n".join(bad)
