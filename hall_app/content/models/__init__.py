"""Models and pictures as files: can they be read, how large are they, of what colour?

pictures: any picture; glb: models, their header and numbers; accessors: whether they hold what they claim;
colours: a model's main colour; tracked: points that were tracked of a wearer in motion.
"""

from hall_app.content.models.accessors import MOST_TRIANGLES
from hall_app.content.models.colours import difference, hex_of, main_colour
from hall_app.content.models.glb import GlbError, GlbInfo, open_glb, read_glb
from hall_app.content.models.pictures import FORMATS, LARGEST, PictureError, picture_fault, picture_size
from hall_app.content.models.tracked import TrackedError, TrackedMotion

__all__ = [
    "FORMATS",
    "LARGEST",
    "MOST_TRIANGLES",
    "GlbError",
    "GlbInfo",
    "PictureError",
    "TrackedError",
    "TrackedMotion",
    "difference",
    "hex_of",
    "main_colour",
    "open_glb",
    "picture_fault",
    "picture_size",
    "read_glb",
]
