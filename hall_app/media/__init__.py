"""The hall's own music, drawings and the ready-made mirror: made by programs, so that nobody's rights are touched.

strings, music: plucked strings, and two pieces for them; drawings: weaves; cutting_plan, cutting_sheet: flat
patterns; foreign: the mirror; encode: sound to files; make: all of it.
"""

from hall_app.media.cutting_plan import Plan, cutting_plan
from hall_app.media.cutting_sheet import plan_picture, plan_svg
from hall_app.media.drawings import View, weave_drawing
from hall_app.media.foreign import ARCS, FINENESS, RADIUS, back_height, mirror_glb
from hall_app.media.make import make_media, outfit_plan, write_pattern_sheet
from hall_app.media.music import FALLING_GAUZE, HALL_PIECE, bar_notes, falling_gauze
from hall_app.media.strings import RATE, Touch, pluck

__all__ = [
    "ARCS",
    "FALLING_GAUZE",
    "FINENESS",
    "HALL_PIECE",
    "RADIUS",
    "RATE",
    "View",
    "Plan",
    "Touch",
    "back_height",
    "bar_notes",
    "cutting_plan",
    "falling_gauze",
    "make_media",
    "mirror_glb",
    "outfit_plan",
    "plan_picture",
    "plan_svg",
    "pluck",
    "weave_drawing",
    "write_pattern_sheet",
]
