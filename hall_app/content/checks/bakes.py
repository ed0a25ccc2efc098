"""Bakes: do the simulated garments lie ready, made from the inputs as they are now?"""

from __future__ import annotations

import json

from ...bake.key import bake_key
from ..exhibit_file import GarmentRecipe
from ..files import BAKED, exhibit_files
from ..loading import Content, Exhibit
from ..problems import Problem

NEEDED = ("garment.npz", "hall.glb", "close.glb")


def bake_problems(content: Content) -> list[Problem]:
    """Garments not baked, baked from older inputs, or whose baked files are missing."""
    found = []
    for exhibit in content.exhibits:
        if exhibit.file.garment:
            found += _inputs(content, exhibit.file.garment) or _bake(content, exhibit)
    return found


def _inputs(content: Content, recipe: GarmentRecipe) -> list[Problem]:
    """Pattern and weave as the engine reads them: its own message says what is wrong and how to mend it."""
    from sim_core.errors import SimCoreError
    from sim_core.garment import Pattern
    from sim_core.weave import Weave

    found = []
    for path, reader in ((recipe.pattern, Pattern.load), (recipe.weave, Weave.load)):
        try:
            reader(content.folder / path)
        except (SimCoreError, OSError) as error:
            message = str(error).removeprefix(str(content.folder / path)).lstrip(": ")
            what, _, fix = message.partition(" – ")
            found.append(Problem(path, "", what, fix or "correct the file"))
    return found


def _bake(content: Content, exhibit: Exhibit) -> list[Problem]:
    note = exhibit.folder / BAKED / "bake.json"
    fix = f"run: hall build --exhibit {exhibit.id}"
    try:
        key = json.loads(note.read_text("utf-8"))["key"]
    except FileNotFoundError:
        return [Problem(exhibit.toml, "garment", "has not been baked", fix)]
    except (OSError, ValueError, KeyError, TypeError):
        return [Problem(exhibit.toml, "garment", "baked/bake.json cannot be read", fix)]
    if key != bake_key(content, exhibit):
        return [
            Problem(exhibit.toml, "garment", "its bake is stale: an input or the engine changed since", fix)
        ]
    named = [path for _, path in exhibit_files(exhibit.file) if path.startswith(BAKED)]
    wanted = dict.fromkeys([BAKED + name for name in NEEDED] + named)
    return [
        Problem(exhibit.toml, "garment", f"{name} is missing from the bake", fix)
        for name in wanted
        if not (exhibit.folder / name).is_file()
    ]
