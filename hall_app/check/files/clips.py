"""Clips: can they be read, do they move the model that stands in the hall, are they small enough?"""

from __future__ import annotations

from hall_app.content.files import MOTION, is_there, made_by_build
from hall_app.content.folder import Content, Exhibit
from hall_app.content.problems import Problem
from sim_core.errors import SimCoreError
from sim_core.garment import Clip
from sim_core.gltf import GlbError, glb_parts

MB = 1_000_000
LARGEST = 2 * MB
LARGEST_OPEN = 50 * MB  # in every visitor's page


def clip_problems(content: Content) -> list[Problem]:
    """Clips that cannot be read, are too large, or go with no mesh of their exhibit's model."""
    return [
        problem
        for exhibit in content.exhibits
        if (name := exhibit.file.motion or (MOTION if exhibit.file.outfit else None))
        and is_there(exhibit.folder / name)
        for problem in _of(exhibit, name)
    ]


def _of(exhibit: Exhibit, name: str) -> list[Problem]:
    path = exhibit.folder / name
    fix = (
        f"run: hall build --exhibit {exhibit.id}"
        if made_by_build(exhibit.file, name)
        else "write it by Clip.save"
    )
    try:
        clip = Clip.load(path)
    except SimCoreError as error:
        what = str(error).removeprefix(f"{path}: ")
        return [Problem(exhibit.toml, "motion", f"{name}: {what}", fix)]
    found = []
    if (size := path.stat().st_size) > LARGEST:
        what = f"{name} has {size / MB:.2f} MB, at most {LARGEST / MB:g} MB"
        found.append(Problem(exhibit.toml, "motion", what, "use fewer frames, or a coarser model"))
    if (whole := clip.steps.nbytes) > LARGEST_OPEN:
        what = f"{name} takes {whole / MB:.0f} MB in the page, at most {LARGEST_OPEN / MB:g} MB"
        found.append(Problem(exhibit.toml, "motion", what, "use fewer frames, or a coarser model"))
    model = exhibit.model_path("hall")
    meshes = _meshes(model.read_bytes()) if model is not None else None
    if meshes is None:
        return found  # another check names it
    moved = (*clip.meshes, *((clip.figure,) if clip.figure else ()))
    for one in [drawn for mesh in moved for drawn in mesh.drawn]:
        if meshes.get(one.node) != len(one.index):
            has = f"{meshes[one.node]} vertices" if one.node in meshes else "no such mesh"
            what = f"{name} moves {len(one.index)} vertices of {one.node!r}, the model has {has}"
            found.append(Problem(exhibit.toml, "motion", what, f"{fix}, for the model as it is now"))
    if not any(mesh.drawn for mesh in moved):
        found.append(
            Problem(
                exhibit.toml, "motion", f"{name} moves no mesh of the model", "name what it draws: drawn_in"
            )
        )
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
