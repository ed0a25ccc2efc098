"""The builders, each from the plan to patches.

lattice and openings serve walls; timber stands on the frame; ceiling, furniture, hangings and signs follow.
"""

from hall_app.room.parts.ceiling import ceilings_of, floor_of
from hall_app.room.parts.furniture import furniture_of
from hall_app.room.parts.hangings import hangings_of
from hall_app.room.parts.signs import Board, boards_of, signs_of
from hall_app.room.parts.timber import timber_of
from hall_app.room.parts.walls import walls_of

__all__ = [
    "Board",
    "boards_of",
    "ceilings_of",
    "floor_of",
    "furniture_of",
    "hangings_of",
    "signs_of",
    "timber_of",
    "walls_of",
]
