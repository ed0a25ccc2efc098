"""The files an outfit names, read without the engine that dresses it: what its bake depends on."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from functools import lru_cache
from os.path import normpath
from pathlib import Path
from typing import Any

from hall_app.content.files import file_problem, is_there
from hall_app.content.problems import Problem
from hall_app.content.schema.complaints import toml_problem

__all__ = ["motif_files", "outfit_files", "outfit_problems", "scan_files"]

OUTFIT = ("wearer", "motion", "study")  # keys of an outfit that name a file
MOST_MOTIFS = 200  # files looked at for one weave
LAYER = ("pattern", "weave")  # keys of a layer that name a file; `weaves` holds those of single panels


def outfit_files(folder: Path, outfit: str) -> tuple[tuple[str, str], ...]:
    """(key, path) of every file the outfit names, relative to the content folder; keys as `load_outfit` tells them.

    What is no path where one belongs is passed over: whoever dresses the outfit refuses it. Raises OSError,
    UnicodeDecodeError, tomllib.TOMLDecodeError, ValueError or RecursionError for a file that cannot be read.
    """
    table = _table(folder / outfit)
    return tuple((key, path) for key, path in _named(table) if isinstance(path, str) and path)


def _table(path: Path) -> dict[str, Any]:
    """To be read alone. An open hall asks every second, and parsing would be most of what it does all day."""
    state = path.stat()
    return _parsed(path, state.st_mtime_ns, state.st_size)


@lru_cache(maxsize=1024)
def _parsed(path: Path, _mtime: int, _size: int) -> dict[str, Any]:
    return tomllib.loads(path.read_bytes().decode("utf-8-sig"))


def _named(table: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    for name in OUTFIT:
        yield name, table.get(name)
    layers = table.get("layer")
    for number, layer in enumerate(layers if isinstance(layers, list) else [], 1):
        if not isinstance(layer, dict):
            continue
        for name in LAYER:
            yield f"layer.{number}.{name}", layer.get(name)
        weaves = layer.get("weaves")
        for panel, path in (weaves if isinstance(weaves, dict) else {}).items():
            yield f"layer.{number}.weaves.{panel}", path


def scan_files(content: Path, exhibit: Path, scan: str) -> tuple[Path, ...]:
    """The scan in an exhibit's folder and what lies beside it and belongs to it: material files, pictures.

    What cannot be found is left out: whoever reads the scan says so. Raises OSError where it is not there itself.
    """
    from sim_core.mesh.scan import ScanError, scan_companions

    path = exhibit / scan
    path.stat()
    try:
        return path, *scan_companions(path, content)
    except ScanError:
        return (path,)


def motif_files(folder: Path, weave: str) -> tuple[str, ...]:
    """The motif files that a weave file names, and the motif files and drawings that they name, relative to the content
    folder.

    What cannot be read names none: the engine, which reads it, says what is wrong.
    """
    found: list[str] = []
    waiting = [name for name in _motifs(folder, weave) if name]
    while waiting and len(found) < MOST_MOTIFS:
        path = waiting.pop(0)
        if path not in found:
            found.append(path)
            waiting += _motifs(folder, path)
    return tuple(found)


def _motifs(folder: Path, path: str) -> list[str]:
    """What a weave's draft, or a motif and its parts, name, as paths from the content folder."""
    if not path.endswith(".toml"):
        return []
    try:
        table = _table(folder / path)
    except (OSError, ValueError, RecursionError):
        return []
    draft, parts = table.get("draft"), table.get("part")
    tables = [draft, *(parts if isinstance(parts, list) else [])]
    named = [table.get("svg"), *(one.get("motif") for one in tables if isinstance(one, dict))]
    beside = [normpath(Path(path).parent / name) for name in named if isinstance(name, str) and name]
    names = [Path(name).as_posix() for name in beside]
    return [name for name in names if is_there(folder / name)]


def outfit_problems(folder: Path, outfit: str) -> list[Problem]:
    """Why nothing can be dressed by an outfit file that is there: it cannot be read, or a file it names is missing."""
    try:
        named = outfit_files(folder, outfit)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        return [toml_problem(outfit, error)]
    except (OSError, ValueError, RecursionError) as error:
        what = f"cannot be read ({type(error).__name__})"
        return [Problem(outfit, "", what, "check the file, shorten its numbers and lists")]
    found = [file_problem(outfit, key, folder, path, root=folder) for key, path in named]
    for weave in dict.fromkeys(path for _, path in named):
        motifs = motif_files(folder, weave)
        found += [file_problem(weave, "motif", folder, motif, root=folder) for motif in motifs]
    return [problem for problem in found if problem is not None]
