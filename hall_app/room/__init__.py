"""The room: raised from the plan, textured, lettered, lit, and written as one GLB. README.md tells how.

patch: the pieces; structure: what follows from the plan; surface: colours, textures, letters; parts: the builders;
raising: all of them; lighting: what the light is computed on; picture: what is drawn; bake: the room as files.
"""

from hall_app.room.patch import Frame, Patch, box, disc, panel, prism, quad, strip, tube
from hall_app.room.picture import room_glb
from hall_app.room.raising import Room, raise_room

__all__ = [
    "Frame",
    "Patch",
    "Room",
    "box",
    "disc",
    "panel",
    "prism",
    "quad",
    "raise_room",
    "room_glb",
    "strip",
    "tube",
]
