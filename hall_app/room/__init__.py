"""The room: raised from the plan, textured, lettered, lit, and written as one GLB. README.md tells how."""

from .drawn import room_glb
from .raising import Room, raise_room

__all__ = ["Room", "raise_room", "room_glb"]
