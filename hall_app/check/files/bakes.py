"""Bakes: can what they are made from be read, and do they lie ready, made from it as it is now?"""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from hall_app.content.bakes.key import bake_key
from hall_app.content.bakes.store import NEEDED, RECORD, bake_fault
from hall_app.content.files import BAKED, LEAVES, exhibit_files, is_there, leaves, recipe_files, walk_files
from hall_app.content.folder import Content, Exhibit
from hall_app.content.problems import Problem

FOLDERS = {"patterns": ".toml", "weaves": ".toml", "mannequins": ".npz"}
KINDS = {"pattern": "patterns", "weave": "weaves", "mannequin": "mannequins"}


def bake_problems(content: Content) -> list[Problem]:
    """Garments not baked, baked from older inputs, or whose baked files are missing."""
    faults = _inputs(content)
    found = list(faults.values())
    for exhibit in content.exhibits:
        if exhibit.file.garment and not faults.keys() & {path for _, path in recipe_files(exhibit.file)}:
            found += _bake(content, exhibit)
    return found


def _inputs(content: Content) -> dict[str, Problem]:
    """Path -> what is wrong with it, of every pattern, weave and figure, whether an exhibit names it or not."""
    readers = _readers()
    named = {
        path: KINDS[key.rpartition("_")[2].rpartition(".")[2]]
        for exhibit in content.exhibits
        for key, path in recipe_files(exhibit.file)
    }
    for kind, ending in FOLDERS.items():
        for file in walk_files(content.folder / kind):
            if file.suffix == ending:
                named.setdefault(file.relative_to(content.folder).as_posix(), kind)
    faults = {path: _fault(content.folder, path, readers[kind]) for path, kind in sorted(named.items())}
    return {path: fault for path, fault in faults.items() if fault is not None}


def _readers() -> dict[str, Callable[[Path], Any]]:
    from sim_core.body.mannequin import Mannequin
    from sim_core.garment import Pattern
    from sim_core.weave import Weave

    return {"patterns": Pattern.load, "weaves": Weave.load, "mannequins": Mannequin.load}


def _fault(folder: Path, path: str, reader: Callable[[Path], Any]) -> Problem | None:
    """The file as the engine reads it: its own message says what is wrong and how to mend it."""
    from sim_core.errors import SimCoreError

    if not is_there(folder / path):
        return Problem(path, "", "missing file", "add it, or correct the path in exhibit.toml")
    if leaves(folder / path, folder):
        return Problem(path, "", f"it {LEAVES[0]}", LEAVES[1])
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # numpy's, about numbers that are refused a line later
            reader(folder / path)
    except (SimCoreError, OSError) as error:
        message = str(error).removeprefix(str(folder / path)).lstrip(": ")
        what, _, fix = message.partition(" – ")
        return Problem(path, "", what, fix or "correct the file")
    except Exception as error:  # whatever else an odd file brings about
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        return Problem(path, "", f"cannot be read ({reason})", "correct the file")
    return None


def _bake(content: Content, exhibit: Exhibit) -> list[Problem]:
    note = exhibit.folder / BAKED / RECORD
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
    missing = [
        Problem(exhibit.toml, "garment", f"{name} is missing from the bake", fix)
        for name in wanted
        if not is_there(exhibit.folder / name)
    ]
    fault = None if missing else bake_fault(exhibit.folder / BAKED)
    return [Problem(exhibit.toml, "garment", f"{BAKED}{fault[0]} {fault[1]}", fix)] if fault else missing
