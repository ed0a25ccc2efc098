"""What the data folder need not keep: bakes of former inputs, and the state of bakes that nobody goes on with."""

from __future__ import annotations

import re
import shutil
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

from hall_app.content.bakes.key import KEY_DIGITS
from hall_app.content.bakes.store import RECORD as BAKE_RECORD
from hall_app.content.bakes.store import bake_folder, bake_work, data_bake, key_now
from hall_app.content.folder import Content
from hall_app.house.baking.preparation import ROOM, bake_places
from hall_app.house.baking.queue import Bake
from hall_app.room.bake.key import room_key
from hall_app.room.bake.store import RECORD as ROOM_RECORD
from hall_app.room.bake.store import former_room

__all__ = ["tidy"]

_NEWEST = 3  # of a kind, for a curator who goes back to what was before
_ABANDONED = 3600.0  # [s] without a file written, after which a bake is no other program's that is under way
_OF_KEY = re.compile(f"(?P<kind>.+)-[0-9a-f]{{{KEY_DIGITS}}}")


def tidy(content: Content, data: Path, *, shown: Iterable[Path], wanted: Iterable[Bake]) -> None:
    """Remove all but the newest few bakes of each garment and of the room, and the state of abandoned ones.

    shown: folders of the bakes on show; wanted: what is to be baked. These are kept, and what belongs to the content
    as it is now. Reads and removes files: to be called beside the event loop.
    """
    present = [*wanted, Bake(ROOM, room_key(content, data))]
    last = [former_room(content, data)]
    for exhibit in content.exhibits:
        if exhibit.file.baked_key is not None:
            last.append(bake_folder(content, exhibit, data))
            key = key_now(content, exhibit)
            present += [Bake(exhibit.id, key)] if key is not None else []
    kept = {*shown, *last, *(place for bake in present for place in bake_places(bake, data))}
    for kind in _kinds(data):
        for folder in sorted(kind, key=_made, reverse=True)[_NEWEST:]:
            if folder not in kept:
                shutil.rmtree(folder, ignore_errors=True)
    before = time.time() - _ABANDONED
    for work in _keyed(bake_work(data, "", "").parent):
        if work not in kept and _touched(work) < before:
            shutil.rmtree(work, ignore_errors=True)


def _kinds(data: Path) -> list[list[Path]]:
    """The data folder's bakes: one list for the room and one for each garment, also of one that has left the hall."""
    kinds: dict[str, list[Path]] = {}
    for folder in _keyed(data_bake(data, "", "").parent):
        kinds.setdefault(_kind(folder), []).append(folder)
    return [[folder for folder in _keyed(data) if _kind(folder) == "room"], *kinds.values()]


def _keyed(folder: Path) -> Iterator[Path]:
    """The folders in it that are named after a key; nothing else is ours to remove."""
    if folder.is_dir():
        yield from (path for path in sorted(folder.iterdir()) if path.is_dir() and _kind(path))


def _kind(folder: Path) -> str:
    found = _OF_KEY.fullmatch(folder.name)
    return found["kind"] if found else ""


def _made(folder: Path) -> float:
    """When the bake's record, its last file, was written [s]; 0 for one that has none."""
    return max(_time(folder / name) for name in (BAKE_RECORD, ROOM_RECORD))


def _touched(folder: Path) -> float:
    """When something in the folder was last written [s]."""
    return max(map(_time, (folder, *folder.rglob("*"))))


def _time(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0
