"""The hall's floor, seen from above.

footprints: what a visitor cannot walk through; opaque: what he cannot see through; placement: whether plan, start and
exhibits fit together; walkable: the floor that is walked on, and which spots of it are reached.
"""

from hall_app.content.floor.footprints import Footprint, foot_height, rectangle, solids_of
from hall_app.content.floor.opaque import opaque_walls
from hall_app.content.floor.placement import overlapping_bodies
from hall_app.content.floor.walkable import facing_spots, reached_spots, walking_floor

__all__ = [
    "Footprint",
    "facing_spots",
    "foot_height",
    "opaque_walls",
    "overlapping_bodies",
    "reached_spots",
    "rectangle",
    "solids_of",
    "walking_floor",
]
