"""Where baked rooms lie: beside the content (made by `hall build`) or in the data folder (made by `hall serve`)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from ..content.loading import Content
from .key import room_key

__all__ = ["ENVIRONMENT", "GLB", "RECORD", "data_room", "room_folder", "room_here", "room_record"]

GLB, ENVIRONMENT, RECORD = "room.glb", "environment.jpg", "room.json"


def room_here(content: Path) -> Path:
    """The content folder's own baked room."""
    return content / "room"


def data_room(data: Path, key: str) -> Path:
    """The folder in which the server keeps a baked room of its own."""
    return data / f"room-{key}"


def room_record(folder: Path) -> dict[str, Any] | None:
    """The record of a baked room, None where there is no complete one."""
    try:
        record = json.loads((folder / RECORD).read_text("utf-8"))
    except (OSError, ValueError):
        return None
    if not isinstance(record, dict) or not all((folder / name).is_file() for name in (GLB, ENVIRONMENT)):
        return None
    return record


def room_folder(content: Content, data: Path) -> Path | None:
    """The folder of the room that was baked from the content as it is now, None where there is none."""
    key = room_key(content)
    for folder in (room_here(content.folder), data_room(data, key)):
        record = room_record(folder)
        if record is not None and record.get("key") == key:
            return folder
    return None
