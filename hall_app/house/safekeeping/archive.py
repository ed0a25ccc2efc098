"""The file of a backup: a ZIP with all members' sizes and digests in it, checked before it is relied on."""

from __future__ import annotations

import os
import zipfile
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path, PurePosixPath
from typing import BinaryIO, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hall_app.house.safekeeping.work import lock
from survey.store.database import now

__all__ = [
    "ANSWERS",
    "CONTENT",
    "DESK",
    "PART",
    "PEOPLE",
    "ArchiveError",
    "Manifest",
    "check_archive",
    "extract",
    "write_archive",
]

CONTENT, PEOPLE, ANSWERS = "content", "people.sqlite", "survey.sqlite"  # what is in it, below its root
DESK = ("drafts", "shelf")  # and of the office's, since format 2
PART = ".part"  # ends the name of a file that is being written
_MANIFEST = "backup.json"
_LARGEST_MANIFEST = 64 << 20  # [bytes]
_AT_ONCE = 1 << 20  # [bytes]
# What Python raises of a file that is no ZIP, is cut off, altered, encrypted or packed in a way it does not know.
_BROKEN = (
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    NotImplementedError,
    RuntimeError,
    UnicodeDecodeError,
    ValidationError,
    KeyError,
)


class ArchiveError(ValueError):
    """A file that is no whole backup, or one that cannot be written; what, where and the remedy in one line."""


class Member(BaseModel):
    """size: [bytes]."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    size: int = Field(ge=0)
    sha256: str = Field(pattern="^[0-9a-f]{64}$")


class Manifest(BaseModel):
    """made: when, in UTC; program: its version; people, answers: how many; files: by their names in the archive."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    format: Literal[1, 2] = 2
    made: str
    program: str
    people: int = Field(ge=0)
    answers: int = Field(ge=0)
    files: Mapping[str, Member]


def write_archive(path: Path, members: Iterable[tuple[str, Path]], *, people: int, answers: int) -> Manifest:
    """Write name and file of each member; it appears at `path` when it is whole, read back and on the disk.

    It is its owner's alone. Raises ArchiveError.
    """
    part = path.with_name(path.name + PART)
    try:
        part.unlink(missing_ok=True)
        with os.fdopen(os.open(part, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600), "w+b") as file:
            lock(file.fileno())
            with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
                files = {name: _put(archive, name, source) for name, source in members}
                told = {
                    "made": now().isoformat(),
                    "program": _program(),
                    "people": people,
                    "answers": answers,
                }
                archive.writestr(_MANIFEST, Manifest(files=files, **told).model_dump_json(indent=1))
            file.flush()
            os.fsync(file.fileno())
        manifest = check_archive(part)
        os.link(part, path)  # never over another
        part.unlink()
    except FileExistsError:
        part.unlink(missing_ok=True)
        raise ArchiveError(
            f"{path}: exists already – give another name, a backup never overwrites one"
        ) from None
    except OSError as error:
        part.unlink(missing_ok=True)
        why = error.strerror or str(error)
        raise ArchiveError(
            f"{path}: the backup failed ({why}) – see that the place is there and free"
        ) from None
    return manifest


def check_archive(path: Path) -> Manifest:
    """Read all of it and compare every byte's digest. Raises ArchiveError."""
    with _opened(path) as (archive, manifest):
        for name, member in manifest.files.items():
            _get(archive, name, member, None)
    return manifest


def extract(path: Path, folder: Path) -> Manifest:
    """Put the members below an empty folder. Raises ArchiveError; what lies in the folder is then of no use."""
    with _opened(path) as (archive, manifest):
        for name, member in manifest.files.items():
            to = folder / name
            to.parent.mkdir(parents=True, exist_ok=True)
            with to.open("xb") as sink:
                _get(archive, name, member, sink)
    return manifest


@contextmanager
def _opened(path: Path) -> Iterator[tuple[zipfile.ZipFile, Manifest]]:
    try:
        with zipfile.ZipFile(path) as archive:
            yield archive, _manifest(archive)
    except FileNotFoundError:
        raise ArchiveError(f"{path}: no such file – give one that `hall backup` wrote") from None
    except _BROKEN as error:
        first = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ArchiveError(f"{path}: no whole backup ({first}) – take another copy of it") from None
    except OSError as error:
        why = error.strerror or str(error)
        raise ArchiveError(f"{path}: cannot be read or unpacked ({why}) – see that there is room") from None


def _manifest(archive: zipfile.ZipFile) -> Manifest:
    if archive.getinfo(_MANIFEST).file_size > _LARGEST_MANIFEST:
        raise zipfile.BadZipFile(f"{_MANIFEST} is too large")
    manifest = Manifest.model_validate_json(archive.read(_MANIFEST))
    names = [name for name in archive.namelist() if name != _MANIFEST]
    if sorted(names) != sorted(manifest.files):
        raise zipfile.BadZipFile(f"it does not hold what {_MANIFEST} lists")
    for name in (PEOPLE, ANSWERS, *manifest.files):
        if name not in manifest.files or not _has_its_place(name):
            raise zipfile.BadZipFile(f"{name!r} is missing or out of place")
    if not any(name.startswith(f"{CONTENT}/") for name in manifest.files):
        raise zipfile.BadZipFile("it has no content")
    return manifest


def _has_its_place(name: str) -> bool:
    """Whether it is a database or lies in the content or with the office: nothing is ever written elsewhere."""
    path = PurePosixPath(name)
    inside = path.parts[:1] == (CONTENT,) and len(path.parts) > 1 and ".." not in path.parts
    desk = len(path.parts) == 2 and path.parts[0] in DESK and path.name != ".."
    plain = name == path.as_posix() and "\\" not in name and ":" not in name and name.isprintable()
    return plain and (inside or desk or name in (PEOPLE, ANSWERS))


def _put(archive: zipfile.ZipFile, name: str, source: Path) -> Member:
    digest, size = sha256(), 0
    with source.open("rb") as file, archive.open(name, "w", force_zip64=True) as member:
        while block := file.read(_AT_ONCE):
            digest.update(block)
            size += len(block)
            member.write(block)
    return Member(size=size, sha256=digest.hexdigest())


def _get(archive: zipfile.ZipFile, name: str, member: Member, sink: BinaryIO | None) -> None:
    """Read a member into `sink`, never more of it than it should have."""
    digest, size = sha256(), 0
    with archive.open(name) as file:
        while block := file.read(_AT_ONCE):
            digest.update(block)
            size += len(block)
            if size > member.size:
                break
            if sink is not None:
                sink.write(block)
    if size != member.size or digest.hexdigest() != member.sha256:
        raise zipfile.BadZipFile(f"{name} is not what was written")


def _program() -> str:
    try:
        return version("handress-hall")
    except PackageNotFoundError:
        return "not installed"
