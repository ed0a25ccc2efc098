"""The room the server shows now: the baked one if it fits the content, else the last one, else one raised at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from hall_app.content.folder import Content
from hall_app.room.bake.key import built_key, room_key
from hall_app.room.bake.store import ENVIRONMENT, GLB, broken_room, former_room, room_folder
from hall_app.room.picture.environment import environment_jpeg, painted
from hall_app.room.picture.glb import room_glb
from hall_app.room.raising import raise_room
from hall_app.room.surface.lettering import MissingFontError

__all__ = ["ShownRoom", "shown_room", "still_right"]


@dataclass(frozen=True)
class ShownRoom:
    """key: of the content it was made for, which it may no longer fit in its letters (`former`); built: of what
    the plan builds; glb, environment: files' bytes; baked: False for a room without light of its own; former: baked
    for an earlier state of the content; lacking: what this machine could not do, in words, or None; broken: the file
    that keeps a baked room from being shown and what is wrong with it, or None."""

    key: str
    built: str
    glb: bytes
    environment: bytes
    baked: bool
    former: bool = False
    lacking: str | None = None
    broken: str | None = None


def still_right(room: ShownRoom, content: Content, data: Path) -> bool:
    """True while `room` is what shown_room would give for the content."""
    return room.key == room_key(content, data) and room.baked == (room_folder(content, data) is not None)


def shown_room(content: Content, data: Path, last: ShownRoom | None = None) -> ShownRoom:
    """Read the baked room of the content as it is now, or what stands in for it until it is baked.

    last: what is shown now. A room that has been lit stays where no wall, opening or piece of furniture changed: its
    letters and spots are those of an earlier state, but it tells no lie about where one can walk. Else an evenly lit
    one is raised, which takes a second or two.
    """
    key, built, folder = room_key(content, data), built_key(content.plan), room_folder(content, data)
    if folder is not None:
        return ShownRoom(key, built, (folder / GLB).read_bytes(), (folder / ENVIRONMENT).read_bytes(), True)
    broken = broken_room(content, data)
    if last is not None and last.baked and last.built == built:
        return replace(last, former=True, broken=broken)
    if (folder := former_room(content, data)) is not None:
        picture = (folder / ENVIRONMENT).read_bytes()
        return ShownRoom("", built, (folder / GLB).read_bytes(), picture, True, former=True, broken=broken)
    lacking = None
    raised = content.plan, content.hall.title, content.exhibits
    try:
        room = raise_room(*raised, folder=content.folder)
    except MissingFontError as error:
        room = raise_room(*raised, folder=content.folder, blank=True)
        lacking = str(error)
    return ShownRoom(
        key, built, room_glb(room), environment_jpeg(painted()), False, lacking=lacking, broken=broken
    )
