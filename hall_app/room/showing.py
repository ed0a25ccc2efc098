"""The room the server shows now: the baked one if it fits the plan, else one raised at once."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ..content.loading import Content
from .drawn import room_glb
from .environment import environment_jpeg, painted
from .key import room_key
from .lettering import MissingFontError
from .places import ENVIRONMENT, GLB, broken_room, room_folder
from .raising import raise_room

__all__ = ["ShownRoom", "shown_room", "still_right"]


@dataclass(frozen=True)
class ShownRoom:
    """key: of the content it shows; glb, environment: files' bytes; baked: False for a room without light of its own;
    lacking: what this machine could not do, in words, or None; broken: the file that keeps a baked room from being
    shown and what is wrong with it, or None."""

    key: str
    glb: bytes
    environment: bytes
    baked: bool
    lacking: str | None = None
    broken: str | None = None


def still_right(room: ShownRoom, content: Content, data: Path) -> bool:
    """True while `room` is what shown_room would give for the content."""
    return room.key == room_key(content, data) and room.baked == (room_folder(content, data) is not None)


def shown_room(content: Content, data: Path) -> ShownRoom:
    """Read the baked room of the content as it is now, or raise an evenly lit one, which takes a second or two."""
    key, folder = room_key(content, data), room_folder(content, data)
    if folder is not None:
        return ShownRoom(key, (folder / GLB).read_bytes(), (folder / ENVIRONMENT).read_bytes(), True)
    lacking = None
    try:
        room = raise_room(content.plan, content.hall.title, content.exhibits)
    except MissingFontError as error:
        room = raise_room(content.plan, content.hall.title, content.exhibits, blank=True)
        lacking = str(error)
    return ShownRoom(
        key, room_glb(room), environment_jpeg(painted()), False, lacking, broken_room(content, data)
    )
