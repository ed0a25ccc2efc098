"""One garment, from files to what the hall shows: simulated value, both models, film, stills, record."""

from __future__ import annotations

import math
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hall_app.build.encoding import film_possible
from hall_app.build.film import filming, stills
from hall_app.build.recipes import RECIPES
from hall_app.build.recipes.recipe import Inputs, Recipe, read_inputs
from hall_app.content.bakes.record import FILES, publish, seal, text_of
from hall_app.content.bakes.store import RECORD
from hall_app.content.folder import Content, Exhibit
from hall_app.content.models.glb import read_glb

if TYPE_CHECKING:
    from sim_core.garment import Garment

__all__ = ["bake_garment"]

Progress = Callable[[float, str], None]

SCREEN = 1080  # [pixels] height of the picture a pixel's budget is reckoned for
FIELD_OF_VIEW = math.radians(58)


def bake_garment(
    content: Content,
    exhibit: Exhibit,
    *,
    key: str,
    target: Path,
    work: Path,
    progress: Progress,
    film: bool = True,
) -> dict[str, Any]:
    """Bake the exhibit's garment into `target` and return the record that is kept beside it.

    work: where an interrupted bake left its state and where this one leaves its own; gone after success.
    film: whether to film the drape, which needs PyAV.
    Raises what reading, meshing, weaving and draping raise, each naming file and remedy.
    """
    began = time.perf_counter()
    out = work / "out"
    out.mkdir(parents=True, exist_ok=True)
    recipe = exhibit.file.garment
    assert recipe is not None
    inputs = read_inputs(content.folder, recipe)
    draping = RECIPES[recipe.recipe](inputs)
    levels: list[Garment] = []

    def models(garment: Garment) -> None:
        garment.save(out / "garment.npz")
        levels.append(_models(inputs, draping, garment, out))

    garment, seconds = _drape(draping, work, out, progress, models, film=film and film_possible())
    (light,) = levels
    progress(0.95, "pictures")
    stills(draping.still(garment), garment.positions, out)
    seconds["all"] = round(time.perf_counter() - began, 2)
    record = _record(key, garment, light, inputs, seconds)
    record[FILES] = seal(out, RECORD)
    (out / RECORD).write_text(text_of(record), "utf-8")
    publish(out, target, RECORD)
    shutil.rmtree(work, ignore_errors=True)
    progress(1.0, "done")
    return record


def _models(inputs: Inputs, draping: Recipe, garment: Garment, out: Path) -> Garment:
    """Write both GLBs; the hall's is the cheapest within the exhibit's budget. Returns that level."""
    from sim_core.garment import choose_detail, write_glb

    table = inputs.table
    beside = draping.beside(garment, "close")
    write_glb(out / "close.glb", garment, inputs.maps, precision="close", **beside)
    light = choose_detail(
        garment, budget(table.nearest, table.hall_error_px), solid=draping.clear_of(garment)
    )
    beside = draping.beside(light, "hall")
    write_glb(out / "hall.glb", light, inputs.maps, precision="hall", **beside)
    return light.noted(hall_all_triangles=read_glb(out / "hall.glb").triangles)


def budget(nearest: float, pixels: float) -> float:
    """The length [m] that `pixels` of a full-screen picture show at the nearest viewing distance [m]."""
    return pixels * 2 * nearest * math.tan(FIELD_OF_VIEW / 2) / SCREEN


def _drape(
    draping: Recipe,
    work: Path,
    out: Path,
    progress: Progress,
    models: Callable[[Garment], None],
    *,
    film: bool,
) -> tuple[Garment, dict[str, float]]:
    """Simulate, and film it meanwhile; `models` writes what is to be written while the last pictures are drawn."""
    clock, seconds = time.perf_counter(), {}

    def lap(name: str) -> None:
        nonlocal clock
        now = time.perf_counter()
        seconds[name], clock = round(now - clock, 2), now

    def told(share: float, label: str) -> None:
        progress(0.6 * share, label)

    def modelled(garment: Garment) -> None:
        progress(0.6, "models")
        models(garment)
        lap("models")

    draping.prepare(lambda share, label: progress(0.0, f"{label}, {share:.0%}"), work / "beneath.npz")
    lap("beneath")
    if not film:
        garment = draping.drape(told, work / "drape.npz", None)
        lap("drape")
        modelled(garment)
        return garment, seconds
    last: list[np.ndarray | None] = [None]
    with filming(draping.look(), work / "film") as taken:

        def shoot(x: np.ndarray, moved: np.ndarray | None) -> None:
            last[0] = moved
            taken.shoot(x, moved)

        garment = draping.drape(told, work / "drape.npz", shoot)
        lap("drape")
        taken.walk_round(garment.worn(), last[0])
        modelled(garment)
        progress(0.7, "film")
        paths = (out / "drape.webm", out / "drape.mp4")
        taken.write(paths, _sound(), lambda share: progress(0.7 + 0.25 * share, "film"))
        lap("film")
    return garment, seconds


def _sound() -> np.ndarray:
    """The film's music, mono at 48 kHz."""
    from hall_app.media.music import falling_gauze

    return falling_gauze().mean(axis=1).astype(np.float32)


def _record(
    key: str, garment: Garment, light: Garment, inputs: Inputs, seconds: dict[str, float]
) -> dict[str, Any]:
    """What the hall tells of this bake; every number comes from a measurement."""
    facts = dict(garment.provenance)
    detail = light.provenance["detail"]
    errors = {name: value for name, value in facts["errors"].items() if not isinstance(value, list)}
    apart = detail.get("hausdorff", {})
    errors |= {f"hall_hausdorff_{name.removesuffix('_m')}": value for name, value in apart.items()}
    errors["vertices"], errors["triangles"] = len(garment.positions), len(garment.faces)
    errors["hall_triangles"] = len(light.faces)
    errors["hall_all_triangles"] = light.provenance["hall_all_triangles"]
    return {
        "key": key,
        "digest": garment.digest(),
        "recipe": facts["recipe"],
        "errors": errors,
        "seconds": seconds,
        "stages": facts["seconds"],
        "hall_budget_m": detail.get("budget_m"),
        "versions": facts["versions"],
    }
