"""A bake's record: the digests that seal its files, so that a torn or foreign one is not taken for it; its place.

`python -m hall_app.content.bakes.record FOLDER RECORD` adds them to a record that was written before records had any;
the files themselves stay as they are. It refuses a record that is sealed already: what no longer fits is baked again.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

__all__ = ["FILES", "Fault", "publish", "seal", "seal_fault", "seal_record", "text_of"]

FILES = "files"  # the record's key: file name -> SHA-256
Fault = tuple[str, str]  # file name, what is wrong with it


def seal(folder: Path, record: str) -> dict[str, str]:
    """File name -> SHA-256 (64 hex digits) of every file of the bake in `folder` but its record itself."""
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.name != record)
    return {path.name: _digest(path) for path in files if not path.name.startswith(".")}


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def seal_fault(folder: Path, record: str, needed: Iterable[str]) -> Fault | None:
    """The first file of the bake in `folder` that is not what its record says, None for a whole bake.

    record: name of the record; needed: files without which it is no bake. Never raises.
    """
    try:
        read = json.loads((folder / record).read_text("utf-8"))
    except FileNotFoundError:
        return record, "is missing"
    except (OSError, ValueError, RecursionError):
        return record, "cannot be read"
    files = read.get(FILES) if isinstance(read, dict) else None
    if not isinstance(files, dict) or not all(isinstance(name, str) for name in files.values()):
        return record, "does not say which files belong to it"
    for name in (*needed, *(name for name in files if name not in needed)):
        if fault := _file_fault(folder, name, files.get(name)):
            return name, fault
    return None


def _file_fault(folder: Path, name: str, digest: str | None) -> str | None:
    if Path(name).name != name:
        return "lies outside the bake"
    try:
        found = _digest(folder / name)
    except FileNotFoundError:
        return "is missing"
    except (OSError, ValueError):
        return "cannot be read"
    if digest is None:
        return "is not named in the record"
    return None if found == digest else "is not the file that was baked (cut off, changed or of another bake)"


def text_of(record: dict[str, Any]) -> str:
    """A record as its file holds it."""
    return json.dumps(record, ensure_ascii=False, indent=1, sort_keys=True) + "\n"


def publish(out: Path, target: Path, record: str) -> None:
    """Move the finished bake in `out` to its place, its record last: half a bake is never taken for one."""
    target.mkdir(parents=True, exist_ok=True)
    (target / record).unlink(missing_ok=True)
    for path in sorted(out.iterdir(), key=lambda path: path.name == record):
        partial = target / f".{path.name}.part"
        shutil.copyfile(path, partial)
        partial.replace(target / path.name)


def seal_record(folder: Path, name: str) -> dict[str, str]:
    """Add the seal to the record `name` in `folder` that has none. Raises ValueError where it has one."""
    path = folder / name
    record = json.loads(path.read_text("utf-8"))
    if not isinstance(record, dict) or FILES in record:
        raise ValueError(f"{path}: no record, or sealed already – bake again instead")
    record[FILES] = seal(folder, name)
    path.write_text(text_of(record), "utf-8")
    return record[FILES]


if __name__ == "__main__":
    for sealed in seal_record(Path(sys.argv[1]), sys.argv[2]):
        sys.stdout.write(f"{sealed}\n")
