"""The room: raised from the plan, textured, lettered, lit, and written as one GLB. README.md tells how."""

from hall_app.room.drawn import room_glb
from hall_app.room.raising import Room, raise_room

__all__ = ["Room", "raise_room", "room_glb"]
