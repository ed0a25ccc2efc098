"""The room: does its baked picture fit the plan, and stay within what a visitor is asked to load?"""

from __future__ import annotations

from ...room.key import room_key
from ...room.places import GLB, room_here, room_record
from ..loading import Content
from ..problems import Problem

MB = 1_000_000
TRIANGLES, BYTES = 40_000, 1.8 * MB


def room_problems(content: Content) -> list[Problem]:
    """A baked room that no longer fits the plan, or is too heavy. A folder without one is drawn evenly lit."""
    folder = room_here(content.folder)
    if not folder.is_dir():
        return []
    record, fix = room_record(folder), "run: hall build --room"
    if record is None:
        return [Problem("room/room.json", "", "the baked room is not whole", fix)]
    if record.get("key") != room_key(content):
        what = "the baked room is stale: the plan, a title, a place or the engine changed since"
        return [Problem("plan.toml", "", what, fix)]
    found = []
    size, triangles = (folder / GLB).stat().st_size, int(record.get("triangles", 0))
    if triangles > TRIANGLES:
        what = f"the room has {triangles} triangles, at most {TRIANGLES}"
        found.append(Problem("plan.toml", "", what, "take windows, lattice walls or curtains out"))
    if size > BYTES:
        what = f"the room has {size / MB:.2f} MB, at most {BYTES / MB:g} MB"
        found.append(Problem("plan.toml", "", what, "take windows, lattice walls or curtains out"))
    return found
