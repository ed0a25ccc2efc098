"""Clips: can they be read, do they move the model that stands in the hall, are they small enough?"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from hall_app.content.files import CLOSE_MOTION, MOTION, is_there, made_by_build, tracked_beside
from hall_app.content.folder import Content, Exhibit
from hall_app.content.models.tracked import TrackedError, TrackedMotion
from hall_app.content.problems import Problem
from sim_core.errors import SimCoreError
from sim_core.garment import Clip
from sim_core.gltf import GlbError, glb_parts

MB = 1_000_000
LARGEST = 2 * MB
LARGEST_POINTS = 200_000  # [bytes] of what was tracked: half a minute
LARGEST_OPEN = 50 * MB  # in every visitor's page


def clip_problems(content: Content) -> list[Problem]:
    """Clips that cannot be read, are too large, or go with no mesh of what they move; points likewise."""
    return [
        problem
        for exhibit in content.exhibits
        for moving in _named(exhibit)
        if is_there(exhibit.folder / moving.clip)
        for problem in _of(exhibit, moving)
    ]


@dataclass(frozen=True)
class _Moving:
    """A clip: the key it is named by, its file, the model it moves, and whether its wearer may have been tracked."""

    key: str
    clip: str
    model: Path | None
    tracked: bool = False


def _named(exhibit: Exhibit) -> Iterator[_Moving]:
    """The clips an exhibit may have."""
    file = exhibit.file
    if (name := file.motion or (MOTION if file.outfit else None)) is not None:
        yield _Moving("motion", name, exhibit.model_path("hall"), tracked=True)
    if file.outfit:
        yield _Moving("motion", CLOSE_MOTION, exhibit.model_path("close"))
    if file.comparison and file.comparison.clip:
        yield _Moving("comparison.clip", file.comparison.clip, exhibit.compared_path())


def _of(exhibit: Exhibit, moving: _Moving) -> list[Problem]:
    name, path = moving.clip, exhibit.folder / moving.clip
    fix = (
        "write it by Clip.save"
        if moving.key == "motion"
        else "write both by simcore learn show, or Clip.save"
    )
    if made_by_build(exhibit.file, name):
        fix = f"run: hall build --exhibit {exhibit.id}"
    smaller = "use fewer frames, or a coarser model"

    def problem(what: str, remedy: str = fix) -> Problem:
        return Problem(exhibit.toml, moving.key, what, remedy)

    try:
        clip = Clip.load(path)
    except SimCoreError as error:
        return [problem(f"{name}: {str(error).removeprefix(f'{path}: ')}")]
    found = []
    if (size := path.stat().st_size) > LARGEST:
        found.append(problem(f"{name} has {size / MB:.2f} MB, at most {LARGEST / MB:g} MB", smaller))
    if moving.tracked:
        found += _tracked(exhibit, tracked_beside(name), clip, fix)
    if (whole := clip.steps.nbytes) > LARGEST_OPEN:
        what = f"{name} takes {whole / MB:.0f} MB in the page, at most {LARGEST_OPEN / MB:g} MB"
        found.append(problem(what, smaller))
    meshes = _meshes(moving.model.read_bytes()) if moving.model is not None else None
    if meshes is None:
        return found  # another check names it
    moved = (*clip.meshes, *((clip.figure,) if clip.figure else ()))
    for one in [drawn for mesh in moved for drawn in mesh.drawn]:
        if meshes.get(one.node) != len(one.index):
            has = f"{meshes[one.node]} vertices" if one.node in meshes else "no such mesh"
            what = f"{name} moves {len(one.index)} vertices of {one.node!r}, the model has {has}"
            found.append(problem(what, f"{fix}, for the model as it is now"))
    if not any(mesh.drawn for mesh in moved):
        found.append(problem(f"{name} moves no mesh of the model", "name what it draws: drawn_in"))
    return found


def _tracked(exhibit: Exhibit, name: str, clip: Clip, fix: str) -> list[Problem]:
    """Points beside a clip, if there are any, that cannot be read, are too large or of other frames."""
    path = exhibit.folder / name
    if not is_there(path):
        return []
    try:
        tracked = TrackedMotion.load(path)
    except (TrackedError, OSError) as error:
        return [Problem(exhibit.toml, "motion", f"{name}: {error}", fix)]
    found = []
    if (tracked.frames, tracked.rate) != (clip.frames, clip.rate):
        what = f"{name} has {tracked.frames} frames at {tracked.rate:g} Hz, the clip {clip.frames} at {clip.rate:g} Hz"
        found.append(Problem(exhibit.toml, "motion", what, fix))
    if (size := path.stat().st_size) > LARGEST_POINTS:
        what = f"{name} has {size / 1000:.0f} kB, at most {LARGEST_POINTS / 1000:g} kB"
        found.append(Problem(exhibit.toml, "motion", what, "use fewer frames"))
    return found


def _meshes(model: bytes) -> dict[str, int] | None:
    """Vertices by node of a GLB's meshes of one part; None where it cannot be read."""
    try:
        document = glb_parts(model).document
        nodes = [
            (node["name"], document["meshes"][node["mesh"]]["primitives"])
            for node in document["nodes"]
            if "mesh" in node
        ]
        return {
            str(name): document["accessors"][primitives[0]["attributes"]["POSITION"]]["count"]
            for name, primitives in nodes
            if len(primitives) == 1
        }
    except (GlbError, KeyError, IndexError, TypeError):
        return None
