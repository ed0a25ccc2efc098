"""What is drawn: the room as one GLB, its reflection in silk and metal, the studio of close-ups."""

from hall_app.room.picture.environment import environment_jpeg, painted, seen
from hall_app.room.picture.glb import room_glb
from hall_app.room.picture.studio import studio_glb

__all__ = ["environment_jpeg", "painted", "room_glb", "seen", "studio_glb"]
