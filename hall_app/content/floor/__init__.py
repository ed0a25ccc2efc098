"""The hall's floor, seen from above.

footprints: what a visitor cannot walk through; placement: whether plan, start and exhibits fit together; walkable:
the floor that is walked on, and which spots of it are reached.
"""

from hall_app.content.floor.footprints import (
    Footprint,
    body_footprint,
    foot_height,
    plan_footprints,
    rectangle,
    solid_footprint,
    solids_of,
)
from hall_app.content.floor.placement import overlapping_bodies, place_faults, plan_problems, start_problems
from hall_app.content.floor.walkable import facing_spots, reached_spots, walking_floor

__all__ = [
    "Footprint",
    "body_footprint",
    "facing_spots",
    "foot_height",
    "overlapping_bodies",
    "place_faults",
    "plan_footprints",
    "plan_problems",
    "reached_spots",
    "rectangle",
    "solid_footprint",
    "solids_of",
    "start_problems",
    "walking_floor",
]
