"""The files a content folder names and holds: where they are, whether they are there, their digests."""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

from hall_app.content.problems import Problem
from hall_app.content.schema.exhibit import ExhibitFile
from hall_app.content.schema.hall import HallFile
from hall_app.content.schema.plan import PlanFile

BAKED = "baked/"  # written by hall build, absent before it
MOTION = BAKED + "motion.clip"  # how an outfit with a motion moves, written by hall build
CLOSE_MOTION = BAKED + "motion-close.clip"  # the same of its close-up
CLIP = ".clip"  # ending of what moves a model
TRACKED = ".points"  # and of what was tracked of its wearer, beside it
SHEET = "media/pattern.svg"  # the flat pattern of an exhibit with an outfit, drawn by hall build --pattern
TEXTS = {"zh": "text.zh.md", "en": "text.en.md"}
LEAVES = ("is a link that leaves the content folder", "copy the file itself into the folder")
PASSING = ("~", ".swp", ".tmp", ".part", ".bak")  # editors' and copiers' temporary files


def hall_files(hall: HallFile) -> Iterator[tuple[str, str]]:
    """(key, path) of the files hall.toml names, relative to the content folder."""
    for number, path in enumerate(hall.music, 1):
        yield f"music[{number}]", path


def plan_files(plan: PlanFile) -> Iterator[tuple[str, str]]:
    """(key, path) of the files plan.toml names, relative to the content folder."""
    for number, sign in enumerate(plan.sign, 1):
        if sign.picture:
            yield f"sign[{number}].picture", sign.picture


def exhibit_files(file: ExhibitFile) -> Iterator[tuple[str, str]]:
    """(key, path) of the files exhibit.toml names inside the exhibit's folder."""
    if file.models:
        yield "models.hall", file.models.hall
        if file.models.close:
            yield "models.close", file.models.close
    if file.scan:
        yield "scan", file.scan
    if file.motion:
        yield "motion", file.motion
    if file.comparison:
        yield "comparison.model", file.comparison.model
        if file.comparison.clip:
            yield "comparison.clip", file.comparison.clip
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


def tracked_beside(motion: str) -> str:
    """Where the points that were tracked of a clip's wearer lie: beside it, under its name."""
    return motion.removesuffix(CLIP) + TRACKED


def made_by_build(file: ExhibitFile, path: str) -> bool:
    """Whether `path` is written by `hall build`, so that its absence is no fault of the curator's."""
    return file.baked_key is not None and path.startswith(BAKED)


def file_problem(toml: str, key: str, base: Path, path: str, *, root: Path) -> Problem | None:
    """Why the file `path` under `base` cannot be used, or None. `root` is the content folder."""
    full = base / path
    try:
        if not full.is_file():
            return Problem(
                toml, key, f"missing file {shortened(path)}", f"add {_shown(full, root)} or correct the path"
            )
        if leaves(full, root):
            return Problem(toml, key, f"{path} {LEAVES[0]}", LEAVES[1])
        if full.stat().st_size == 0:
            return Problem(toml, key, f"{path} is empty (0 bytes)", "replace it by the whole file")
    except OSError as error:
        return Problem(
            toml, key, f"{shortened(path)} cannot be read ({error.strerror})", "shorten or correct the path"
        )
    return None


def shortened(path: str) -> str:
    """A path as it stands in a message: the middle of a very long one is left out."""
    return path if len(path) < 80 else f"{path[:50]}…{path[-20:]}"


def leaves(path: Path, root: Path) -> bool:
    """Whether `path`, links followed, lies outside the folder `root`."""
    return not path.resolve().is_relative_to(root.resolve())


def is_there(path: Path) -> bool:
    """Whether there is such a file; no for a name that no file system takes."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


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
    return whole_digest(path)[:8]


def whole_digest(path: Path) -> str:
    """The 64 hex digits of the file's SHA-256, read again only when time or size changed."""
    stat = path.stat()
    return _digest(path, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=4096)
def _digest(path: Path, _mtime: int, _size: int) -> str:
    with path.open("rb") as file:  # a scan may have half a gigabyte
        return hashlib.file_digest(file, "sha256").hexdigest()


def revision(folder: Path) -> str:
    """A name for this state of the folder: 12 hex digits over all paths and digests."""
    total = hashlib.sha256()
    for path in walk_files(folder):
        try:
            state = digest(path)
        except OSError:
            state = "unread"  # gone since it was listed, or not ours to read: who needs it says so
        total.update(f"{path.relative_to(folder).as_posix()}\0{state}\n".encode())
    return total.hexdigest()[:12]


def replace_file(path: Path, data: bytes) -> None:
    """Put the whole file in place in one step, with the rights of the one that was there; folders above are made.

    Raises OSError; what was there is there still.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name[:60]}.", suffix=".tmp")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        if path.exists():
            shutil.copymode(path, name)
        else:
            os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        with suppress(OSError):
            os.unlink(name)
        raise


def remove_file(path: Path, root: Path) -> None:
    """Remove the file where it is there, and folders below `root` that hold nothing then. Raises OSError."""
    path.unlink(missing_ok=True)
    for folder in path.parents:
        if folder == root or not folder.is_dir() or any(folder.iterdir()):
            return
        folder.rmdir()
