"""The hall's own music, drawings and the ready-made mirror: made by programs, so that nobody's rights are touched.

strings, music: plucked strings, and two pieces for them; drawings, cutting_plan: weaves and patterns; foreign: the
mirror; encode: sound to files; make: all of it.
"""

from hall_app.media.drawings import Interlacing, pattern_drawing, weave_drawing
from hall_app.media.foreign import FINENESS, RADIUS, back_height, mirror_glb
from hall_app.media.make import make_media
from hall_app.media.music import FALLING_GAUZE, HALL_PIECE, bar_notes, falling_gauze
from hall_app.media.strings import RATE, Touch, pluck

__all__ = [
    "FALLING_GAUZE",
    "FINENESS",
    "HALL_PIECE",
    "RADIUS",
    "RATE",
    "Interlacing",
    "Touch",
    "back_height",
    "bar_notes",
    "falling_gauze",
    "make_media",
    "mirror_glb",
    "pattern_drawing",
    "pluck",
    "weave_drawing",
]
