"""Models: can they be drawn, are they in metres, do they stand on their foot?"""

from __future__ import annotations

import warnings
from pathlib import Path

from hall_app.content.bakes.store import bake_fault
from hall_app.content.files import BAKED
from hall_app.content.folder import Content, Exhibit
from hall_app.content.models.accessors import MOST_TRIANGLES
from hall_app.content.models.glb import GlbError, GlbInfo, read_glb
from hall_app.content.problems import Problem

FOOT = 0.05  # [m] a ready-made model's lowest point may be off its own floor
MIDDLE = 0.5  # [m] its middle may be off its own origin


def scale_problems(content: Content) -> list[Problem]:
    """Models that cannot be loaded, or whose height or origin cannot be right."""
    found = []
    for exhibit in content.exhibits:
        for key, path in exhibit.own_models().values():
            found += _model_problems(exhibit, key, path)
        if (compared := exhibit.compared_path()) is not None:
            found += _comparison_problems(exhibit, compared)
    return found


def _model_problems(exhibit: Exhibit, key: str, path: Path) -> list[Problem]:
    fix = "export the model again"
    if exhibit.file.baked_key:
        if bake_fault(exhibit.folder / BAKED):
            return []  # the check of bakes names it
        fix = f"run: hall build --exhibit {exhibit.id}"
    info = _drawable(exhibit, key, path, fix)
    if isinstance(info, Problem):
        return [info]
    problems = _height(exhibit, key, info)
    if exhibit.file.models and not problems:  # a garment hangs where its stand holds it
        problems = _origin(exhibit.toml, key, info)
    return problems


def _comparison_problems(exhibit: Exhibit, path: Path) -> list[Problem]:
    key = "comparison.model"
    info = _drawable(exhibit, key, path, "export the model again")
    return [info] if isinstance(info, Problem) else _origin(exhibit.toml, key, info)


def _drawable(exhibit: Exhibit, key: str, path: Path, fix: str) -> GlbInfo | Problem:
    """What the model holds, or why it cannot be drawn."""
    try:
        info = read_glb(path)
        # Of too many triangles the budget tells: a reader that takes them apart one by one is not asked.
        fault = _drawing_fault(path) if info.triangles <= MOST_TRIANGLES else None
    except (GlbError, OSError) as error:
        fault, info = str(error), None
    if fault or info is None:
        return Problem(exhibit.toml, key, f"{path.name} cannot be drawn: {fault}", fix)
    return info


def _drawing_fault(path: Path) -> str | None:
    """Load the whole file with a second, independent reader."""
    import trimesh

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # numpy's, about degenerate faces of foreign models
            drawn = trimesh.load_scene(path).triangles.size
        return None if drawn else "no triangles"
    except Exception as error:  # a reader of foreign files may fail in any way
        return f"{type(error).__name__}: {error}"[:200]


def _height(exhibit: Exhibit, key: str, info: GlbInfo) -> list[Problem]:
    low, high = exhibit.file.size_range
    height = info.high[1] - info.low[1]
    if low <= height <= high:
        return []
    what = f"the model is {height:.3g} m high, expected {low:g} to {high:g} m"
    fix = "export it in metres with y up, or state its true size_range = [least, greatest]"
    return [Problem(exhibit.toml, key, what, fix)]


def _origin(toml: str, key: str, info: GlbInfo) -> list[Problem]:
    if abs(info.low[1]) > FOOT:
        what = f"the model's lowest point is at y = {info.low[1]:.2f} m"
        return [Problem(toml, key, what, "export it with its foot at y = 0")]
    middle = [(info.low[axis] + info.high[axis]) / 2 for axis in (0, 2)]
    if max(map(abs, middle)) > MIDDLE:
        what = f"the model's middle is at x = {middle[0]:.2f}, z = {middle[1]:.2f} m"
        return [Problem(toml, key, what, "export it with its middle over the origin")]
    return []
