"""The baked room: key of its inputs; store: where it lies; build: made anew; display: the one to be shown now."""

from hall_app.room.bake.build import bake_room
from hall_app.room.bake.display import ShownRoom, shown_room, still_right
from hall_app.room.bake.key import ROOM_VERSION, built_key, room_key
from hall_app.room.bake.store import (
    broken_room,
    data_room,
    former_room,
    room_fault,
    room_folder,
    room_here,
    room_record,
    room_work,
)

__all__ = [
    "ROOM_VERSION",
    "ShownRoom",
    "bake_room",
    "broken_room",
    "built_key",
    "data_room",
    "former_room",
    "room_fault",
    "room_folder",
    "room_here",
    "room_key",
    "room_record",
    "room_work",
    "shown_room",
    "still_right",
]
