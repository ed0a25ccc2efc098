"""The files a content folder names and holds: where they are, whether they are there, their digests."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from .exhibit_file import ExhibitFile
from .hall_file import HallFile
from .problems import Problem

BAKED = "baked/"  # written by hall build, absent before it
TEXTS = {"zh": "text.zh.md", "en": "text.en.md"}
PASSING = ("~", ".swp", ".tmp", ".part", ".bak")  # editors' and copiers' temporary files


def hall_files(hall: HallFile) -> Iterator[tuple[str, str]]:
    """(key, path) of the files hall.toml names, relative to the content folder."""
    for number, path in enumerate(hall.music, 1):
        yield f"music[{number}]", path


def exhibit_files(file: ExhibitFile) -> Iterator[tuple[str, str]]:
    """(key, path) of the files exhibit.toml names inside the exhibit's folder."""
    if file.models:
        yield "models.hall", file.models.hall
        if file.models.close:
            yield "models.close", file.models.close
    if file.thumbnail:
        yield "thumbnail", file.thumbnail
    for number, medium in enumerate(file.media, 1):
        name = f"media[{number}]"
        if medium.file:
            yield f"{name}.file", medium.file
        for index, path in enumerate(medium.files, 1):
            yield f"{name}.files[{index}]", path
        if medium.poster:
            yield f"{name}.poster", medium.poster


def recipe_files(file: ExhibitFile) -> Iterator[tuple[str, str]]:
    """(key, path) of the files a garment is made from, relative to the content folder."""
    if file.garment:
        yield "garment.pattern", file.garment.pattern
        yield "garment.weave", file.garment.weave


def made_by_build(file: ExhibitFile, path: str) -> bool:
    """Whether `path` is written by `hall build`, so that its absence is no fault of the curator's."""
    return file.garment is not None and path.startswith(BAKED)


def file_problem(toml: str, key: str, base: Path, path: str, *, root: Path) -> Problem | None:
    """Why the file `path` under `base` cannot be used, or None. `root` is the content folder."""
    full = base / path
    if not full.is_file():
        return Problem(toml, key, f"missing file {path}", f"add {_shown(full, root)} or correct the path")
    if not full.resolve().is_relative_to(root.resolve()):
        fix = "copy the file itself into the folder"
        return Problem(toml, key, f"{path} is a link that leaves the content folder", fix)
    if full.stat().st_size == 0:
        return Problem(toml, key, f"{path} is empty (0 bytes)", "replace it by the whole file")
    return None


def _shown(full: Path, root: Path) -> str:
    return full.relative_to(root).as_posix() if full.is_relative_to(root) else full.name


def walk_files(folder: Path) -> Iterator[Path]:
    """Every ordinary file under `folder`, sorted; hidden and temporary ones are passed over."""
    for path in sorted(folder.rglob("*")):
        inside = path.relative_to(folder).parts
        hidden = any(part.startswith(".") or part == "__pycache__" for part in inside)
        if not hidden and not path.name.endswith(PASSING) and path.is_file():
            yield path


def snapshot(folder: Path) -> dict[str, tuple[int, int]]:
    """Path -> (mtime [ns], size) of every file: equal snapshots mean that nothing changed."""
    found = {}
    for path in walk_files(folder):
        try:
            stat = path.stat()
        except FileNotFoundError:
            continue  # removed between listing and looking
        found[path.relative_to(folder).as_posix()] = (stat.st_mtime_ns, stat.st_size)
    return found


def digest(path: Path) -> str:
    """First 8 hex digits of the file's SHA-256, read again only when time or size changed."""
    stat = path.stat()
    return _digest(path, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=4096)
def _digest(path: Path, _mtime: int, _size: int) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:8]


def revision(folder: Path) -> str:
    """A name for this state of the folder: 12 hex digits over all paths and digests."""
    total = hashlib.sha256()
    for path in walk_files(folder):
        total.update(f"{path.relative_to(folder).as_posix()}\0{digest(path)}\n".encode())
    return total.hexdigest()[:12]
