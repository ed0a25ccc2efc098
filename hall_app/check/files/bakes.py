"""Bakes: can what they are made from be read, and do they lie ready, made from it as it is now?"""

from __future__ import annotations

import json
import re
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from hall_app.content.bakes.inputs import outfit_files, outfit_problems
from hall_app.content.bakes.key import bake_key
from hall_app.content.bakes.steps import read_study
from hall_app.content.bakes.store import RECORD, bake_fault, needed
from hall_app.content.files import BAKED, LEAVES, exhibit_files, is_there, leaves, walk_files
from hall_app.content.folder import Content, Exhibit
from hall_app.content.problems import Problem

FOLDERS = {"patterns": ".toml", "weaves": ".toml", "mannequins": ".npz", "motions": ".toml"}
KINDS = {  # by what an outfit calls them
    "pattern": "patterns",
    "weave": "weaves",
    "wearer": "mannequins",
    "motion": "motions",
    "study": "studies",
}
OUTFITS = "outfits"
KEY = re.compile(r"(?P<key>[a-z][\w.]*): (?P<what>.+)", re.DOTALL)  # as the engine's messages begin


def bake_problems(content: Content) -> list[Problem]:
    """Outfits that cannot be dressed, not baked, baked from older inputs, or whose baked files are missing."""
    states: dict[str, list[Problem]] = {}

    def state(exhibit: Exhibit) -> list[Problem]:
        if exhibit.id not in states:
            states[exhibit.id] = bake_state(content, exhibit)
        return states[exhibit.id]

    def dressed(outfit: str) -> bool:
        return any(exhibit.file.outfit == outfit and not state(exhibit) for exhibit in content.exhibits)

    faults = _inputs(content, dressed)
    found = list(faults.values())
    for exhibit in content.exhibits:
        if exhibit.file.outfit and not faults.keys() & _inputs_of(content.folder, exhibit.file.outfit):
            found += state(exhibit)
    return found


def _inputs_of(folder: Path, outfit: str) -> set[str]:
    """The outfit file and all it names."""
    return {outfit, *(path for _, path in outfit_files(folder, outfit))}


def _inputs(content: Content, dressed: Callable[[str], bool]) -> dict[str, Problem]:
    """Path -> what is wrong with it, of every outfit, pattern, weave and figure, whether an exhibit names it or not.

    dressed(outfit): whether a bake of it as it is now lies ready. Then it is not fitted once more, which takes seconds.
    """
    folder, readers = content.folder, _readers(content.folder)
    worn = {exhibit.file.outfit for exhibit in content.exhibits if exhibit.file.outfit}
    worn |= {path for path, _ in _lying(folder, OUTFITS, ".toml")}
    faults: dict[str, Problem | None] = {}
    named: dict[str, str] = {}
    for outfit in sorted(worn):
        if problems := outfit_problems(folder, outfit):
            faults[outfit] = problems[0]
        else:
            named |= {path: _kind(key) for key, path in outfit_files(folder, outfit)}
    for kind, ending in FOLDERS.items():
        named = dict(_lying(folder, kind, ending)) | named
    faults |= {path: _fault(folder, path, readers[kind]) for path, kind in sorted(named.items())}
    faulty = {path for path, fault in faults.items() if fault is not None}
    for outfit in sorted(worn - faulty):
        # Where a file it names is faulty, that says itself what is wrong.
        if not faulty & _inputs_of(folder, outfit) and not dressed(outfit):
            faults[outfit] = _fault(folder, outfit, readers[OUTFITS])
    return {path: fault for path, fault in faults.items() if fault is not None}


def _lying(folder: Path, kind: str, ending: str) -> Iterator[tuple[str, str]]:
    """(path, kind) of the files that lie in the folder of a kind."""
    for file in walk_files(folder / kind):
        if file.suffix == ending:
            yield file.relative_to(folder).as_posix(), kind


def _kind(key: str) -> str:
    """What a key of an outfit names: `wearer`, `layer.1.pattern`, `layer.1.weaves.cuff`."""
    name = "weave" if ".weaves." in key else key.rpartition(".")[2]
    return KINDS[name]


def _readers(folder: Path) -> dict[str, Callable[[Path], Any]]:
    from sim_core.body.mannequin import Mannequin
    from sim_core.errors import FileProblem
    from sim_core.garment import Pattern, check_fits, load_motion, load_outfit
    from sim_core.weave import Weave

    def outfit(path: Path) -> None:
        check_fits(load_outfit(path, folder))

    def study(path: Path) -> None:
        try:
            read_study(path)
        except ValueError as error:
            raise FileProblem(f"{path}: {error}") from error

    return {
        "patterns": Pattern.load,
        "weaves": Weave.load,
        "mannequins": Mannequin.load,
        "motions": load_motion,
        "studies": study,
        OUTFITS: outfit,
    }


def _fault(folder: Path, path: str, reader: Callable[[Path], Any]) -> Problem | None:
    """The file as the engine reads it: its own message says what is wrong and how to mend it."""
    from sim_core.errors import SimCoreError

    if not is_there(folder / path):
        return Problem(path, "", "missing file", "add it, or correct the path of whoever names it")
    if leaves(folder / path, folder):
        return Problem(path, "", f"it {LEAVES[0]}", LEAVES[1])
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # numpy's, about numbers that are refused a line later
            reader(folder / path)
    except (SimCoreError, OSError) as error:
        message = str(error).removeprefix(str(folder / path)).lstrip(": ").replace(f"{folder}/", "")
        what, _, fix = message.partition(" – ")
        told = KEY.match(what)
        key, what = (told["key"], told["what"]) if told else ("", what)
        return Problem(path, key, what, fix or "correct the file")
    except Exception as error:  # whatever else an odd file brings about
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        return Problem(path, "", f"cannot be read ({reason})", "correct the file")
    return None


def bake_state(content: Content, exhibit: Exhibit) -> list[Problem]:
    """Why what lies beside an exhibit with an outfit or a scan is not its bake; empty where it is."""
    note, source = exhibit.folder / BAKED / RECORD, exhibit.file.baked_key or ""
    fix = f"run: hall build --exhibit {exhibit.id}"
    try:
        record = json.loads(note.read_text("utf-8"))
        key = record["key"]
    except FileNotFoundError:
        return [Problem(exhibit.toml, source, "has not been baked", fix)]
    except (OSError, ValueError, KeyError, TypeError):
        return [Problem(exhibit.toml, source, "baked/bake.json cannot be read", fix)]
    if key != bake_key(content, exhibit):
        return [Problem(exhibit.toml, source, "its bake is stale: an input or the engine changed since", fix)]
    named = [path for _, path in exhibit_files(exhibit.file) if path.startswith(BAKED)]
    wanted = dict.fromkeys([BAKED + name for name in needed(record)] + named)
    missing = [
        Problem(exhibit.toml, source, f"{name} is missing from the bake", fix)
        for name in wanted
        if not is_there(exhibit.folder / name)
    ]
    fault = None if missing else bake_fault(exhibit.folder / BAKED)
    return [Problem(exhibit.toml, source, f"{BAKED}{fault[0]} {fault[1]}", fix)] if fault else missing
