"""One garment, from files to what the hall shows: simulated value, both models, film, stills, record."""

from __future__ import annotations

import json
import math
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ..content.loading import Content, Exhibit
from .encode import film_possible
from .film import Look, filming, stills
from .places import RECORD

__all__ = ["bake_garment"]

Progress = Callable[[float, str], None]

SCREEN = 1080  # [pixels] height of the picture a pixel's budget is reckoned for
FIELD_OF_VIEW = math.radians(58)
MAP_PIXELS = 512


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
    pattern, weave = _inputs(content, exhibit)
    garment, seconds = _drape(exhibit, pattern, weave, work, out, progress, film=film and film_possible())
    garment.save(out / "garment.npz")
    progress(0.86, "models")
    clock = time.perf_counter()
    light, maps = _models(exhibit, garment, weave, out)
    seconds["models"] = round(time.perf_counter() - clock, 2)
    progress(0.95, "pictures")
    stills(_look(garment, maps), garment.positions, out)
    seconds["all"] = round(time.perf_counter() - began, 2)
    record = _record(key, garment, light, maps, seconds)
    (out / RECORD).write_text(
        json.dumps(record, ensure_ascii=False, indent=1, sort_keys=True) + "\n", "utf-8"
    )
    _publish(out, target)
    shutil.rmtree(work, ignore_errors=True)
    progress(1.0, "done")
    return record


def _models(exhibit: Exhibit, garment, weave, out: Path):
    """Write both GLBs; the hall's is the cheapest within the exhibit's budget. Returns that level and the maps."""
    from sim_core.garment import choose_detail, write_glb
    from sim_core.weave import relax, texture_maps

    recipe = exhibit.file.garment
    assert recipe is not None
    maps = texture_maps(weave, relax(weave), pixels=MAP_PIXELS)
    write_glb(out / "close.glb", garment, maps, precision="close")
    light = choose_detail(garment, budget(recipe.nearest, recipe.hall_error_px))
    write_glb(out / "hall.glb", light, maps, precision="hall")
    return light, maps


def budget(nearest: float, pixels: float) -> float:
    """The length [m] that `pixels` of a full-screen picture show at the nearest viewing distance [m]."""
    return pixels * 2 * nearest * math.tan(FIELD_OF_VIEW / 2) / SCREEN


def _inputs(content: Content, exhibit: Exhibit):
    from sim_core.garment import Pattern
    from sim_core.weave import Weave

    recipe = exhibit.file.garment
    assert recipe is not None
    return Pattern.load(content.folder / recipe.pattern), Weave.load(content.folder / recipe.weave)


def _drape(exhibit: Exhibit, pattern, weave, work: Path, out: Path, progress: Progress, *, film: bool):
    """Simulate, and film it meanwhile."""
    from sim_core.garment import Stand, scarf_on_stand
    from sim_core.weave import relax, texture_maps

    recipe = exhibit.file.garment
    assert recipe is not None
    seconds: dict[str, float] = {}
    panel = pattern.mesh(recipe.edge)
    maps = texture_maps(weave, relax(weave), pixels=64)
    stand_vertices, stand_faces = Stand().mesh(20)
    look = Look(
        panel.faces.astype(np.int32),
        stand_vertices,
        stand_faces,
        _shown_colour(pattern.dye, maps),
        _cover(maps),
        float(stand_vertices[:, 1].max()),
    )
    simulate = {
        "edge": recipe.edge,
        "seed": recipe.seed,
        "progress": lambda fraction, label: progress(0.6 * fraction, label),
        "checkpoint": work / "drape.npz",
    }
    clock = time.perf_counter()
    if not film:
        garment = scarf_on_stand(pattern, weave, **simulate)
        seconds["drape"] = round(time.perf_counter() - clock, 2)
        return garment, seconds
    with filming(look, work / "film") as taken:
        garment = scarf_on_stand(pattern, weave, on_frame=lambda index, x: taken.shoot(x), **simulate)
        seconds["drape"] = round(time.perf_counter() - clock, 2)
        taken.walk_round(garment.positions)
        progress(0.6, "film")
        paths = (out / "drape.webm", out / "drape.mp4")
        taken.write(paths, _sound(), lambda share: progress(0.6 + 0.25 * share, "film"))
        seconds["film"] = round(time.perf_counter() - clock - seconds["drape"], 2)
    return garment, seconds


def _sound() -> np.ndarray:
    """The film's music, mono at 48 kHz."""
    from ..media.music import falling_gauze

    return falling_gauze().mean(axis=1).astype(np.float32)


def _shown_colour(dye: tuple[float, float, float] | None, maps) -> tuple[float, float, float]:
    red, green, blue = dye if dye is not None else maps.albedo.reshape(-1, 3).mean(axis=0) / 255
    return (float(red), float(green), float(blue))


def _cover(maps) -> float:
    """Share of the light that the cloth stops."""
    return float(maps.opacity.mean() / 255)


def _look(garment, maps) -> Look:
    from sim_core.garment import Stand

    vertices, faces = Stand(**garment.provenance["stand"]).mesh(28)
    colour = _shown_colour(garment.dye, maps)
    return Look(garment.faces, vertices, faces, colour, _cover(maps), float(vertices[:, 1].max()))


def _record(key: str, garment, light, maps, seconds: dict[str, float]) -> dict[str, Any]:
    """What the hall tells of this bake; every number comes from a measurement."""
    facts = dict(garment.provenance)
    detail = light.provenance["detail"]
    errors = {name: value for name, value in facts["errors"].items() if not isinstance(value, list)}
    apart = detail.get("hausdorff", {})
    errors |= {f"hall_hausdorff_{name.removesuffix('_m')}": value for name, value in apart.items()}
    errors["vertices"], errors["hall_triangles"] = len(garment.positions), len(light.faces)
    return {
        "key": key,
        "digest": garment.digest(),
        "errors": errors,
        "seconds": seconds,
        "stages": facts["seconds"],
        "hall_budget_m": detail.get("budget_m"),
        "weave_seam": float(maps.seam),
        "versions": facts["versions"],
    }


def _publish(out: Path, target: Path) -> None:
    """Move the finished bake to its place; the record goes last, so that half a bake is never taken for one."""
    target.mkdir(parents=True, exist_ok=True)
    (target / RECORD).unlink(missing_ok=True)
    for path in sorted(out.iterdir(), key=lambda path: path.name == RECORD):
        partial = target / f".{path.name}.part"
        shutil.copyfile(path, partial)
        partial.replace(target / path.name)
