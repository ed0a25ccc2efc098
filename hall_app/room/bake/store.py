"""Where baked rooms lie: beside the content (made by `hall build`) or in the data folder (made by `hall serve`)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from hall_app.content.bakes.record import Fault, seal_fault
from hall_app.content.folder import Content
from hall_app.room.bake.key import built_key, room_key

__all__ = [
    "BUILT",
    "ENVIRONMENT",
    "GLB",
    "RECORD",
    "broken_room",
    "data_room",
    "former_room",
    "room_fault",
    "room_folder",
    "room_here",
    "room_record",
    "room_work",
]

GLB, ENVIRONMENT, RECORD = "room.glb", "environment.jpg", "room.json"
BUILT = "built"  # the record's key: built_key of the plan it was raised from


def room_here(content: Path) -> Path:
    """The content folder's own baked room."""
    return content / "room"


def data_room(data: Path, key: str) -> Path:
    """The folder in which the server keeps a baked room of its own."""
    return data / f"room-{key}"


def room_work(data: Path, key: str) -> Path:
    """The folder in which a bake that is under way keeps its state; gone once it has succeeded."""
    return data / "bake-work" / f"room-{key}"


def room_record(folder: Path) -> dict[str, Any] | None:
    """The record of a baked room, None where there is no whole one: every file is the one that was baked."""
    if room_fault(folder) is not None:
        return None
    return json.loads((folder / RECORD).read_text("utf-8"))


def room_fault(folder: Path) -> Fault | None:
    """(file name, what is wrong with it) of a baked room that is not whole."""
    return seal_fault(folder, RECORD, (GLB, ENVIRONMENT))


def room_folder(content: Content, data: Path) -> Path | None:
    """The folder of the room that was baked from the content as it is now, None where there is none."""
    key = room_key(content, data)
    for folder in (room_here(content.folder), data_room(data, key)):
        record = room_record(folder)
        if record is not None and record.get("key") == key:
            return folder
    return None


def former_room(content: Content, data: Path) -> Path | None:
    """The last room that was baked from what the plan builds now, though with other letters, places or models."""
    built = built_key(content.plan)
    folders = (room_here(content.folder), *sorted(data.glob(data_room(data, "*").name)))
    fitting = [folder for folder in folders if (room_record(folder) or {}).get(BUILT) == built]
    return max(fitting, key=lambda folder: (folder / RECORD).stat().st_mtime_ns, default=None)


def broken_room(content: Content, data: Path) -> str | None:
    """Which file of a baked room keeps it from being shown, in words; None where no baked room is broken."""
    for folder in (room_here(content.folder), data_room(data, room_key(content, data))):
        if folder.is_dir() and (fault := room_fault(folder)):
            return f"{folder.name}/{fault[0]} {fault[1]}"
    return None
